//! A network as the trainer hands it over: a perceptron, recurrent where LSTM layers stand before it.

use crate::contract::{FORMAT_VERSION, RECURRENT_FORMAT_VERSION};
use crate::{Feature, LstmCell, State};

/// LSTM layers, then tanh layers, the last one linear: its outputs are the logits, one per action.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// The inputs in order, with their scaling.
    pub inputs: Vec<Feature>,
    /// The scaled inputs go through these first; none in a perceptron.
    pub lstm: Vec<LstmCell>,
    /// At least one layer; tanh follows each but the last.
    pub layers: Vec<Dense>,
}

/// `outputs` sums over `inputs` values each.
#[derive(Debug, Clone, PartialEq)]
pub struct Dense {
    /// Width of what comes in.
    pub inputs: usize,
    /// Width of what goes out.
    pub outputs: usize,
    /// Row-major `[outputs][inputs]`.
    pub weights: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
}

/// A network that cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NetworkError {
    /// Nothing to compute.
    #[error("the network has no {0}")]
    Empty(&'static str),
    /// Two neighbours do not fit.
    #[error("{place} takes {found} values, but {wanted} come in")]
    Width {
        /// `layer` or `LSTM layer`, and its index from 0.
        place: String,
        /// What the layer says.
        found: usize,
        /// What comes in.
        wanted: usize,
    },
    /// An array is too short or too long.
    #[error("{place} has {found} {array}, not {wanted}")]
    Length {
        /// `layer` or `LSTM layer`, and its index from 0.
        place: String,
        /// `weights`, `biases` and the like.
        array: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// Training diverged, or a scale is zero.
    #[error("{0}")]
    NotFinite(String),
}

impl Network {
    /// The number of actions.
    #[must_use]
    pub fn actions(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.outputs)
    }

    /// What the contract of its policy says of its state; `None` for a perceptron.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        let lstm: Vec<usize> = self.lstm.iter().map(|layer| layer.width).collect();
        (!lstm.is_empty()).then_some(State { lstm })
    }

    /// Numbers that it carries from step to step; 0 for a perceptron.
    #[must_use]
    pub fn state_width(&self) -> usize {
        self.lstm.iter().map(|layer| 2 * layer.width).sum()
    }

    /// The version of the contract of its policy.
    #[must_use]
    pub fn format_version(&self) -> u32 {
        if self.lstm.is_empty() {
            FORMAT_VERSION
        } else {
            RECURRENT_FORMAT_VERSION
        }
    }

    /// Checks that the layers fit together and every number is finite.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), NetworkError> {
        if self.inputs.is_empty() {
            return Err(NetworkError::Empty("inputs"));
        }
        if self.actions() == 0 {
            return Err(NetworkError::Empty("outputs"));
        }
        for feature in &self.inputs {
            check_scaling(feature)?;
        }
        let mut width = self.inputs.len();
        for (index, layer) in self.lstm.iter().enumerate() {
            layer.check(index, width)?;
            width = layer.width;
        }
        for (index, layer) in self.layers.iter().enumerate() {
            layer.check(index, width)?;
            width = layer.outputs;
        }
        Ok(())
    }

    /// The plain forward pass of a perceptron, for comparison with what a runtime makes of the file.
    ///
    /// `input` is `[rows][inputs]` in SI, `logits` is `[rows][actions]`.
    ///
    /// # Panics
    /// Where the slices do not fit, the network is recurrent or fails [`Network::check`].
    pub fn forward(&self, input: &[f32], logits: &mut [f32]) {
        self.forward_with_state(input, &mut [], logits);
    }

    /// One step of as many episodes as there are rows, of any network.
    ///
    /// `input` is `[rows][inputs]` in SI, `logits` is `[rows][actions]`; `state` is
    /// `[rows][state_width]`, laid out as [`State`] says, all zeros where an episode begins, and
    /// becomes that of the next step.
    ///
    /// # Panics
    /// Where the slices do not fit, or the network fails [`Network::check`].
    pub fn forward_with_state(&self, input: &[f32], state: &mut [f32], logits: &mut [f32]) {
        let (rows, width) = (input.len() / self.inputs.len(), self.state_width());
        let lengths = [input.len(), logits.len(), state.len()];
        let wanted = [self.inputs.len(), self.actions(), width].map(|width| rows * width);
        assert_eq!(lengths, wanted, "rows of input, logits and state");
        for (row, input) in input.chunks_exact(self.inputs.len()).enumerate() {
            let values = self.forward_row(input, &mut state[row * width..][..width]);
            logits[row * self.actions()..][..self.actions()].copy_from_slice(&values);
        }
    }

    fn forward_row(&self, row: &[f32], mut state: &mut [f32]) -> Vec<f32> {
        let mut values: Vec<f32> = row
            .iter()
            .zip(&self.inputs)
            .map(|(x, feature)| (x - feature.offset as f32) * feature.scale as f32)
            .collect();
        for layer in &self.lstm {
            let (own, rest) = state.split_at_mut(2 * layer.width);
            layer.step(&values, own);
            values = own[..layer.width].to_vec();
            state = rest;
        }
        for (index, layer) in self.layers.iter().enumerate() {
            values = layer.forward(&values);
            if index + 1 < self.layers.len() {
                values.iter_mut().for_each(|value| *value = value.tanh());
            }
        }
        values
    }
}

impl Dense {
    fn forward(&self, values: &[f32]) -> Vec<f32> {
        let rows = self.weights.chunks_exact(self.inputs);
        rows.zip(&self.bias)
            .map(|(row, bias)| {
                row.iter()
                    .zip(values)
                    .fold(*bias, |sum, (w, x)| sum + w * x)
            })
            .collect()
    }

    fn check(&self, layer: usize, width: usize) -> Result<(), NetworkError> {
        let place = format!("layer {layer}");
        if self.inputs != width {
            return Err(NetworkError::Width {
                place,
                found: self.inputs,
                wanted: width,
            });
        }
        if self.outputs == 0 {
            return Err(NetworkError::Empty("outputs in one of its layers"));
        }
        let arrays = [
            ("weights", &self.weights, self.inputs * self.outputs),
            ("biases", &self.bias, self.outputs),
        ];
        for (array, values, wanted) in arrays {
            NetworkError::check_array(&place, array, values, wanted)?;
        }
        Ok(())
    }
}

impl NetworkError {
    /// Whether an array of a layer has its length and nothing but finite numbers.
    pub(crate) fn check_array(
        place: &str,
        array: &'static str,
        values: &[f32],
        wanted: usize,
    ) -> Result<(), Self> {
        if values.len() != wanted {
            return Err(Self::Length {
                place: place.to_owned(),
                array,
                found: values.len(),
                wanted,
            });
        }
        let Some(at) = values.iter().position(|value| !value.is_finite()) else {
            return Ok(());
        };
        let value = values[at];
        Err(Self::NotFinite(format!(
            "{place}: number {at} of the {array} is {value}; training diverged"
        )))
    }
}

/// The graph holds both numbers in single precision, so they must survive that.
fn check_scaling(feature: &Feature) -> Result<(), NetworkError> {
    let (offset, scale) = (feature.offset as f32, feature.scale as f32);
    if offset.is_finite() && scale.is_normal() {
        return Ok(());
    }
    let Feature {
        name,
        offset,
        scale,
        ..
    } = feature;
    Err(NetworkError::NotFinite(format!(
        "input {name}: offset {offset}, scale {scale} is no scaling"
    )))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::FeatureName;

    fn small() -> Network {
        let feature = Feature {
            name: FeatureName::MeanState,
            unit: "m".into(),
            lower: 0.0,
            upper: 2.0,
            offset: 1.0,
            scale: 2.0,
        };
        Network {
            inputs: vec![feature],
            lstm: vec![],
            layers: vec![
                Dense {
                    inputs: 1,
                    outputs: 2,
                    weights: vec![0.5, -1.0],
                    bias: vec![0.0, 0.25],
                },
                Dense {
                    inputs: 2,
                    outputs: 2,
                    weights: vec![1.0, 2.0, -3.0, 0.5],
                    bias: vec![0.1, 0.0],
                },
            ],
        }
    }

    #[test]
    fn forward_agrees_with_hand_calculation() {
        // x = 1.5: scaled 1; hidden tanh(0.5), tanh(-0.75); x = 1: scaled 0; hidden 0, tanh(0.25).
        let (a, b, c) = (0.462_117_16_f32, -0.635_148_95_f32, 0.244_918_66_f32);
        let expected = [
            a + 2.0 * b + 0.1,
            -3.0 * a + 0.5 * b,
            2.0 * c + 0.1,
            0.5 * c,
        ];
        let mut logits = [0.0; 4];
        small().forward(&[1.5, 1.0], &mut logits);
        for (found, wanted) in logits.iter().zip(expected) {
            assert!(
                (found - wanted).abs() < 1e-6,
                "{logits:?} against {expected:?}"
            );
        }
    }

    /// `small` behind two LSTM layers of one unit each.
    fn recurrent() -> Network {
        let cell = |input: f32, hidden: f32| LstmCell {
            inputs: 1,
            width: 1,
            weights_input: vec![input; 4],
            weights_hidden: vec![hidden; 4],
            bias: vec![0.0; 4],
        };
        Network {
            lstm: vec![cell(1.0, 0.5), cell(-2.0, 1.0)],
            ..small()
        }
    }

    #[test]
    fn layers_of_a_recurrent_network_feed_one_another() {
        let logistic = |x: f64| 1.0 / (1.0 + (-x).exp());
        // All four sums of a layer are the same here.
        let step = |sum: f64, c: f64| {
            let next = logistic(sum) * c + logistic(sum) * sum.tanh();
            (logistic(sum) * next.tanh(), next)
        };
        let network = recurrent();
        assert_eq!(
            (network.state_width(), network.state().unwrap().lstm),
            (4, vec![1, 1])
        );
        let ([mut h0, mut c0, mut h1, mut c1], mut state) = ([0.0; 4], [0.0; 4]);
        for x in [1.5, 0.25, -1.0] {
            (h0, c0) = step((x - 1.0) * 2.0 + 0.5 * h0, c0);
            (h1, c1) = step(-2.0 * h0 + h1, c1);
            let (a, b) = ((0.5 * h1).tanh(), (0.25 - h1).tanh());
            let mut logits = [0.0; 2];
            network.forward_with_state(&[x as f32], &mut state, &mut logits);
            let found = logits.iter().chain(&state).map(|x| f64::from(*x));
            let wanted = [a + 2.0 * b + 0.1, -3.0 * a + 0.5 * b, h0, c0, h1, c1];
            for (found, wanted) in found.zip(wanted) {
                assert!(
                    (found - wanted).abs() < 1e-6,
                    "{logits:?} {state:?}: {wanted:?}"
                );
            }
        }
    }

    #[test]
    fn rows_of_a_recurrent_network_keep_their_own_state() {
        let network = recurrent();
        let mut together = [0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.4];
        let mut alone = together;
        let (mut both, mut one) = ([0.0; 4], [0.0; 4]);
        network.forward_with_state(&[1.5, -0.5], &mut together, &mut both);
        for row in 0..2 {
            let (state, logits) = (&mut alone[4 * row..][..4], &mut one[2 * row..][..2]);
            network.forward_with_state(&[[1.5], [-0.5]][row], state, logits);
        }
        assert_eq!((together, both), (alone, one));
        assert_ne!(one[..2], one[2..]);
    }

    type Spoil = fn(&mut Network);

    #[test]
    fn faults_are_named() {
        let cases: [(Spoil, &str); 9] = [
            (|n| n.inputs.clear(), "no inputs"),
            (|n| n.layers.clear(), "no outputs"),
            (
                |n| n.layers[1].inputs = 3,
                "layer 1 takes 3 values, but 2 come in",
            ),
            (
                |n| _ = n.layers[0].weights.pop(),
                "layer 0 has 1 weights, not 2",
            ),
            (
                |n| n.layers[1].bias.push(0.0),
                "layer 1 has 3 biases, not 2",
            ),
            (
                |n| n.layers[1].weights[3] = f32::NAN,
                "number 3 of the weights is NaN",
            ),
            (
                |n| n.layers[0].bias[1] = f32::INFINITY,
                "number 1 of the biases is inf",
            ),
            (|n| n.inputs[0].scale = 0.0, "scale 0"),
            (|n| n.inputs[0].offset = 1e300, "no scaling"),
        ];
        check_faults(&small(), &cases);
    }

    #[test]
    fn faults_of_lstm_layers_are_named() {
        let cases: [(Spoil, &str); 7] = [
            (
                |n| n.lstm[1].width = 0,
                "no units in one of its LSTM layers",
            ),
            (
                |n| n.lstm[1].inputs = 3,
                "LSTM layer 1 takes 3 values, but 1 come in",
            ),
            (
                |n| _ = n.lstm[0].weights_input.pop(),
                "LSTM layer 0 has 3 input weights, not 4",
            ),
            (
                |n| n.lstm[1].weights_hidden.push(0.0),
                "LSTM layer 1 has 5 hidden weights, not 4",
            ),
            (
                |n| n.lstm[0].bias.clear(),
                "LSTM layer 0 has 0 biases, not 4",
            ),
            (
                |n| n.lstm[1].weights_hidden[2] = f32::NAN,
                "LSTM layer 1: number 2 of the hidden weights is NaN",
            ),
            (
                |n| n.layers[0].inputs = 2,
                "layer 0 takes 2 values, but 1 come in",
            ),
        ];
        check_faults(&recurrent(), &cases);
    }

    fn check_faults(sound: &Network, cases: &[(Spoil, &str)]) {
        sound.check().unwrap();
        for (spoil, part) in cases {
            let mut network = sound.clone();
            spoil(&mut network);
            let fault = network.check().unwrap_err().to_string();
            assert!(fault.contains(part), "{fault:?} lacks {part:?}");
        }
    }
}
