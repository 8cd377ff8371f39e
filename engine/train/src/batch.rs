//! One block of samples where networks meet the loss.

use pubs_core::vector::VectorUnit;

use crate::kernels::column::{BLOCK, Column};
use crate::loss::{Distribution, Samples, Weights, policy_gradients, value_gradients};
use crate::normal::Normal;
use crate::rollout::Rollout;

/// What was stored of the samples, what the networks say of them, and the gradients of that.
#[derive(Debug)]
pub(crate) struct Batch {
    pub(crate) distribution: Distribution,
    pub(crate) values: [Column; 1],
    pub(crate) logit_gradients: Vec<Column>,
    pub(crate) value_gradients: [Column; 1],
    samples: Samples,
}

impl Batch {
    pub(crate) fn new(actions: usize) -> Self {
        let zero = [0.0; BLOCK];
        Self {
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
        }
    }

    /// Copies what was stored of a block of samples.
    pub(crate) fn gather(&mut self, rollout: &Rollout, block: &[u32], normal: Normal) {
        let actions = self.logit_gradients.len();
        for (b, &sample) in block.iter().enumerate() {
            let sample = sample as usize;
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

    /// Finds the gradients of the logits.
    pub(crate) fn find_logit_gradients(&mut self, unit: VectorUnit, weights: Weights) {
        self.distribution.normalise(unit);
        let gradients = &mut self.logit_gradients;
        policy_gradients(unit, weights, &self.samples, &self.distribution, gradients);
    }

    /// Finds the gradients of the values.
    pub(crate) fn find_value_gradients(&mut self, weights: Weights) {
        let [gradients] = &mut self.value_gradients;
        value_gradients(weights, &self.samples, &self.values[0], gradients);
    }
}
