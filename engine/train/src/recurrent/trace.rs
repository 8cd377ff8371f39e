//! What a forward pass through the layers leaves behind.

use super::stack::{Layer, Stack};
use crate::kernels::buffer::Buffer;
use crate::kernels::gates::PANEL;

/// Sequences side by side. Sample `step · rows + row` is one step of one of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) steps: usize,
    pub(crate) rows: usize,
}

impl Span {
    pub(crate) fn samples(self) -> usize {
        self.steps * self.rows
    }
}

/// Memory for a span of samples, layer by layer.
#[derive(Debug)]
pub(crate) struct Trace {
    pub(super) layers: Vec<LayerTrace>,
}

/// Of one layer, with padding.
#[derive(Debug)]
pub(super) struct LayerTrace {
    /// Gates, and on the way back the gradients of their sums, `[group][sample][PANEL]`.
    pub(super) gates: Buffer,
    /// h and c before each sample, `[sample][unit]`: 0 where an episode starts.
    pub(super) entering: [Buffer; 2],
    /// h and c after it.
    pub(super) leaving: [Buffer; 2],
    /// tanh of the latter.
    pub(super) cell_tanh: Buffer,
}

impl Trace {
    pub(crate) fn new(stack: &Stack, samples: usize) -> Self {
        let layer = |layer: &Layer| {
            let states = || Buffer::zeros(samples * layer.padded());
            LayerTrace {
                gates: Buffer::zeros(samples * layer.groups() * PANEL),
                entering: [states(), states()],
                leaving: [states(), states()],
                cell_tanh: states(),
            }
        };
        Self {
            layers: stack.layers.iter().map(layer).collect(),
        }
    }

    /// h of the last layer, `[sample][unit]`, padded.
    pub(crate) fn outputs(&self) -> &[f32] {
        &self.layers[self.layers.len() - 1].leaving[0]
    }

    /// Writes the state `[layer][2][width]` after a sample.
    pub(crate) fn store_state(&self, stack: &Stack, sample: usize, state: &mut [f32]) {
        let mut rest = state;
        for (layer, trace) in stack.layers.iter().zip(&self.layers) {
            for numbers in &trace.leaving {
                let (part, after) = rest.split_at_mut(layer.width);
                part.copy_from_slice(&numbers[sample * layer.padded()..][..layer.width]);
                rest = after;
            }
        }
    }

    /// Lets the states `[row][layer][2][width]` enter the first step.
    pub(super) fn load_states(&mut self, stack: &Stack, states: &[f32]) {
        for (row, state) in states.chunks_exact(stack.state_size()).enumerate() {
            let mut rest = state;
            for (layer, trace) in stack.layers.iter().zip(&mut self.layers) {
                for numbers in &mut trace.entering {
                    let (part, after) = rest.split_at(layer.width);
                    numbers[row * layer.padded()..][..layer.width].copy_from_slice(part);
                    rest = after;
                }
            }
        }
    }
}

impl LayerTrace {
    /// Lets what left a step enter the next one, but where an episode starts.
    pub(super) fn carry_over(&mut self, span: Span, step: usize, starts: &[bool], width: usize) {
        let (before, at) = ((step - 1) * span.rows * width, step * span.rows * width);
        let size = span.rows * width;
        for (entering, leaving) in self.entering.iter_mut().zip(&self.leaving) {
            entering[at..][..size].copy_from_slice(&leaving[before..][..size]);
            clear_starts(starts, width, &mut entering[at..][..size]);
        }
    }
}

/// Makes the rows 0 where an episode starts.
pub(super) fn clear_starts(starts: &[bool], width: usize, rows: &mut [f32]) {
    let rows = rows.chunks_exact_mut(width).zip(starts);
    rows.filter(|(_, start)| **start)
        .for_each(|(row, _)| row.fill(0.0));
}
