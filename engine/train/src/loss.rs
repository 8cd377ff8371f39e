//! PPO's loss of one block of samples, as gradients of what the networks put out.

use pubs_core::vector::{Arithmetic, VectorUnit, dispatched, exp, ln};

use crate::agent::Update;
use crate::kernels::column::{BLOCK, Column};

/// Stands for the logit of an action that is masked out.
const MASKED: f32 = -1e30;

/// Probabilities of the actions of a block, `[action]` columns.
#[derive(Debug, Clone)]
pub(crate) struct Distribution {
    pub(crate) logits: Vec<Column>,
    /// 1 where the action may be taken, 0 where it is masked out.
    pub(crate) allowed: Vec<Column>,
    /// 0 where masked out.
    pub(crate) probabilities: Vec<Column>,
    /// Not to be read where masked out.
    pub(crate) log_probabilities: Vec<Column>,
}

impl Distribution {
    pub(crate) fn new(actions: usize) -> Self {
        let zeros = vec![[0.0; BLOCK]; actions];
        Self {
            logits: zeros.clone(),
            allowed: vec![[1.0; BLOCK]; actions],
            probabilities: zeros.clone(),
            log_probabilities: zeros,
        }
    }

    /// Finds the probabilities from the logits and the mask.
    pub(crate) fn normalise(&mut self, unit: VectorUnit) {
        log_softmax(
            unit,
            &self.logits,
            &self.allowed,
            &mut self.probabilities,
            &mut self.log_probabilities,
        );
    }
}

/// What was stored of a block's samples when they were collected.
#[derive(Debug, Clone)]
pub(crate) struct Samples {
    /// Index of the action taken.
    pub(crate) actions: Column,
    /// Logarithm of its probability under the policy that took it.
    pub(crate) log_probabilities: Column,
    /// Advantage, normalised over the minibatch.
    pub(crate) advantages: Column,
    /// What the value network should say.
    pub(crate) returns: Column,
}

/// The weights of the parts of the loss.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Weights {
    pub(crate) clip_range: f32,
    pub(crate) entropy_coefficient: f32,
    pub(crate) value_coefficient: f32,
    /// 1 / samples in the minibatch.
    pub(crate) sample: f32,
}

impl Weights {
    /// For a minibatch of `samples`.
    pub(crate) fn of(update: Update, samples: usize) -> Self {
        Self {
            clip_range: update.clip_range,
            entropy_coefficient: update.entropy_coefficient,
            value_coefficient: update.value_coefficient,
            sample: 1.0 / samples as f32,
        }
    }
}

dispatched! {
    /// Softmax over the allowed actions and its logarithm, all `[action]`.
    fn log_softmax(
        logits: &[Column],
        allowed: &[Column],
        probabilities: &mut [Column],
        log_probabilities: &mut [Column],
    ) = log_softmax_body
}

#[inline(always)]
fn log_softmax_body<A: Arithmetic>(
    logits: &[Column],
    allowed: &[Column],
    probabilities: &mut [Column],
    log_probabilities: &mut [Column],
) {
    let mut largest = [MASKED; BLOCK];
    for (logits, allowed) in logits.iter().zip(allowed) {
        for b in 0..BLOCK {
            let logit = if allowed[b] > 0.0 { logits[b] } else { MASKED };
            largest[b] = if logit > largest[b] {
                logit
            } else {
                largest[b]
            };
        }
    }
    let mut sum = [0.0; BLOCK];
    for ((logits, allowed), probabilities) in logits.iter().zip(allowed).zip(&mut *probabilities) {
        for b in 0..BLOCK {
            probabilities[b] = allowed[b] * exp::<A>(logits[b] - largest[b]);
            sum[b] += probabilities[b];
        }
    }
    let mut log_sum = [0.0; BLOCK];
    for b in 0..BLOCK {
        log_sum[b] = ln::<A>(sum[b]);
        sum[b] = 1.0 / sum[b];
    }
    let results = probabilities.iter_mut().zip(log_probabilities);
    for (logits, (probabilities, log_probabilities)) in logits.iter().zip(results) {
        for b in 0..BLOCK {
            probabilities[b] *= sum[b];
            log_probabilities[b] = logits[b] - largest[b] - log_sum[b];
        }
    }
}

dispatched! {
    /// Gradients of the logits, for the loss to be made small
    ///
    /// mean over samples of −min(A·r, A·clip(r, 1 ± clip_range)) − entropy_coefficient · H,
    ///
    /// r = π(a) / π_old(a) and H = −Σ π ln π.
    pub(crate) fn policy_gradients(
        weights: Weights,
        samples: &Samples,
        policy: &Distribution,
        logit_gradients: &mut [Column],
    ) = policy_gradients_body
}

#[inline(always)]
fn policy_gradients_body<A: Arithmetic>(
    weights: Weights,
    samples: &Samples,
    policy: &Distribution,
    logit_gradients: &mut [Column],
) {
    let mut entropy = [0.0; BLOCK];
    let mut log_probability = [0.0; BLOCK];
    for (action, logs) in policy.log_probabilities.iter().enumerate() {
        let (action, probabilities) = (action as f32, &policy.probabilities[action]);
        for b in 0..BLOCK {
            entropy[b] = A::multiply_add(-probabilities[b], logs[b], entropy[b]);
            log_probability[b] = if samples.actions[b] == action {
                logs[b]
            } else {
                log_probability[b]
            };
        }
    }
    // dL/d ln π(a): nothing where the clipped term is the smaller one, as it does not move.
    let mut pull = [0.0; BLOCK];
    let (low, high) = (1.0 - weights.clip_range, 1.0 + weights.clip_range);
    for b in 0..BLOCK {
        let advantage = samples.advantages[b];
        let ratio = exp::<A>(log_probability[b] - samples.log_probabilities[b]);
        let clipped = (advantage > 0.0 && ratio > high) || (advantage < 0.0 && ratio < low);
        pull[b] = if clipped { 0.0 } else { -advantage * ratio };
    }
    for (action, gradients) in logit_gradients.iter_mut().enumerate() {
        let probabilities = &policy.probabilities[action];
        let logs = &policy.log_probabilities[action];
        let action = action as f32;
        for b in 0..BLOCK {
            let taken = if samples.actions[b] == action {
                1.0
            } else {
                0.0
            };
            let of_entropy = probabilities[b] * (logs[b] + entropy[b]);
            let of_ratio = pull[b] * (taken - probabilities[b]);
            gradients[b] =
                weights.sample * A::multiply_add(weights.entropy_coefficient, of_entropy, of_ratio);
        }
    }
}

/// Gradients of the values, for value_coefficient · mean (V − return)² to be made small.
pub(crate) fn value_gradients(
    weights: Weights,
    samples: &Samples,
    values: &Column,
    gradients: &mut Column,
) {
    let factor = 2.0 * weights.value_coefficient * weights.sample;
    for b in 0..BLOCK {
        gradients[b] = factor * (values[b] - samples.returns[b]);
    }
}
