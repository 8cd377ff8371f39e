//! Recurrent layers with a perceptron on top.

use pubs_core::vector::VectorUnit;
use rand::Rng;

use super::Lstm;
use super::stack::Stack;
use super::trace::{Span, Trace};
use crate::kernels::column::{BLOCK, Column};
use crate::network::{Network, Workspace};

/// A policy or a value network that remembers.
#[derive(Debug)]
pub(crate) struct RecurrentNetwork {
    pub(crate) stack: Stack,
    pub(crate) head: Network,
}

/// Memory for one step of at most [`BLOCK`] rows.
#[derive(Debug)]
pub(crate) struct StepMemory {
    trace: Trace,
    workspace: Workspace,
}

impl RecurrentNetwork {
    /// `widths` are the perceptron's, from the recurrent layers' to the outputs.
    pub(crate) fn new(
        unit: VectorUnit,
        inputs: usize,
        lstm: Lstm,
        widths: &[usize],
        output_gain: f64,
        generator: &mut impl Rng,
    ) -> Self {
        Self {
            stack: Stack::new(unit, inputs, lstm, generator),
            head: Network::above(unit, widths, output_gain, generator),
        }
    }

    pub(crate) fn step_memory(&self) -> StepMemory {
        StepMemory {
            trace: Trace::new(&self.stack, BLOCK),
            workspace: Workspace::new(&self.head),
        }
    }

    /// One step of at most [`BLOCK`] rows: from scaled inputs `[row][input]` and states
    /// `[row][layer][2][width]`, which move on, to results `[output]`.
    pub(crate) fn step(
        &self,
        inputs: &[f32],
        states: &mut [f32],
        memory: &mut StepMemory,
        results: &mut [Column],
    ) {
        let StepMemory { trace, workspace } = memory;
        let size = self.stack.state_size();
        let rows = states.len() / size;
        self.stack
            .forward(Span { steps: 1, rows }, inputs, &[], states, trace);
        for (row, state) in states.chunks_exact_mut(size).enumerate() {
            trace.store_state(&self.stack, row, state);
        }
        self.head.forward(rows, trace.outputs(), workspace, results);
    }
}
