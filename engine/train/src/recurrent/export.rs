//! Recurrent layers as plain weights, for a policy file.

use super::stack::{Layer, Matrix, Stack};
use crate::kernels::gates::PANEL;

/// One layer of long short-term memory without padding. The gates come in PyTorch's order i, f,
/// g, o, each for all units: i, f, o = σ(W x + U h + b), g = tanh(W x + U h + b), c' = f · c +
/// i · g, h' = o · tanh c'.
#[derive(Debug, Clone, PartialEq)]
pub struct LstmLayer {
    /// Numbers that come in.
    pub inputs: usize,
    /// Units: numbers in h and in c.
    pub width: usize,
    /// W, `[4 · width][inputs]`.
    pub weights_input: Vec<f32>,
    /// U, `[4 · width][width]`.
    pub weights_hidden: Vec<f32>,
    /// b, `[4 · width]`: both of PyTorch's biases in one.
    pub bias: Vec<f32>,
}

impl Stack {
    /// The layers, first to last.
    pub(crate) fn export(&self) -> Vec<LstmLayer> {
        self.layers_of(&self.parameters)
    }

    /// The gradients in the places of their parameters.
    #[cfg(test)]
    pub(crate) fn export_gradients(&self) -> Vec<LstmLayer> {
        self.layers_of(&self.gradients)
    }

    fn layers_of(&self, buffer: &[f32]) -> Vec<LstmLayer> {
        let layer = |layer: &Layer| LstmLayer {
            inputs: layer.inputs,
            width: layer.width,
            weights_input: plain(buffer, layer, &layer.input, layer.inputs),
            weights_hidden: plain(buffer, layer, &layer.hidden, layer.width),
            bias: places(layer)
                .map(|(group, column)| buffer[layer.bias.clone()][group * PANEL + column])
                .collect(),
        };
        self.layers.iter().map(layer).collect()
    }
}

/// Takes a matrix out of a buffer, `[4 · width][inputs]`.
fn plain(buffer: &[f32], layer: &Layer, matrix: &Matrix, inputs: usize) -> Vec<f32> {
    let stored = &buffer[matrix.weights.clone()];
    let row = |(group, column)| {
        let at = move |input: usize| (group * matrix.rows + input) * PANEL + column;
        (0..inputs).map(move |input| stored[at(input)])
    };
    places(layer).flat_map(row).collect()
}

/// Places of the outputs of a layer in PyTorch's order.
fn places(layer: &Layer) -> impl Iterator<Item = (usize, usize)> {
    let width = layer.width;
    (0..4).flat_map(move |gate| (0..width).map(move |unit| Layer::place(unit, gate)))
}
