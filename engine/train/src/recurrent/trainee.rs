//! One recurrent network in training.

use std::ops::Range;

use pubs_core::vector::VectorUnit;

use super::backward::Returning;
use super::network::{RecurrentNetwork, StepMemory};
use super::trace::{Span, Trace};
use crate::adam::Adam;
use crate::agent::Actor;
use crate::kernels::column::{BLOCK, Column};
use crate::network::{Network, Workspace};

/// A network, its optimisers, its memory for sequences, and the states of the copies.
#[derive(Debug)]
pub(crate) struct Trainee {
    pub(crate) network: RecurrentNetwork,
    stack_adam: Adam,
    head_adam: Adam,
    workspace: Workspace,
    pub(super) trace: Trace,
    returning: Returning,
    memory: StepMemory,
    /// Present states `[copy][layer][2][width]`.
    pub(super) states: Vec<f32>,
    /// What they were when the rollout began.
    pub(super) first_states: Vec<f32>,
}

/// Sequences that are gone through together.
#[derive(Debug)]
pub(super) struct Sequences {
    pub(super) span: Span,
    /// Scaled, `[sample][feature]`.
    pub(super) features: Vec<f32>,
    /// Whether an episode starts, `[sample]`.
    pub(super) starts: Vec<bool>,
}

impl Trainee {
    /// For `copies` of a task and at most `largest` sequences.
    pub(crate) fn new(
        network: RecurrentNetwork,
        copies: usize,
        largest: Span,
        adam_epsilon: f32,
    ) -> Self {
        let states = vec![0.0; copies * network.stack.state_size()];
        Self {
            stack_adam: Adam::new(network.stack.parameters.len(), adam_epsilon),
            head_adam: Adam::new(network.head.parameters.len(), adam_epsilon),
            workspace: Workspace::new(&network.head),
            trace: Trace::new(&network.stack, largest.samples()),
            returning: Returning::new(&network.stack, largest),
            memory: network.step_memory(),
            first_states: states.clone(),
            states,
            network,
        }
    }

    pub(super) fn clear_gradients(&mut self) {
        self.network.stack.gradients.fill(0.0);
        self.network.head.gradients.fill(0.0);
    }

    pub(super) fn gradients(&self) -> [&[f32]; 2] {
        [&self.network.stack.gradients, &self.network.head.gradients]
    }

    pub(super) fn step(&mut self, unit: VectorUnit, learning_rate: f32, gradient_scale: f32) {
        let stack = &mut self.network.stack;
        self.stack_adam.step(
            unit,
            learning_rate,
            gradient_scale,
            &stack.gradients,
            &mut stack.parameters,
        );
        stack.renew_copies();
        let Network {
            gradients,
            parameters,
            ..
        } = &mut self.network.head;
        self.head_adam
            .step(unit, learning_rate, gradient_scale, gradients, parameters);
        self.network.head.renew_copies();
    }

    /// Takes sequences of these copies through the recurrent layers, from the states at the
    /// beginning of the rollout.
    pub(super) fn forward(&mut self, sequences: &Sequences, copies: &[u32]) {
        let size = self.network.stack.state_size();
        let state = |copy: &u32| &self.first_states[*copy as usize * size..][..size];
        let states: Vec<f32> = copies.iter().flat_map(state).copied().collect();
        let Sequences {
            span,
            features,
            starts,
        } = sequences;
        self.network
            .stack
            .forward(*span, features, starts, &states, &mut self.trace);
    }

    /// Results `[output]` of a block of samples after [`forward`](Self::forward).
    pub(super) fn head_forward(&mut self, block: Range<usize>, results: &mut [Column]) {
        let inputs = &self.trace.outputs()[block.start * self.network.stack.outputs()..];
        self.network
            .head
            .forward(block.len(), inputs, &mut self.workspace, results);
    }

    /// Takes the gradients of the latest results back to the recurrent layers' last states.
    pub(super) fn head_backward(&mut self, block: Range<usize>, result_gradients: &[Column]) {
        let start = block.start * self.network.stack.outputs();
        self.network.head.backward_to_inputs(
            block.len(),
            &self.trace.outputs()[start..],
            &mut self.workspace,
            result_gradients,
            &mut self.returning.hidden[start..],
        );
    }

    /// Takes them back through time, once every block's are there.
    pub(super) fn backward(&mut self, sequences: &Sequences) {
        let Sequences {
            span,
            features,
            starts,
        } = sequences;
        let (trace, returning) = (&mut self.trace, &mut self.returning);
        self.network
            .stack
            .backward(*span, features, starts, trace, returning);
    }

    /// Results by the first output, one step on from states `[n][layer][2][width]` with scaled
    /// observations `[n][feature]`.
    pub(super) fn evaluate(&mut self, features: &[f32], states: &mut [f32], results: &mut [f32]) {
        let (inputs, size) = (self.network.stack.inputs(), self.network.stack.state_size());
        let rows = features
            .chunks(BLOCK * inputs)
            .zip(states.chunks_mut(BLOCK * size));
        let mut columns = vec![[0.0; BLOCK]; self.network.head.outputs()];
        for ((features, states), results) in rows.zip(results.chunks_mut(BLOCK)) {
            self.network
                .step(features, states, &mut self.memory, &mut columns);
            results.copy_from_slice(&columns[0][..results.len()]);
        }
    }

    /// The state of one copy.
    pub(super) fn state_mut(&mut self, copy: usize) -> &mut [f32] {
        let size = self.network.stack.state_size();
        &mut self.states[copy * size..][..size]
    }
}

impl Actor for &mut Trainee {
    fn logits(&mut self, copies: Range<usize>, features: &[f32], logits: &mut [Column]) {
        let size = self.network.stack.state_size();
        let states = &mut self.states[copies.start * size..copies.end * size];
        self.network
            .step(features, states, &mut self.memory, logits);
    }

    fn begin_episode(&mut self, copy: usize) {
        self.state_mut(copy).fill(0.0);
    }
}
