//! One gradient step of perceptrons on one minibatch.

use std::ops::Range;

use pubs_core::vector::VectorUnit;

use crate::adam::Adam;
use crate::agent::{Actor, Agent, Update};
use crate::batch::Batch;
use crate::clip::clip_factor;
use crate::kernels::column::{BLOCK, Column};
use crate::loss::Weights;
use crate::network::{Network, Workspace};
use crate::normal::Normal;
use crate::recipe::Recipe;
use crate::rollout::{Rollout, Values};

/// The two networks, their optimisers, and memory for a block of samples.
#[derive(Debug)]
pub(crate) struct Learner {
    unit: VectorUnit,
    pub(crate) policy: Trainee,
    pub(crate) value: Trainee,
    batch: Batch,
    features: Vec<f32>,
}

/// A network that is being trained.
#[derive(Debug)]
pub(crate) struct Trainee {
    pub(crate) network: Network,
    pub(crate) workspace: Workspace,
    adam: Adam,
}

impl Trainee {
    pub(crate) fn new(network: Network, adam_epsilon: f32) -> Self {
        let adam = Adam::new(network.parameters.len(), adam_epsilon);
        Self {
            workspace: Workspace::new(&network),
            network,
            adam,
        }
    }

    fn step(&mut self, unit: VectorUnit, learning_rate: f32, gradient_scale: f32) {
        let Network {
            gradients,
            parameters,
            ..
        } = &mut self.network;
        self.adam
            .step(unit, learning_rate, gradient_scale, gradients, parameters);
        self.network.renew_copies();
    }

    /// Results of scaled observations `[n][feature]` by the network's one output.
    fn evaluate(&mut self, features: &[f32], results: &mut [f32]) {
        let Self {
            network, workspace, ..
        } = self;
        let mut columns = [[0.0; BLOCK]];
        let blocks = features.chunks(BLOCK * network.inputs());
        for (features, results) in blocks.zip(results.chunks_mut(BLOCK)) {
            network.forward(results.len(), features, workspace, &mut columns);
            results.copy_from_slice(&columns[0][..results.len()]);
        }
    }
}

impl Actor for &mut Trainee {
    fn logits(&mut self, copies: Range<usize>, features: &[f32], logits: &mut [Column]) {
        self.network
            .forward(copies.len(), features, &mut self.workspace, logits);
    }

    /// A perceptron remembers nothing.
    fn begin_episode(&mut self, _copy: usize) {}
}

impl Agent for Learner {
    fn sequence(&self, _recipe: &Recipe) -> usize {
        1
    }

    fn actor(&mut self) -> impl Actor {
        &mut self.policy
    }

    fn estimate(&mut self, rollout: &mut Rollout, discount: f32, lambda: f32) {
        let mut values = Values::new(rollout);
        let value = &mut self.value;
        value.evaluate(&rollout.truncated.features, &mut values.lost);
        value.evaluate(&rollout.features, &mut values.samples);
        value.evaluate(rollout.next_features(), &mut values.next);
        rollout.estimate(&values, discount, lambda);
    }

    fn step(&mut self, rollout: &Rollout, minibatch: &[u32], update: Update) -> Result<(), f32> {
        self.find_gradients(rollout, minibatch, update);
        let parts: [&[f32]; 2] = [
            &self.policy.network.gradients,
            &self.value.network.gradients,
        ];
        let scale = clip_factor(self.unit, &parts, update.gradient_norm)?;
        self.policy.step(self.unit, update.learning_rate, scale);
        self.value.step(self.unit, update.learning_rate, scale);
        Ok(())
    }
}

impl Learner {
    pub(crate) fn new(unit: VectorUnit, policy: Trainee, value: Trainee) -> Self {
        Self {
            unit,
            batch: Batch::new(policy.network.outputs()),
            features: vec![0.0; BLOCK * policy.network.inputs()],
            policy,
            value,
        }
    }

    /// Fills the gradients of both networks with those of the loss.
    pub(crate) fn find_gradients(&mut self, rollout: &Rollout, minibatch: &[u32], update: Update) {
        self.policy.network.gradients.fill(0.0);
        self.value.network.gradients.fill(0.0);
        let weights = Weights::of(update, minibatch.len());
        let normal = Normal::of_samples(rollout, minibatch);
        for block in minibatch.chunks(BLOCK) {
            rollout.gather_features(block, &mut self.features);
            self.batch.gather(rollout, block, normal);
            self.add_gradients(block.len(), weights);
        }
    }

    /// Forward and backward through both networks.
    fn add_gradients(&mut self, count: usize, weights: Weights) {
        let Trainee {
            network, workspace, ..
        } = &mut self.policy;
        let logits = &mut self.batch.distribution.logits;
        network.forward(count, &self.features, workspace, logits);
        self.batch.find_logit_gradients(self.unit, weights);
        let gradients = &self.batch.logit_gradients;
        network.backward(count, &self.features, workspace, gradients);

        let Trainee {
            network, workspace, ..
        } = &mut self.value;
        network.forward(count, &self.features, workspace, &mut self.batch.values);
        self.batch.find_value_gradients(weights);
        let gradients = &self.batch.value_gradients;
        network.backward(count, &self.features, workspace, gradients);
    }
}

#[cfg(test)]
mod tests;
