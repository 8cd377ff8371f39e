//! The multilayer perceptron: tanh between its layers, nothing after the last.
//!
//! Samples go through in blocks of at most [`BLOCK`], activations as rows `[sample][width]`. A
//! hidden layer keeps its weights as `[input][output]`, which the forward product and the gradient
//! of the weights read in rows; the output layer, of few rows, as `[output][input]`. The other
//! way round is a copy, renewed after every change. Widths are padded to whole vectors with zeros,
//! which every operation here leaves zero.

mod backward;
mod export;
mod initialise;
mod workspace;

pub use export::DenseLayer;
pub(crate) use workspace::Workspace;

use std::ops::Range;

use pubs_core::vector::VectorUnit;
use rand::Rng;

use crate::kernels::buffer::Buffer;
use crate::kernels::column::{BLOCK, Column};
use crate::kernels::matrix::{Left, Shape, Start, multiply, padded};
use crate::kernels::tanh::apply_tanh;
use crate::kernels::transpose::transpose;

/// Parameters of a perceptron and their gradients.
#[derive(Debug, Clone)]
pub(crate) struct Network {
    unit: VectorUnit,
    hidden: Vec<Layer>,
    output: Layer,
    pub(crate) parameters: Buffer,
    pub(crate) gradients: Buffer,
    /// Transposed weights, layer by layer.
    copies: Buffer,
}

/// Where a layer lies in the buffers.
#[derive(Debug, Clone)]
struct Layer {
    /// Numbers that come in and go out, without padding.
    inputs: usize,
    outputs: usize,
    /// The matrix as stored: rows, and columns in whole vectors.
    rows: usize,
    columns: usize,
    /// In the parameters and the gradients.
    weights: Range<usize>,
    bias: Range<usize>,
    /// In the copies; empty for a layer on observations, which needs none.
    copy: Range<usize>,
}

impl Network {
    /// A network of the given widths (inputs, hidden layers…, outputs) with orthogonal weights:
    /// gain √2 in the hidden layers and `output_gain` in the last, biases 0.
    pub(crate) fn new(
        unit: VectorUnit,
        widths: &[usize],
        output_gain: f64,
        generator: &mut impl Rng,
    ) -> Self {
        Self::build(unit, widths, output_gain, generator, true)
    }

    /// The same on top of other layers: its inputs are padded as activations are, and
    /// [`backward_to_inputs`](Self::backward_to_inputs) may be called.
    pub(crate) fn above(
        unit: VectorUnit,
        widths: &[usize],
        output_gain: f64,
        generator: &mut impl Rng,
    ) -> Self {
        Self::build(unit, widths, output_gain, generator, false)
    }

    fn build(
        unit: VectorUnit,
        widths: &[usize],
        output_gain: f64,
        generator: &mut impl Rng,
        on_observations: bool,
    ) -> Self {
        let mut layout = Layout::default();
        let last = widths.len() - 2;
        let hidden = (0..last)
            .map(|l| layout.hidden(on_observations && l == 0, widths[l], widths[l + 1]))
            .collect();
        let output = layout.output(widths[last], widths[last + 1]);
        let mut network = Self {
            unit,
            hidden,
            output,
            parameters: Buffer::zeros(layout.parameters),
            gradients: Buffer::zeros(layout.parameters),
            copies: Buffer::zeros(layout.copies),
        };
        initialise::orthogonal(&mut network, output_gain, generator);
        network.renew_copies();
        network
    }

    pub(crate) fn inputs(&self) -> usize {
        self.hidden[0].inputs
    }

    pub(crate) fn outputs(&self) -> usize {
        self.output.outputs
    }

    /// To be called after the parameters changed.
    pub(crate) fn renew_copies(&mut self) {
        let layers = self.hidden.iter().chain([&self.output]);
        for layer in layers.filter(|layer| !layer.copy.is_empty()) {
            let weights = &self.parameters[layer.weights.clone()];
            let copy = &mut self.copies[layer.copy.clone()];
            transpose(self.unit, layer.rows, layer.columns, weights, copy);
        }
    }

    /// Results `[output]` of `samples` inputs `[sample][input]`, keeping in `workspace` what
    /// [`backward`](Self::backward) needs.
    pub(crate) fn forward(
        &self,
        samples: usize,
        inputs: &[f32],
        workspace: &mut Workspace,
        results: &mut [Column],
    ) {
        debug_assert!(samples <= BLOCK && results.len() == self.outputs());
        for (l, layer) in self.hidden.iter().enumerate() {
            let (before, from) = workspace.activations.split_at_mut(l);
            let values = before.last().map_or(inputs, |activations| &activations[..]);
            let activations = &mut from[0][..samples * layer.columns];
            let shape = Shape {
                rows: samples,
                depth: layer.rows,
                columns: layer.columns,
            };
            let left = Left::Rows {
                values,
                stride: layer.rows,
            };
            let bias = Start::Row(&self.parameters[layer.bias.clone()]);
            let weights = &self.parameters[layer.weights.clone()];
            multiply(self.unit, shape, left, weights, bias, activations);
            apply_tanh(self.unit, activations);
        }
        let layer = &self.output;
        let columns = padded(layer.rows);
        let shape = Shape {
            rows: samples,
            depth: layer.columns,
            columns,
        };
        let values = &workspace.activations[self.hidden.len() - 1];
        let left = Left::Rows {
            values,
            stride: layer.columns,
        };
        let bias = Start::Row(&self.parameters[layer.bias.clone()]);
        let weights = &self.copies[layer.copy.clone()];
        multiply(
            self.unit,
            shape,
            left,
            weights,
            bias,
            &mut workspace.results,
        );
        let rows = workspace.results.chunks_exact(columns).take(samples);
        for (sample, row) in rows.enumerate() {
            for (result, value) in results.iter_mut().zip(row) {
                result[sample] = *value;
            }
        }
    }
}

/// Hands out places in the buffers.
#[derive(Default)]
struct Layout {
    parameters: usize,
    copies: usize,
}

impl Layout {
    fn hidden(&mut self, on_observations: bool, inputs: usize, outputs: usize) -> Layer {
        let rows = if on_observations {
            inputs
        } else {
            padded(inputs)
        };
        let columns = padded(outputs);
        let copy = if on_observations { 0 } else { rows * columns };
        let (weights, bias) = self.parameters(rows * columns, columns);
        Layer {
            inputs,
            outputs,
            rows,
            columns,
            weights,
            bias,
            copy: take(&mut self.copies, copy),
        }
    }

    fn output(&mut self, inputs: usize, outputs: usize) -> Layer {
        let (rows, columns) = (outputs, padded(inputs));
        let (weights, bias) = self.parameters(rows * columns, padded(outputs));
        let copy = take(&mut self.copies, columns * padded(rows));
        Layer {
            inputs,
            outputs,
            rows,
            columns,
            weights,
            bias,
            copy,
        }
    }

    fn parameters(&mut self, weights: usize, bias: usize) -> (Range<usize>, Range<usize>) {
        (
            take(&mut self.parameters, weights),
            take(&mut self.parameters, bias),
        )
    }
}

/// Hands out the next `length` places.
pub(crate) fn take(used: &mut usize, length: usize) -> Range<usize> {
    let start = *used;
    *used += length;
    start..*used
}
