//! Gradients of the whole loss against central differences of the same loss, written here a second
//! time, plainly and in `f64`.

use super::*;
use crate::environment::{Environments, StepOutcome};
use crate::network::DenseLayer;
use crate::rng::stream;
use rand::RngExt;

const FEATURES: usize = 2;
const ACTIONS: usize = 4;
/// More than a block, and not a whole number of vectors.
const SAMPLES: usize = BLOCK + 9;

/// Gives a rollout its shape; never stepped.
struct Shape;

impl Environments for Shape {
    type Error = std::convert::Infallible;

    fn count(&self) -> usize {
        1
    }

    fn features(&self) -> usize {
        FEATURES
    }

    fn actions(&self) -> usize {
        ACTIONS
    }

    fn observe(&self, _features: &mut [f32], _allowed: &mut [bool]) {}

    fn step(&mut self, _: &[usize], _: &mut [StepOutcome]) -> Result<(), Self::Error> {
        Ok(())
    }

    fn last_features(&self, _index: usize, _features: &mut [f32]) {}
}

const UPDATE: Update = Update {
    learning_rate: 0.0,
    clip_range: 0.2,
    entropy_coefficient: 0.05,
    value_coefficient: 0.5,
    gradient_norm: 0.5,
};

#[test]
fn gradients_match_finite_differences() {
    for unit in VectorUnit::available() {
        for layers in [vec![7], vec![16, 33], vec![64, 64, 64]] {
            let learner = with_gradients(unit, &layers);
            let rollout = samples();
            check_kinds_of_samples(&rollout, &learner.policy.network.export());
            let policy_loss = |layers: &[Layer]| policy_loss(&rollout, layers);
            let value_loss = |layers: &[Layer]| value_loss(&rollout, layers);
            compare(
                &learner.policy.network,
                policy_loss,
                &format!("{unit} policy {layers:?}"),
            );
            compare(
                &learner.value.network,
                value_loss,
                &format!("{unit} value {layers:?}"),
            );
        }
    }
}

fn with_gradients(unit: VectorUnit, layers: &[usize]) -> Learner {
    let trainee = |name: &str, outputs: usize| {
        let widths: Vec<usize> = [FEATURES]
            .iter()
            .chain(layers)
            .chain([&outputs])
            .copied()
            .collect();
        let mut network = Network::new(unit, &widths, 1.0, &mut stream(3, name));
        perturb_biases(&mut network);
        Trainee::new(network, 1e-5)
    };
    let mut learner = Learner::new(unit, trainee("policy", ACTIONS), trainee("value", 1));
    let minibatch: Vec<u32> = (0..SAMPLES as u32).collect();
    learner.find_gradients(&samples(), &minibatch, UPDATE);
    learner
}

/// Biases start at 0, where a mistake in them could hide; a gradient step moves them.
fn perturb_biases(network: &mut Network) {
    let inputs = vec![0.3; FEATURES];
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

/// Samples under an old policy that differs enough to clip some of them.
fn samples() -> Rollout {
    let mut rollout = Rollout::new(&Shape, SAMPLES);
    let mut generator = stream(5, "samples");
    let mut between = |from: f32, to: f32| generator.random_range(from..to);
    rollout.features.fill_with(|| between(-1.5, 1.5));
    rollout.advantages.fill_with(|| between(-2.0, 3.0));
    rollout.returns.fill_with(|| between(-1.0, 1.0));
    for sample in 0..SAMPLES {
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

/// A layer in `f64`: weights `[output][input]`, bias.
type Layer = (Vec<Vec<f64>>, Vec<f64>);

fn in_f64(layers: &[DenseLayer]) -> Vec<Layer> {
    let row = |row: &[f32]| row.iter().map(|x| f64::from(*x)).collect::<Vec<f64>>();
    let layer = |layer: &DenseLayer| {
        (
            layer.weights.chunks(layer.inputs).map(row).collect(),
            row(&layer.bias),
        )
    };
    layers.iter().map(layer).collect()
}

fn forward(layers: &[Layer], features: &[f32]) -> Vec<f64> {
    let mut values: Vec<f64> = features.iter().map(|x| f64::from(*x)).collect();
    for (l, (weights, bias)) in layers.iter().enumerate() {
        let sum = |row: &Vec<f64>| row.iter().zip(&values).map(|(w, x)| w * x).sum::<f64>();
        values = weights
            .iter()
            .zip(bias)
            .map(|(row, b)| sum(row) + b)
            .collect();
        if l + 1 < layers.len() {
            values.iter_mut().for_each(|x| *x = x.tanh());
        }
    }
    values
}

/// Probabilities of the actions in sample `i`.
fn probabilities(rollout: &Rollout, layers: &[Layer], i: usize) -> Vec<f64> {
    let logits = forward(layers, &rollout.features[i * FEATURES..][..FEATURES]);
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
    let count = SAMPLES as f64;
    let raw: Vec<f64> = rollout.advantages.iter().map(|a| f64::from(*a)).collect();
    let mean = raw.iter().sum::<f64>() / count;
    let variance = raw.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / (count - 1.0);
    raw.iter().map(|a| (a - mean) / variance.sqrt()).collect()
}

fn policy_loss(rollout: &Rollout, layers: &[Layer]) -> f64 {
    let advantages = normalised_advantages(rollout);
    let of_sample = |i: usize| {
        let p = probabilities(rollout, layers, i);
        let r = ratio(rollout, &p, i);
        let objective = (advantages[i] * r).min(advantages[i] * r.clamp(0.8, 1.2));
        let entropy: f64 = p.iter().filter(|p| **p > 0.0).map(|p| -p * p.ln()).sum();
        -objective - 0.05 * entropy
    };
    (0..SAMPLES).map(of_sample).sum::<f64>() / SAMPLES as f64
}

fn value_loss(rollout: &Rollout, layers: &[Layer]) -> f64 {
    let error = |i: usize| {
        forward(layers, &rollout.features[i * FEATURES..][..FEATURES])[0]
            - f64::from(rollout.returns[i])
    };
    0.5 * (0..SAMPLES).map(|i| error(i).powi(2)).sum::<f64>() / SAMPLES as f64
}

/// The test is worth nothing unless samples of every kind occur.
fn check_kinds_of_samples(rollout: &Rollout, layers: &[DenseLayer]) {
    let layers = in_f64(layers);
    let advantages = normalised_advantages(rollout);
    let mut kinds = [[0; 3]; 2];
    for (i, advantage) in advantages.iter().enumerate() {
        let r = ratio(rollout, &probabilities(rollout, &layers, i), i);
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

/// Compares the gradients of the parameters with central differences of `loss`; of large layers,
/// a part.
fn compare(network: &Network, loss: impl Fn(&[Layer]) -> f64, what: &str) {
    const STEP: f64 = 1e-5;
    let mut layers = in_f64(&network.export());
    let gradients = in_f64(&network.export_gradients());
    for l in 0..layers.len() {
        let (rows, columns) = (layers[l].0.len(), layers[l].0[0].len());
        let weights = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, Some(c))));
        let every = (rows * columns).div_ceil(60);
        for (r, c) in weights.step_by(every).chain((0..rows).map(|r| (r, None))) {
            let mut at = |offset: f64| {
                let parameter = match c {
                    Some(c) => &mut layers[l].0[r][c],
                    None => &mut layers[l].1[r],
                };
                let before = *parameter;
                *parameter += offset;
                let result = loss(&layers);
                match c {
                    Some(c) => layers[l].0[r][c] = before,
                    None => layers[l].1[r] = before,
                }
                result
            };
            let expected = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            let found = c.map_or(gradients[l].1[r], |c| gradients[l].0[r][c]);
            assert!(
                (found - expected).abs() < 2e-6 + 2e-5 * expected.abs(),
                "{what}, layer {l}, output {r}, input {c:?}: {found}, by differences {expected}"
            );
        }
    }
}
