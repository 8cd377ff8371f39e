//! Back-propagation through time.

use pubs_core::vector::LANES;

use super::stack::{Layer, Matrix, Stack};
use super::trace::{LayerTrace, Span, Trace, clear_starts};
use crate::kernels::buffer::Buffer;
use crate::kernels::gates::{Kept, PANEL, close_gates};
use crate::kernels::matrix::{Left, Shape, Start, multiply, padded};

/// Samples whose gradients stay in the nearest cache while they meet all rows of a matrix.
const DEPTH: usize = 64;

/// Gradients on their way back.
#[derive(Debug)]
pub(crate) struct Returning {
    /// Of h of the layer that the way back has reached, `[sample][unit]`, padded.
    pub(crate) hidden: Buffer,
    /// Of h and c between two steps, `[row][unit]`.
    carried: [Buffer; 2],
}

impl Returning {
    pub(crate) fn new(stack: &Stack, span: Span) -> Self {
        let rows = || Buffer::zeros(span.rows * stack.outputs());
        Self {
            hidden: Buffer::zeros(span.samples() * stack.outputs()),
            carried: [rows(), rows()],
        }
    }
}

impl Stack {
    /// Adds to the gradients what follows from those of the last layer's h, in
    /// `returning.hidden`, for the latest [`forward`](Self::forward), which must have had the same
    /// span, inputs and starts. None passes from the first sample of an episode to the one before
    /// it, nor out of the span.
    pub(crate) fn backward(
        &mut self,
        span: Span,
        inputs: &[f32],
        starts: &[bool],
        trace: &mut Trace,
        returning: &mut Returning,
    ) {
        for l in (0..self.layers.len()).rev() {
            let layer = self.layers[l].clone();
            let (below, from) = trace.layers.split_at_mut(l);
            let trace = &mut from[0];
            self.backward_in_time(span, &layer, starts, trace, returning);
            let inputs = below.last().map_or(inputs, |below| &below.leaving[0][..]);
            self.weight_gradients(span, &layer.input, inputs, &trace.gates);
            self.weight_gradients(span, &layer.hidden, &trace.entering[0], &trace.gates);
            if l > 0 {
                let gates = &trace.gates;
                let samples = (0, span.samples());
                self.input_gradients(span, &layer.input, gates, samples, &mut returning.hidden);
            }
        }
    }

    /// Turns the gates of a layer into the gradients of their sums, last step first.
    fn backward_in_time(
        &mut self,
        span: Span,
        layer: &Layer,
        starts: &[bool],
        trace: &mut LayerTrace,
        returning: &mut Returning,
    ) {
        let width = layer.padded();
        let size = span.rows * width;
        let Returning { hidden, carried } = returning;
        carried
            .iter_mut()
            .for_each(|carried| carried[..size].fill(0.0));
        for step in (0..span.steps).rev() {
            let at = hidden[step * size..][..size].iter_mut();
            at.zip(&carried[0][..size]).for_each(|(h, c)| *h += c);
            self.close_step(span, step, layer, trace, hidden, &mut carried[1]);
            if step > 0 {
                let samples = (step * span.rows, span.rows);
                let gates = &trace.gates;
                self.input_gradients(span, &layer.hidden, gates, samples, &mut carried[0]);
                for carried in &mut *carried {
                    let starts = &starts[step * span.rows..][..span.rows];
                    clear_starts(starts, width, &mut carried[..size]);
                }
            }
        }
    }

    fn close_step(
        &mut self,
        span: Span,
        step: usize,
        layer: &Layer,
        trace: &mut LayerTrace,
        hidden: &[f32],
        cell_gradients: &mut [f32],
    ) {
        let stride = layer.padded();
        let gates = trace.gates.chunks_exact_mut(span.samples() * PANEL);
        let biases = self.gradients[layer.bias.clone()].chunks_exact_mut(PANEL);
        for (group, (gates, bias)) in gates.zip(biases).enumerate() {
            let first = step * span.rows * stride + group * LANES;
            let kept = Kept {
                entering: &trace.entering[1][first..],
                cell_tanh: &trace.cell_tanh[first..],
                hidden_gradients: &hidden[first..],
            };
            close_gates(
                self.unit,
                stride,
                &mut gates[step * span.rows * PANEL..][..span.rows * PANEL],
                kept,
                &mut cell_gradients[group * LANES..],
                bias,
            );
        }
    }

    /// Adds inputsᵀ · gradients, over all samples at once.
    fn weight_gradients(&mut self, span: Span, matrix: &Matrix, inputs: &[f32], gates: &[f32]) {
        let sums = &mut self.gradients[matrix.weights.clone()];
        let panels = sums.chunks_exact_mut(matrix.rows * PANEL);
        let gates = gates.chunks_exact(span.samples() * PANEL);
        for (sums, gates) in panels.zip(gates) {
            for (gates, inputs) in gates
                .chunks(DEPTH * PANEL)
                .zip(inputs.chunks(DEPTH * matrix.rows))
            {
                let shape = Shape {
                    rows: matrix.rows,
                    depth: gates.len() / PANEL,
                    columns: PANEL,
                };
                let left = Left::Columns {
                    values: inputs,
                    stride: matrix.rows,
                };
                multiply(self.unit, shape, left, gates, Start::Sum, sums);
            }
        }
    }

    /// gradients · weightsᵀ of some samples (the first and their number), `[sample][row]`.
    fn input_gradients(
        &self,
        span: Span,
        matrix: &Matrix,
        gates: &[f32],
        (first, samples): (usize, usize),
        input_gradients: &mut [f32],
    ) {
        let columns = padded(matrix.rows);
        let shape = Shape {
            rows: samples,
            depth: PANEL,
            columns,
        };
        let copies = self.copies[matrix.copy.clone()].chunks_exact(PANEL * columns);
        let gates = gates.chunks_exact(span.samples() * PANEL);
        for (group, (copy, gates)) in copies.zip(gates).enumerate() {
            let left = Left::Rows {
                values: &gates[first * PANEL..],
                stride: PANEL,
            };
            let start = if group == 0 { Start::Zero } else { Start::Sum };
            multiply(self.unit, shape, left, copy, start, input_gradients);
        }
    }
}
