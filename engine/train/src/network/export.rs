//! A network as plain layers, for a policy file.

use super::{Layer, Network};

/// One layer without padding: y = W x + b, with tanh after every layer but the last.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseLayer {
    /// Numbers that come in.
    pub inputs: usize,
    /// Numbers that go out.
    pub outputs: usize,
    /// W, `[outputs][inputs]`.
    pub weights: Vec<f32>,
    /// b, `[outputs]`.
    pub bias: Vec<f32>,
}

impl Network {
    /// The layers, first to last.
    pub(crate) fn export(&self) -> Vec<DenseLayer> {
        self.layers_of(&self.parameters)
    }

    /// The gradients in the places of their parameters.
    #[cfg(test)]
    pub(crate) fn export_gradients(&self) -> Vec<DenseLayer> {
        self.layers_of(&self.gradients)
    }

    fn layers_of(&self, buffer: &[f32]) -> Vec<DenseLayer> {
        let hidden = self.hidden.iter().map(|layer| {
            plain(buffer, layer, |input, output| {
                input * layer.columns + output
            })
        });
        let layer = &self.output;
        let output = plain(buffer, layer, |input, output| {
            output * layer.columns + input
        });
        hidden.chain([output]).collect()
    }
}

/// Takes a layer out of a buffer, given where it keeps the weight of an input and an output.
fn plain(buffer: &[f32], layer: &Layer, place: impl Fn(usize, usize) -> usize) -> DenseLayer {
    let stored = &buffer[layer.weights.clone()];
    let row = |output| (0..layer.inputs).map(move |input| (input, output));
    let order = (0..layer.outputs).flat_map(row);
    DenseLayer {
        inputs: layer.inputs,
        outputs: layer.outputs,
        weights: order
            .map(|(input, output)| stored[place(input, output)])
            .collect(),
        bias: buffer[layer.bias.clone()][..layer.outputs].to_vec(),
    }
}
