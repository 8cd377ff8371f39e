//! The loss a second time, plainly and in `f64`, to test gradients against: by central differences.

use crate::agent::Update;
use crate::environment::{End, Environments, StepOutcome};
use crate::kernels::column::{BLOCK, Column};
use crate::kernels::matrix::padded;
use crate::network::{DenseLayer, Network, Workspace};
use crate::rng::stream;
use crate::rollout::Rollout;
use rand::RngExt;

pub(crate) const FEATURES: usize = 2;
pub(crate) const ACTIONS: usize = 4;

pub(crate) const UPDATE: Update = Update {
    learning_rate: 0.0,
    clip_range: 0.2,
    entropy_coefficient: 0.05,
    value_coefficient: 0.5,
    gradient_norm: 0.5,
};

/// Copies that see the time and end their episodes at times of their own.
pub(crate) struct Clocks {
    pub(crate) copies: usize,
    pub(crate) time: usize,
}

impl Environments for Clocks {
    type Error = std::convert::Infallible;

    fn count(&self) -> usize {
        self.copies
    }

    fn features(&self) -> usize {
        FEATURES
    }

    fn actions(&self) -> usize {
        ACTIONS
    }

    fn observe(&self, features: &mut [f32], allowed: &mut [bool]) {
        allowed.fill(true);
        for (copy, row) in features.chunks_exact_mut(FEATURES).enumerate() {
            let angle = (self.time * (copy + 1)) as f32;
            row.copy_from_slice(&[angle.sin(), angle.cos()]);
        }
    }

    fn step(&mut self, _: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), Self::Error> {
        self.time += 1;
        for (copy, outcome) in outcomes.iter_mut().enumerate() {
            let ends = (self.time + copy).is_multiple_of(copy + 4);
            *outcome = StepOutcome {
                end: ends.then_some(End::Terminated),
                ..StepOutcome::default()
            };
        }
        Ok(())
    }

    fn last_features(&self, _index: usize, _features: &mut [f32]) {}
}

/// Samples under an old policy that differs enough to clip some of them.
pub(crate) fn samples(copies: usize, length: usize) -> Rollout {
    let mut rollout = Rollout::new(&Clocks { copies, time: 0 }, length);
    let mut generator = stream(5, "samples");
    let mut between = |from: f32, to: f32| generator.random_range(from..to);
    rollout.features.fill_with(|| between(-1.5, 1.5));
    rollout.advantages.fill_with(|| between(-2.0, 3.0));
    rollout.returns.fill_with(|| between(-1.0, 1.0));
    for sample in 0..rollout.samples() {
        let taken = sample % ACTIONS;
        rollout.taken[sample] = taken as f32;
        for action in 0..ACTIONS {
            // Every third sample may take two actions only.
            let allowed = sample % 3 != 0 || action == taken || action == (taken + 1) % ACTIONS;
            rollout.allowed[sample * ACTIONS + action] = f32::from(u8::from(allowed));
        }
        let count = if sample % 3 == 0 { 2.0 } else { 4.0 };
        rollout.log_probabilities[sample] = between(0.4, 1.6).ln() - f32::ln(count);
    }
    rollout
}

/// Biases start at 0, where a mistake in them could hide; a gradient step moves them.
pub(crate) fn perturb_biases(network: &mut Network) {
    let mut inputs = vec![0.0; padded(network.inputs())];
    inputs[..network.inputs()].fill(0.3);
    let mut workspace = Workspace::new(network);
    let mut results = vec![[0.0; BLOCK]; network.outputs()];
    network.forward(1, &inputs, &mut workspace, &mut results);
    let gradients: Vec<Column> = (0..network.outputs())
        .map(|o| [1.0 + o as f32; BLOCK])
        .collect();
    network.backward(1, &inputs, &mut workspace, &gradients);
    let Network {
        parameters,
        gradients,
        ..
    } = network;
    parameters
        .iter_mut()
        .zip(gradients.iter())
        .for_each(|(p, g)| *p -= 0.05 * g);
    network.renew_copies();
}

pub(crate) fn in_f64(numbers: &[f32]) -> Vec<f64> {
    numbers.iter().map(|x| f64::from(*x)).collect()
}

/// Weights and bias of each layer.
pub(crate) fn dense_arrays(layers: &[DenseLayer]) -> Vec<Vec<f64>> {
    let arrays = |layer: &DenseLayer| [in_f64(&layer.weights), in_f64(&layer.bias)];
    layers.iter().flat_map(arrays).collect()
}

/// bias + weights · values.
pub(crate) fn affine(weights: &[f64], bias: &[f64], values: &[f64]) -> Vec<f64> {
    let sum = |row: &[f64]| row.iter().zip(values).map(|(w, x)| w * x).sum::<f64>();
    let rows = weights.chunks(values.len()).zip(bias);
    rows.map(|(row, bias)| sum(row) + bias).collect()
}

/// The perceptron of these [`dense_arrays`].
pub(crate) fn perceptron(arrays: &[Vec<f64>], inputs: &[f64]) -> Vec<f64> {
    let mut values = inputs.to_vec();
    let layers = arrays.chunks(2);
    let last = layers.len() - 1;
    for (l, layer) in layers.enumerate() {
        values = affine(&layer[0], &layer[1], &values);
        if l < last {
            values.iter_mut().for_each(|x| *x = x.tanh());
        }
    }
    values
}

/// Probabilities of the actions in sample `i`.
pub(crate) fn probabilities(rollout: &Rollout, logits: &[f64], i: usize) -> Vec<f64> {
    let allowed = &rollout.allowed[i * ACTIONS..][..ACTIONS];
    let powers: Vec<f64> = logits
        .iter()
        .zip(allowed)
        .map(|(z, a)| z.exp() * f64::from(*a))
        .collect();
    let sum: f64 = powers.iter().sum();
    powers.iter().map(|power| power / sum).collect()
}

fn ratio(rollout: &Rollout, probabilities: &[f64], i: usize) -> f64 {
    probabilities[rollout.taken[i] as usize] / f64::from(rollout.log_probabilities[i]).exp()
}

fn normalised_advantages(rollout: &Rollout) -> Vec<f64> {
    let raw = in_f64(&rollout.advantages);
    let count = raw.len() as f64;
    let mean = raw.iter().sum::<f64>() / count;
    let variance = raw.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / (count - 1.0);
    raw.iter().map(|a| (a - mean) / variance.sqrt()).collect()
}

/// The policy's part of the loss over all samples, given their logits.
pub(crate) fn policy_loss(rollout: &Rollout, logits: &[Vec<f64>]) -> f64 {
    let advantages = normalised_advantages(rollout);
    let of_sample = |i: usize| {
        let p = probabilities(rollout, &logits[i], i);
        let r = ratio(rollout, &p, i);
        let objective = (advantages[i] * r).min(advantages[i] * r.clamp(0.8, 1.2));
        let entropy: f64 = p.iter().filter(|p| **p > 0.0).map(|p| -p * p.ln()).sum();
        -objective - 0.05 * entropy
    };
    (0..logits.len()).map(of_sample).sum::<f64>() / logits.len() as f64
}

/// The value network's part, given what it puts out.
pub(crate) fn value_loss(rollout: &Rollout, outputs: &[Vec<f64>]) -> f64 {
    let pairs = outputs.iter().zip(&rollout.returns);
    let square = |(output, returns): (&Vec<f64>, &f32)| (output[0] - f64::from(*returns)).powi(2);
    0.5 * pairs.map(square).sum::<f64>() / outputs.len() as f64
}

/// A test is worth nothing unless samples of every kind occur.
pub(crate) fn check_kinds_of_samples(rollout: &Rollout, logits: &[Vec<f64>]) {
    let advantages = normalised_advantages(rollout);
    let mut kinds = [[0; 3]; 2];
    for (i, advantage) in advantages.iter().enumerate() {
        let r = ratio(rollout, &probabilities(rollout, &logits[i], i), i);
        let side = if r < 0.8 {
            0
        } else if r > 1.2 {
            2
        } else {
            1
        };
        kinds[usize::from(*advantage > 0.0)][side] += 1;
    }
    assert!(
        kinds.as_flattened().iter().all(|count| *count > 2),
        "kinds of samples: {kinds:?}"
    );
}

/// Compares gradients with central differences of `loss` over arrays of parameters; of large
/// arrays, a part.
pub(crate) fn compare(
    mut parameters: Vec<Vec<f64>>,
    gradients: &[Vec<f64>],
    loss: impl Fn(&[Vec<f64>]) -> f64,
    what: &str,
) {
    const STEP: f64 = 1e-5;
    for array in 0..parameters.len() {
        let count = parameters[array].len();
        for i in (0..count).step_by(count.div_ceil(60)) {
            let before = parameters[array][i];
            let mut at = |offset: f64| {
                parameters[array][i] = before + offset;
                let result = loss(&parameters);
                parameters[array][i] = before;
                result
            };
            let expected = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            let found = gradients[array][i];
            assert!(
                (found - expected).abs() < 2e-6 + 2e-5 * expected.abs(),
                "{what}, array {array}, number {i}: {found}, by differences {expected}"
            );
        }
    }
}
