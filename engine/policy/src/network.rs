//! A multilayer perceptron as the trainer hands it over.

use crate::Feature;

/// Tanh layers, the last one linear: its outputs are the logits, one per action.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// The inputs in order, with their scaling.
    pub inputs: Vec<Feature>,
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
    #[error("layer {layer} takes {found} values, but {wanted} come in")]
    Width {
        /// Counted from 0.
        layer: usize,
        /// What the layer says.
        found: usize,
        /// What comes in.
        wanted: usize,
    },
    /// An array is too short or too long.
    #[error("layer {layer} has {found} {array}, not {wanted}")]
    Length {
        /// Counted from 0.
        layer: usize,
        /// `weights` or `biases`.
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
        for (index, layer) in self.layers.iter().enumerate() {
            layer.check(index, width)?;
            width = layer.outputs;
        }
        Ok(())
    }

    /// The plain forward pass, for comparison with what a runtime makes of the file.
    ///
    /// `input` is `[rows][inputs]` in SI, `logits` is `[rows][actions]`.
    ///
    /// # Panics
    /// Where the slices do not fit, or the network fails [`Network::check`].
    pub fn forward(&self, input: &[f32], logits: &mut [f32]) {
        assert_eq!(
            input.len() * self.actions(),
            logits.len() * self.inputs.len(),
            "rows of input and logits"
        );
        let rows = input.chunks_exact(self.inputs.len());
        for (row, out) in rows.zip(logits.chunks_exact_mut(self.actions())) {
            out.copy_from_slice(&self.forward_row(row));
        }
    }

    fn forward_row(&self, row: &[f32]) -> Vec<f32> {
        let mut values: Vec<f32> = row
            .iter()
            .zip(&self.inputs)
            .map(|(x, feature)| (x - feature.offset as f32) * feature.scale as f32)
            .collect();
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
        if self.inputs != width {
            return Err(NetworkError::Width {
                layer,
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
            if values.len() != wanted {
                return Err(NetworkError::Length {
                    layer,
                    array,
                    found: values.len(),
                    wanted,
                });
            }
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                let value = values[at];
                let fault = format!(
                    "layer {layer}: number {at} of the {array} is {value}; training diverged"
                );
                return Err(NetworkError::NotFinite(fault));
            }
        }
        Ok(())
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

    #[test]
    fn faults_are_named() {
        type Spoil = fn(&mut Network);
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
        small().check().unwrap();
        for (spoil, part) in cases {
            let mut network = small();
            spoil(&mut network);
            let fault = network.check().unwrap_err().to_string();
            assert!(fault.contains(part), "{fault:?} lacks {part:?}");
        }
    }
}
