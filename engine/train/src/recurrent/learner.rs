//! One gradient step of recurrent networks on whole sequences.

use pubs_core::vector::VectorUnit;

use super::trace::Span;
use super::trainee::{Sequences, Trainee};
use crate::agent::{Actor, Agent, Update};
use crate::batch::Batch;
use crate::clip::clip_factor;
use crate::kernels::column::BLOCK;
use crate::loss::Weights;
use crate::normal::Normal;
use crate::recipe::Recipe;
use crate::rollout::{Rollout, Values};

/// The two networks, and memory for the sequences of a minibatch.
#[derive(Debug)]
pub(crate) struct RecurrentLearner {
    unit: VectorUnit,
    pub(crate) policy: Trainee,
    pub(crate) value: Trainee,
    batch: Batch,
    sequences: Sequences,
    /// Where the sequences' samples lie in the rollout, `[sample]`.
    samples: Vec<u32>,
    /// Most sequences that go together.
    most: usize,
}

impl RecurrentLearner {
    /// `largest` is the most that goes together, as the trainees have it.
    pub(crate) fn new(unit: VectorUnit, policy: Trainee, value: Trainee, largest: Span) -> Self {
        let samples = largest.samples();
        Self {
            unit,
            batch: Batch::new(policy.network.head.outputs()),
            sequences: Sequences {
                span: largest,
                features: vec![0.0; samples * policy.network.stack.inputs()],
                starts: vec![false; samples],
            },
            samples: Vec::with_capacity(samples),
            most: largest.rows,
            policy,
            value,
        }
    }

    /// Fills the gradients of both networks with those of the loss over the sequences of some
    /// copies.
    pub(crate) fn find_gradients(&mut self, rollout: &Rollout, copies: &[u32], update: Update) {
        self.gather(rollout, copies);
        self.policy.clear_gradients();
        self.value.clear_gradients();
        self.policy.forward(&self.sequences, copies);
        self.value.forward(&self.sequences, copies);
        let weights = Weights::of(update, self.samples.len());
        let normal = Normal::of_samples(rollout, &self.samples);
        for (b, samples) in self.samples.chunks(BLOCK).enumerate() {
            let block = b * BLOCK..b * BLOCK + samples.len();
            let batch = &mut self.batch;
            batch.gather(rollout, samples, normal);
            self.policy
                .head_forward(block.clone(), &mut batch.distribution.logits);
            batch.find_logit_gradients(self.unit, weights);
            self.policy
                .head_backward(block.clone(), &batch.logit_gradients);
            self.value.head_forward(block.clone(), &mut batch.values);
            batch.find_value_gradients(weights);
            self.value.head_backward(block, &batch.value_gradients);
        }
        self.policy.backward(&self.sequences);
        self.value.backward(&self.sequences);
    }

    /// Copies the sequences of some copies out of the rollout, step by step.
    fn gather(&mut self, rollout: &Rollout, copies: &[u32]) {
        let length = rollout.length();
        let step = |step| copies.iter().map(move |copy| copy * length as u32 + step);
        self.samples.clear();
        self.samples.extend((0..length as u32).flat_map(step));
        let Sequences {
            span,
            features,
            starts,
        } = &mut self.sequences;
        *span = Span {
            steps: length,
            rows: copies.len(),
        };
        rollout.gather_features(&self.samples, features);
        for (start, sample) in starts.iter_mut().zip(&self.samples) {
            let sample = *sample as usize;
            *start = !sample.is_multiple_of(length) && rollout.ended[sample - 1];
        }
    }

    /// Values of the sequences of some copies. Writes the states after truncated episodes
    /// `[truncation][layer][2][width]` and moves on those of the copies.
    fn value_sequences(
        &mut self,
        rollout: &Rollout,
        copies: &[u32],
        values: &mut [f32],
        truncated: &mut [f32],
    ) {
        self.gather(rollout, copies);
        self.value.forward(&self.sequences, copies);
        for (b, samples) in self.samples.chunks(BLOCK).enumerate() {
            let block = b * BLOCK..b * BLOCK + samples.len();
            self.value.head_forward(block, &mut self.batch.values);
            for (sample, value) in samples.iter().zip(&self.batch.values[0]) {
                values[*sample as usize] = *value;
            }
        }
        let size = self.value.network.stack.state_size();
        let states = truncated.chunks_exact_mut(size);
        for (sample, state) in rollout.truncated.samples.iter().zip(states) {
            let found = self.samples.iter().position(|s| *s as usize == *sample);
            if let Some(found) = found {
                let Trainee { network, trace, .. } = &self.value;
                trace.store_state(&network.stack, found, state);
            }
        }
        self.keep_last_states(rollout, copies);
    }

    /// Moves the value network's states of some copies to the end of their sequences.
    fn keep_last_states(&mut self, rollout: &Rollout, copies: &[u32]) {
        let length = rollout.length();
        let size = self.value.network.stack.state_size();
        let Trainee {
            network,
            trace,
            states,
            ..
        } = &mut self.value;
        for (row, copy) in copies.iter().enumerate() {
            let copy = *copy as usize;
            let state = &mut states[copy * size..][..size];
            if rollout.ended[copy * length + length - 1] {
                state.fill(0.0);
            } else {
                trace.store_state(&network.stack, (length - 1) * copies.len() + row, state);
            }
        }
    }
}

impl Agent for RecurrentLearner {
    fn sequence(&self, recipe: &Recipe) -> usize {
        recipe.rollout
    }

    fn actor(&mut self) -> impl Actor {
        for trainee in [&mut self.policy, &mut self.value] {
            trainee.first_states.clone_from(&trainee.states);
        }
        &mut self.policy
    }

    fn estimate(&mut self, rollout: &mut Rollout, discount: f32, lambda: f32) {
        let mut values = Values::new(rollout);
        let size = self.value.network.stack.state_size();
        let mut truncated = vec![0.0; values.lost.len() * size];
        let copies: Vec<u32> = (0..rollout.environments() as u32).collect();
        for copies in copies.chunks(self.most) {
            self.value_sequences(rollout, copies, &mut values.samples, &mut truncated);
        }
        let features = &rollout.truncated.features;
        self.value
            .evaluate(features, &mut truncated, &mut values.lost);
        let mut states = self.value.states.clone();
        self.value
            .evaluate(rollout.next_features(), &mut states, &mut values.next);
        rollout.estimate(&values, discount, lambda);
    }

    fn step(&mut self, rollout: &Rollout, minibatch: &[u32], update: Update) -> Result<(), f32> {
        self.find_gradients(rollout, minibatch, update);
        let parts = [self.policy.gradients(), self.value.gradients()];
        let scale = clip_factor(self.unit, parts.as_flattened(), update.gradient_norm)?;
        self.policy.step(self.unit, update.learning_rate, scale);
        self.value.step(self.unit, update.learning_rate, scale);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
