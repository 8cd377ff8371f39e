//! One gradient step on one minibatch.

use pubs_core::vector::VectorUnit;

use crate::adam::Adam;
use crate::kernels::column::{BLOCK, Column};
use crate::kernels::sum::sum_of_squares;
use crate::loss::{Distribution, Samples, Weights, policy_gradients, value_gradients};
use crate::network::{Network, Workspace};
use crate::rollout::Rollout;

/// Keeps the division by a length or a spread that is 0 finite, as stable-baselines3 has them.
const NORM_FLOOR: f32 = 1e-6;
const DEVIATION_FLOOR: f32 = 1e-8;

/// The two networks, their optimisers, and memory for a block of samples.
#[derive(Debug)]
pub(crate) struct Learner {
    unit: VectorUnit,
    pub(crate) policy: Trainee,
    pub(crate) value: Trainee,
    distribution: Distribution,
    values: [Column; 1],
    logit_gradients: Vec<Column>,
    value_gradients: [Column; 1],
    samples: Samples,
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
}

/// Numbers of the present update.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Update {
    pub(crate) learning_rate: f32,
    pub(crate) clip_range: f32,
    pub(crate) entropy_coefficient: f32,
    pub(crate) value_coefficient: f32,
    /// Longest gradient, over both networks together.
    pub(crate) gradient_norm: f32,
}

impl Learner {
    pub(crate) fn new(unit: VectorUnit, policy: Trainee, value: Trainee) -> Self {
        let actions = policy.network.outputs();
        let zero = [0.0; BLOCK];
        Self {
            unit,
            distribution: Distribution::new(actions),
            values: [zero],
            logit_gradients: vec![zero; actions],
            value_gradients: [zero],
            samples: Samples {
                actions: zero,
                log_probabilities: zero,
                advantages: zero,
                returns: zero,
            },
            features: vec![0.0; BLOCK * policy.network.inputs()],
            policy,
            value,
        }
    }

    /// Moves both networks by one step on these samples; an error is the length of a gradient that
    /// is not finite.
    pub(crate) fn step(
        &mut self,
        rollout: &Rollout,
        minibatch: &[u32],
        update: Update,
    ) -> Result<(), f32> {
        self.find_gradients(rollout, minibatch, update);
        let mut squares = [0.0; 2];
        sum_of_squares(self.unit, &self.policy.network.gradients, &mut squares[0]);
        sum_of_squares(self.unit, &self.value.network.gradients, &mut squares[1]);
        let norm = (squares[0] + squares[1]).sqrt();
        if !norm.is_finite() {
            return Err(norm);
        }
        let scale = (update.gradient_norm / (norm + NORM_FLOOR)).min(1.0);
        self.policy.step(self.unit, update.learning_rate, scale);
        self.value.step(self.unit, update.learning_rate, scale);
        Ok(())
    }

    /// Fills the gradients of both networks with those of the loss.
    pub(crate) fn find_gradients(&mut self, rollout: &Rollout, minibatch: &[u32], update: Update) {
        self.policy.network.gradients.fill(0.0);
        self.value.network.gradients.fill(0.0);
        let weights = Weights {
            clip_range: update.clip_range,
            entropy_coefficient: update.entropy_coefficient,
            value_coefficient: update.value_coefficient,
            sample: 1.0 / minibatch.len() as f32,
        };
        let normal = Normal::of(minibatch.iter().map(|&i| rollout.advantages[i as usize]));
        for block in minibatch.chunks(BLOCK) {
            self.gather(rollout, block, normal);
            self.add_gradients(block.len(), weights);
        }
    }

    /// Forward and backward through both networks.
    fn add_gradients(&mut self, count: usize, weights: Weights) {
        let Trainee {
            network, workspace, ..
        } = &mut self.policy;
        network.forward(
            count,
            &self.features,
            workspace,
            &mut self.distribution.logits,
        );
        self.distribution.normalise(self.unit);
        let gradients = &mut self.logit_gradients;
        policy_gradients(
            self.unit,
            weights,
            &self.samples,
            &self.distribution,
            gradients,
        );
        network.backward(count, &self.features, workspace, gradients);

        let Trainee {
            network, workspace, ..
        } = &mut self.value;
        network.forward(count, &self.features, workspace, &mut self.values);
        let [gradients] = &mut self.value_gradients;
        value_gradients(weights, &self.samples, &self.values[0], gradients);
        network.backward(count, &self.features, workspace, &self.value_gradients);
    }

    /// Copies a block of samples out of the rollout.
    fn gather(&mut self, rollout: &Rollout, block: &[u32], normal: Normal) {
        let width = self.policy.network.inputs();
        let actions = self.logit_gradients.len();
        for (b, &sample) in block.iter().enumerate() {
            let sample = sample as usize;
            // Element by element: a call of `memcpy` costs more than a few numbers.
            let features = &rollout.features[sample * width..][..width];
            self.features[b * width..]
                .iter_mut()
                .zip(features)
                .for_each(|(to, from)| *to = *from);
            let mask = &rollout.allowed[sample * actions..][..actions];
            for (column, allowed) in self.distribution.allowed.iter_mut().zip(mask) {
                column[b] = *allowed;
            }
            self.samples.actions[b] = rollout.taken[sample];
            self.samples.log_probabilities[b] = rollout.log_probabilities[sample];
            self.samples.advantages[b] = normal.apply(rollout.advantages[sample]);
            self.samples.returns[b] = rollout.returns[sample];
        }
    }
}

/// Brings numbers to mean 0 and standard deviation 1.
#[derive(Debug, Clone, Copy)]
struct Normal {
    mean: f32,
    factor: f32,
}

impl Normal {
    /// A single number has no spread and stays as it is.
    fn of(numbers: impl ExactSizeIterator<Item = f32> + Clone) -> Self {
        let count = numbers.len() as f32;
        if count < 2.0 {
            return Self {
                mean: 0.0,
                factor: 1.0,
            };
        }
        let mean = numbers.clone().sum::<f32>() / count;
        let variance = numbers.map(|x| (x - mean) * (x - mean)).sum::<f32>() / (count - 1.0);
        Self {
            mean,
            factor: 1.0 / (variance.sqrt() + DEVIATION_FLOOR),
        }
    }

    fn apply(self, number: f32) -> f32 {
        (number - self.mean) * self.factor
    }
}

#[cfg(test)]
mod tests;
