//! From observations to the states of the last layer.

use pubs_core::vector::LANES;

use super::stack::{Layer, Stack};
use super::trace::{LayerTrace, Span, Trace};
use crate::kernels::gates::{Cells, PANEL, open_gates};
use crate::kernels::matrix::{Left, Shape, Start, multiply};

impl Stack {
    /// Goes through a span with these inputs `[sample][input]`, each row from its state
    /// `[row][layer][2][width]`, or from 0 where `starts` `[sample]` says that an episode starts
    /// (not read for the first step, whose states the caller knows). `trace` keeps what
    /// [`backward`](Self::backward) needs, and the states.
    pub(crate) fn forward(
        &self,
        span: Span,
        inputs: &[f32],
        starts: &[bool],
        states: &[f32],
        trace: &mut Trace,
    ) {
        trace.load_states(self, states);
        for (l, layer) in self.layers.iter().enumerate() {
            let (below, from) = trace.layers.split_at_mut(l);
            let inputs = below.last().map_or(inputs, |below| &below.leaving[0][..]);
            self.add_inputs(span, layer, inputs, &mut from[0]);
            for step in 0..span.steps {
                if step > 0 {
                    let starts = &starts[step * span.rows..][..span.rows];
                    from[0].carry_over(span, step, starts, layer.padded());
                }
                self.step(span, step, layer, &mut from[0]);
            }
        }
    }

    /// The part of the sums that needs no state, for all steps at once.
    fn add_inputs(&self, span: Span, layer: &Layer, inputs: &[f32], trace: &mut LayerTrace) {
        let rows = layer.input.rows;
        let shape = Shape {
            rows: span.samples(),
            depth: rows,
            columns: PANEL,
        };
        let left = Left::Rows {
            values: inputs,
            stride: rows,
        };
        let panels = self.parameters[layer.input.weights.clone()].chunks_exact(rows * PANEL);
        let biases = self.parameters[layer.bias.clone()].chunks_exact(PANEL);
        let sums = trace.gates.chunks_exact_mut(span.samples() * PANEL);
        for ((panel, bias), sums) in panels.zip(biases).zip(sums) {
            multiply(self.unit, shape, left, panel, Start::Row(bias), sums);
        }
    }

    /// One step of all rows.
    fn step(&self, span: Span, step: usize, layer: &Layer, trace: &mut LayerTrace) {
        let stride = layer.padded();
        let at = step * span.rows * stride;
        let [hidden, cell] = &mut trace.leaving;
        let shape = Shape {
            rows: span.rows,
            depth: stride,
            columns: PANEL,
        };
        let left = Left::Rows {
            values: &trace.entering[0][at..],
            stride,
        };
        let panels = self.parameters[layer.hidden.weights.clone()].chunks_exact(stride * PANEL);
        let gates = trace.gates.chunks_exact_mut(span.samples() * PANEL);
        for (group, (panel, gates)) in panels.zip(gates).enumerate() {
            let gates = &mut gates[step * span.rows * PANEL..][..span.rows * PANEL];
            multiply(self.unit, shape, left, panel, Start::Sum, gates);
            let first = at + group * LANES;
            let cells = Cells {
                cell: &mut cell[first..],
                cell_tanh: &mut trace.cell_tanh[first..],
                hidden: &mut hidden[first..],
            };
            open_gates(self.unit, stride, gates, &trace.entering[1][first..], cells);
        }
    }
}
