//! Gradients through time against central differences of the same loss in `f64`, and both against
//! PyTorch.
#![allow(clippy::unwrap_used)]

mod pytorch;
mod rollouts;

use super::super::network::RecurrentNetwork;
use super::super::{Lstm, LstmLayer, RecurrentPolicy};
use super::*;
use crate::reference::{
    ACTIONS, FEATURES, UPDATE, affine, check_kinds_of_samples, compare, dense_arrays, in_f64,
    perceptron, perturb_biases, policy_loss, value_loss,
};
use crate::rng::stream;
use crate::scaling::InputScaling;
use rand::RngExt;

const COPIES: usize = 5;
/// With the copies more than a block of samples.
const LENGTH: usize = 14;

/// The last observation of truncated episodes.
const LAST: [f32; FEATURES] = [0.3, -0.7];

/// Sequences with episodes that start within them, some in neighbouring samples.
fn samples() -> Rollout {
    let mut rollout = crate::reference::samples(COPIES, LENGTH);
    for sample in 0..COPIES * LENGTH {
        rollout.ended[sample] = sample % 9 == 4 || sample % 31 == 5;
    }
    rollout
}

fn starts(rollout: &Rollout, sample: usize) -> bool {
    !sample.is_multiple_of(LENGTH) && rollout.ended[sample - 1]
}

/// A learner whose copies begin in random states, with the gradients of all samples.
fn with_gradients(unit: VectorUnit, lstm: Lstm) -> RecurrentLearner {
    let largest = Span {
        steps: LENGTH,
        rows: COPIES,
    };
    let trainee = |name: &str, outputs: usize| {
        let mut generator = stream(3, name);
        let widths = [lstm.width, 7, outputs];
        let mut network = RecurrentNetwork::new(unit, FEATURES, lstm, &widths, 1.0, &mut generator);
        perturb_biases(&mut network.head);
        let mut trainee = Trainee::new(network, COPIES, largest, 1e-5);
        trainee
            .first_states
            .fill_with(|| generator.random_range(-0.8..0.8));
        trainee
    };
    let (policy, value) = (trainee("policy", ACTIONS), trainee("value", 1));
    let mut learner = RecurrentLearner::new(unit, policy, value, largest);
    // In two parts, so that memory of one must not show in the other.
    learner.find_gradients(&samples(), &[3, 1], UPDATE);
    learner.find_gradients(&samples(), &[4, 0, 2, 1, 3], UPDATE);
    learner
}

/// Of each recurrent layer the two matrices and the bias, then those of the perceptron.
fn arrays(lstm: &[LstmLayer], dense: &[crate::network::DenseLayer]) -> Vec<Vec<f64>> {
    let parts = |layer: &LstmLayer| {
        [&layer.weights_input, &layer.weights_hidden, &layer.bias].map(|part| in_f64(part))
    };
    lstm.iter()
        .flat_map(parts)
        .chain(dense_arrays(dense))
        .collect()
}

fn parameters_of(trainee: &Trainee) -> Vec<Vec<f64>> {
    let RecurrentNetwork { stack, head } = &trainee.network;
    arrays(&stack.export(), &head.export())
}

fn gradients_of(trainee: &Trainee) -> Vec<Vec<f64>> {
    let RecurrentNetwork { stack, head } = &trainee.network;
    arrays(&stack.export_gradients(), &head.export_gradients())
}

fn sigmoid(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// One step of one layer; the state is h and then c.
fn cell(layer: &[Vec<f64>], inputs: &[f64], state: &mut [f64]) {
    let (hidden, cell) = state.split_at_mut(state.len() / 2);
    let width = hidden.len();
    let of_inputs = affine(&layer[0], &layer[2], inputs);
    let sums = affine(&layer[1], &of_inputs, hidden);
    for u in 0..width {
        let [input, forget, candidate, output] = [0, 1, 2, 3].map(|gate| sums[gate * width + u]);
        cell[u] = sigmoid(forget) * cell[u] + sigmoid(input) * candidate.tanh();
        hidden[u] = sigmoid(output) * cell[u].tanh();
    }
}

/// One step of a network from its state `[layer][2][width]`.
fn step(lstm: Lstm, arrays: &[Vec<f64>], features: &[f32], state: &mut [f64]) -> Vec<f64> {
    let (recurrent, dense) = arrays.split_at(3 * lstm.layers);
    let mut values = in_f64(features);
    for (layer, state) in recurrent.chunks(3).zip(state.chunks_mut(2 * lstm.width)) {
        cell(layer, &values, state);
        values = state[..lstm.width].to_vec();
    }
    perceptron(dense, &values)
}

/// What a network puts out for every sample, and the state after it; each copy goes through its
/// sequence alone.
fn trajectory(
    rollout: &Rollout,
    lstm: Lstm,
    first: &[f32],
    arrays: &[Vec<f64>],
) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let size = lstm.layers * 2 * lstm.width;
    let mut state = Vec::new();
    let of_sample = |sample: usize| {
        if sample.is_multiple_of(LENGTH) {
            state = in_f64(&first[sample / LENGTH * size..][..size]);
        } else if starts(rollout, sample) {
            state.fill(0.0);
        }
        let features = &rollout.features[sample * FEATURES..][..FEATURES];
        let outputs = step(lstm, arrays, features, &mut state);
        (outputs, state.clone())
    };
    (0..COPIES * LENGTH).map(of_sample).unzip()
}

fn outputs(rollout: &Rollout, lstm: Lstm, first: &[f32], arrays: &[Vec<f64>]) -> Vec<Vec<f64>> {
    trajectory(rollout, lstm, first, arrays).0
}

#[test]
fn gradients_match_finite_differences() {
    for unit in VectorUnit::available() {
        for (layers, width) in [(1, 16), (2, 5), (2, 18)] {
            let lstm = Lstm { layers, width };
            let learner = with_gradients(unit, lstm);
            let rollout = samples();
            let RecurrentLearner { policy, value, .. } = &learner;
            let logits =
                |arrays: &[Vec<f64>]| outputs(&rollout, lstm, &policy.first_states, arrays);
            let values = |arrays: &[Vec<f64>]| outputs(&rollout, lstm, &value.first_states, arrays);
            check_kinds_of_samples(&rollout, &logits(&parameters_of(policy)));
            compare(
                parameters_of(policy),
                &gradients_of(policy),
                |arrays| policy_loss(&rollout, &logits(arrays)),
                &format!("{unit} policy {lstm:?}"),
            );
            compare(
                parameters_of(value),
                &gradients_of(value),
                |arrays| value_loss(&rollout, &values(arrays)),
                &format!("{unit} value {lstm:?}"),
            );
        }
    }
}

/// Logits `[sample][action]` by the policy that is given away, step by step.
fn logits_of(learner: RecurrentLearner, rollout: &Rollout) -> Vec<Vec<f64>> {
    let Trainee {
        network,
        first_states: mut states,
        ..
    } = learner.policy;
    let mut policy = RecurrentPolicy::new(network, InputScaling::identity(FEATURES));
    let mut logits = vec![Vec::new(); COPIES * LENGTH];
    let size = policy.state_size();
    for step in 0..LENGTH {
        let mut features = Vec::new();
        for copy in 0..COPIES {
            let sample = copy * LENGTH + step;
            features.extend(&rollout.features[sample * FEATURES..][..FEATURES]);
            if starts(rollout, sample) {
                states[copy * size..][..size].fill(0.0);
            }
        }
        let mut rows = [0.0; COPIES * ACTIONS];
        policy.logits(&features, &mut states, &mut rows);
        for (copy, row) in rows.chunks(ACTIONS).enumerate() {
            logits[copy * LENGTH + step] = in_f64(row);
        }
    }
    logits
}

fn assert_close(found: &[Vec<f64>], expected: &[Vec<f64>], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(found.len(), expected.len(), "{what} {i}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < tolerance * (1.0 + expected.abs()),
                "{what} {i}: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn the_policy_steps_as_the_sequences_go() {
    for unit in VectorUnit::available() {
        let lstm = Lstm {
            layers: 2,
            width: 18,
        };
        let learner = with_gradients(unit, lstm);
        let rollout = samples();
        let parameters = parameters_of(&learner.policy);
        let expected = outputs(&rollout, lstm, &learner.policy.first_states, &parameters);
        let found = logits_of(learner, &rollout);
        assert_close(&found, &expected, 2e-6, &format!("{unit} logits of sample"));
    }
}

/// Values with truncated episodes and the observations after the last step, by the same plain
/// steps in `f64`.
#[test]
fn estimates_go_on_from_the_state_that_belongs_to_them() {
    let lstm = Lstm {
        layers: 2,
        width: 5,
    };
    for most in [COPIES, 2] {
        let mut learner = with_gradients(VectorUnit::best(), lstm);
        learner.most = most;
        let mut rollout = samples();
        let truncated = [5, 22, 40, COPIES * LENGTH - 1];
        for sample in truncated {
            rollout.ended[sample] = true;
            rollout.truncated.samples.push(sample);
            rollout.truncated.features.extend(LAST);
        }
        learner.estimate(&mut rollout, 0.9, 0.0);

        let expected = one_step_returns(&rollout, lstm, &learner.value, &truncated);
        assert_close(
            &[in_f64(&rollout.returns)],
            &[expected],
            2e-6,
            &format!("returns, {most} sequences at a time"),
        );
    }
}

/// r + γ V' for each sample, r being 0; λ = 0 makes these the returns.
fn one_step_returns(
    rollout: &Rollout,
    lstm: Lstm,
    value: &Trainee,
    truncated: &[usize],
) -> Vec<f64> {
    let parameters = parameters_of(value);
    let (values, states) = trajectory(rollout, lstm, &value.first_states, &parameters);
    let after = |sample: usize, features: &[f32]| {
        let mut state = states[sample].clone();
        step(lstm, &parameters, features, &mut state)[0]
    };
    let of_sample = |sample: usize| match sample {
        _ if truncated.contains(&sample) => 0.9 * after(sample, &LAST),
        _ if rollout.ended[sample] => 0.0,
        _ if (sample + 1).is_multiple_of(LENGTH) => {
            let copy = sample / LENGTH;
            let features = &rollout.next_features()[copy * FEATURES..][..FEATURES];
            0.9 * after(sample, features)
        }
        _ => 0.9 * values[sample + 1][0],
    };
    (0..COPIES * LENGTH).map(of_sample).collect()
}
