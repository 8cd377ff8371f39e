//! One LSTM layer as the trainer hands it over.

use crate::NetworkError;

/// `h' = o · tanh(c')`, `c' = f · c + i · g`: what comes in and the last output `h` form four
/// gates; `h` and the cell `c` are the layer's state.
///
/// Rows stand gate after gate, in the order i, f, g, o, as in PyTorch; its two biases are added
/// up into one.
#[derive(Debug, Clone, PartialEq)]
pub struct LstmCell {
    /// Width of what comes in.
    pub inputs: usize,
    /// Width of `h` and of `c`, and of what goes out.
    pub width: usize,
    /// Row-major `[4 * width][inputs]`.
    pub weights_input: Vec<f32>,
    /// Row-major `[4 * width][width]`.
    pub weights_hidden: Vec<f32>,
    /// `[4 * width]`.
    pub bias: Vec<f32>,
}

impl LstmCell {
    /// Takes one step; `state` is `h` then `c`, before and afterwards.
    pub(crate) fn step(&self, values: &[f32], state: &mut [f32]) {
        let (hidden, cell) = state.split_at_mut(self.width);
        let sums = self.sums(values, hidden);
        let gate = |index: usize, unit: usize| sums[index * self.width + unit];
        for unit in 0..self.width {
            let [i, f, g, o] = [0, 1, 2, 3].map(|index| gate(index, unit));
            cell[unit] = sigmoid(f) * cell[unit] + sigmoid(i) * g.tanh();
            hidden[unit] = sigmoid(o) * cell[unit].tanh();
        }
    }

    fn sums(&self, values: &[f32], hidden: &[f32]) -> Vec<f32> {
        let of_input = self.weights_input.chunks_exact(self.inputs);
        let of_hidden = self.weights_hidden.chunks_exact(self.width);
        of_input
            .zip(of_hidden)
            .zip(&self.bias)
            .map(|((input, last), bias)| bias + dot(input, values) + dot(last, hidden))
            .collect()
    }

    /// The first fault of this layer, where `width` values come in.
    pub(crate) fn check(&self, index: usize, width: usize) -> Result<(), NetworkError> {
        let place = format!("LSTM layer {index}");
        if self.width == 0 {
            return Err(NetworkError::Empty("units in one of its LSTM layers"));
        }
        if self.inputs != width {
            return Err(NetworkError::Width {
                place,
                found: self.inputs,
                wanted: width,
            });
        }
        let gates = 4 * self.width;
        let arrays = [
            ("input weights", &self.weights_input, gates * self.inputs),
            ("hidden weights", &self.weights_hidden, gates * self.width),
            ("biases", &self.bias, gates),
        ];
        for (array, values, wanted) in arrays {
            NetworkError::check_array(&place, array, values, wanted)?;
        }
        Ok(())
    }
}

fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}

/// Eight sums side by side: one after the other, each addition would wait for the last.
fn dot(weights: &[f32], values: &[f32]) -> f32 {
    let (weights, last_weights) = weights.as_chunks::<8>();
    let (values, last_values) = values.as_chunks::<8>();
    let mut sums = [0.0_f32; 8];
    for (weights, values) in weights.iter().zip(values) {
        for (sum, (w, x)) in sums.iter_mut().zip(weights.iter().zip(values)) {
            *sum += w * x;
        }
    }
    let last = last_weights.iter().zip(last_values);
    sums.iter().sum::<f32>() + last.map(|(w, x)| w * x).sum::<f32>()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The same formulas in double precision, gate by gate.
    fn wanted(cell: &LstmCell, values: &[f32], h: &[f64], c: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let sum = |row: usize| {
            let input = values
                .iter()
                .enumerate()
                .map(|(k, x)| f64::from(cell.weights_input[row * cell.inputs + k]) * f64::from(*x));
            let hidden = h
                .iter()
                .enumerate()
                .map(|(k, x)| f64::from(cell.weights_hidden[row * cell.width + k]) * x);
            f64::from(cell.bias[row]) + input.sum::<f64>() + hidden.sum::<f64>()
        };
        let logistic = |x: f64| 0.5 + 0.5 * (x / 2.0).tanh();
        let unit = |unit: usize| {
            let [i, f, g, o] = [0, 1, 2, 3].map(|gate| sum(gate * cell.width + unit));
            let next = logistic(f) * c[unit] + logistic(i) * g.tanh();
            (logistic(o) * next.tanh(), next)
        };
        (0..cell.width).map(unit).unzip()
    }

    #[test]
    fn one_unit_by_hand() {
        // Zero input and state: the gates are those of the biases alone. sigmoid(ln 3) = 3/4,
        // sigmoid(0) = 1/2, tanh(0.5) = 0.46211716; c' = 3/4 · 0.46211716 = 0.34658787 and
        // h' = 1/2 · tanh(0.34658787) = 1/2 · 0.33334602. Then c = 2 is kept by half: c' = 1.34658787.
        let cell = LstmCell {
            inputs: 1,
            width: 1,
            weights_input: vec![0.0; 4],
            weights_hidden: vec![0.0; 4],
            bias: vec![3.0_f32.ln(), 0.0, 0.5, 0.0],
        };
        for (before, c, h) in [
            (0.0, 0.346_587_87, 0.166_673),
            (2.0, 1.346_587_9, 0.436_622_76),
        ] {
            let mut state = [0.7, before];
            cell.step(&[5.0], &mut state);
            assert!((state[1] - c).abs() < 1e-6, "c' {} against {c}", state[1]);
            assert!((state[0] - h).abs() < 1e-6, "h' {} against {h}", state[0]);
        }
    }

    #[test]
    fn steps_agree_with_double_precision() {
        for (inputs, width) in [(1, 1), (3, 5), (17, 9), (8, 16)] {
            let mut number = 0_u32;
            let mut values = |count: usize| -> Vec<f32> {
                let mut next = || {
                    number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (number >> 8) as f32 / (1 << 23) as f32 - 1.0
                };
                (0..count).map(|_| next()).collect()
            };
            let cell = LstmCell {
                inputs,
                width,
                weights_input: values(4 * width * inputs),
                weights_hidden: values(4 * width * width),
                bias: values(4 * width),
            };
            cell.check(0, inputs).unwrap();
            let mut state = vec![0.0; 2 * width];
            let (mut h, mut c) = (vec![0.0; width], vec![0.0; width]);
            for step in 0..20 {
                let input = values(inputs);
                cell.step(&input, &mut state);
                (h, c) = wanted(&cell, &input, &h, &c);
                for (found, wanted) in state.iter().zip(h.iter().chain(&c)) {
                    assert!(
                        (f64::from(*found) - wanted).abs() < 2e-5,
                        "{inputs} to {width}, step {step}: {found} against {wanted}"
                    );
                }
            }
        }
    }
}
