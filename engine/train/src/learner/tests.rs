//! Gradients of the whole loss against central differences of the same loss in `f64`.

use super::*;
use crate::reference::{
    ACTIONS, FEATURES, UPDATE, check_kinds_of_samples, compare, dense_arrays, in_f64, perceptron,
    perturb_biases, policy_loss, samples, value_loss,
};
use crate::rng::stream;

/// More than a block, and not a whole number of vectors.
const SAMPLES: usize = BLOCK + 9;

#[test]
fn gradients_match_finite_differences() {
    for unit in VectorUnit::available() {
        for layers in [vec![7], vec![16, 33], vec![64, 64, 64]] {
            let learner = with_gradients(unit, &layers);
            let rollout = samples(1, SAMPLES);
            let outputs = |arrays: &[Vec<f64>]| -> Vec<Vec<f64>> {
                let features = rollout.features.chunks(FEATURES);
                features.map(|x| perceptron(arrays, &in_f64(x))).collect()
            };
            let (policy, value) = (&learner.policy.network, &learner.value.network);
            check_kinds_of_samples(&rollout, &outputs(&dense_arrays(&policy.export())));
            compare(
                dense_arrays(&policy.export()),
                &dense_arrays(&policy.export_gradients()),
                |arrays| policy_loss(&rollout, &outputs(arrays)),
                &format!("{unit} policy {layers:?}"),
            );
            compare(
                dense_arrays(&value.export()),
                &dense_arrays(&value.export_gradients()),
                |arrays| value_loss(&rollout, &outputs(arrays)),
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
    learner.find_gradients(&samples(1, SAMPLES), &minibatch, UPDATE);
    learner
}
