//! Holds what a policy computes against what was trained.

use super::Reference;
use crate::{Network, Policy, RunError};

/// Largest difference of a logit between the trainer and the file; of a number of the state too,
/// where that is beyond 1 relative to it.
///
/// Logits this close choose the same action wherever the best leads by more than twice as much.
pub const TOLERANCE: f32 = 1e-4;

/// Runs the reference's episodes side by side and describes the first difference.
pub fn verify(
    mut policy: Policy,
    network: &Network,
    reference: Reference,
) -> Result<Option<String>, RunError> {
    let (features, actions) = (policy.features(), policy.actions());
    let episodes = reference.inputs.len() / features / reference.steps;
    let mut found = Vec::new();
    let mut found_state = vec![0.0; episodes * policy.state_width()];
    let mut wanted_state = found_state.clone();
    for step in 0..reference.steps {
        let inputs = of_step(reference.inputs, features, step, reference.steps);
        let wanted = of_step(reference.logits, actions, step, reference.steps);
        policy.logits_with_state(&inputs, episodes, &mut found_state, &mut found)?;
        if let Some(at) = differing(&wanted, &found, |_| TOLERANCE) {
            let row = at / actions;
            let [input, wanted, found] =
                [(&inputs, features), (&wanted, actions), (&found, actions)]
                    .map(|(values, width)| &values[row * width..][..width]);
            return Ok(Some(format!(
                "at step {step}, for input {input:?}, the trainer gives {wanted:?}, but it is {found:?}"
            )));
        }
        if found_state.is_empty() {
            continue;
        }
        network.forward_with_state(&inputs, &mut wanted_state, &mut found);
        let relative = |wanted: f32| TOLERANCE * wanted.abs().max(1.0);
        if let Some(at) = differing(&wanted_state, &found_state, relative) {
            let (wanted, found) = (wanted_state[at], found_state[at]);
            let number = at % policy.state_width();
            return Ok(Some(format!(
                "after step {step}, number {number} of the state should be {wanted}, but it is {found}"
            )));
        }
    }
    Ok(None)
}

/// One row of each episode.
fn of_step(values: &[f32], width: usize, step: usize, steps: usize) -> Vec<f32> {
    let episodes = values.chunks_exact(width * steps);
    episodes
        .flat_map(|episode| &episode[step * width..][..width])
        .copied()
        .collect()
}

/// The first number that differs by too much. Written so that NaN on either side does.
fn differing(wanted: &[f32], found: &[f32], tolerance: impl Fn(f32) -> f32) -> Option<usize> {
    let close = |(wanted, found): (&f32, &f32)| (wanted - found).abs() <= tolerance(*wanted);
    wanted.iter().zip(found).position(|pair| !close(pair))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Runtime;
    use crate::common::{episode_logits, inputs, recurrent, written};

    #[test]
    fn a_state_that_differs_is_found_where_logits_do_not() {
        let runtime = Runtime::tract().unwrap();
        let directory = tempfile::tempdir().unwrap();
        let mut network = recurrent(1, &[4, 6]);
        // Nothing of the state reaches a logit.
        network.layers[0].weights.fill(0.0);
        let (file, _) = written(directory.path(), &network, &runtime);
        let inputs = inputs(1, &network, 6);
        let reference = Reference {
            inputs: &inputs,
            logits: &episode_logits(&network, &inputs, 3),
            steps: 3,
        };
        let compare =
            |network: &Network| verify(file.open(&runtime).unwrap(), network, reference).unwrap();
        assert_eq!(compare(&network), None);
        // Counts from the second step on, when the first has left something in h.
        network.lstm[1].weights_hidden[2] += 0.1;
        let found = compare(&network).unwrap();
        assert!(found.starts_with("after step 1, number "), "{found}");
    }

    #[test]
    fn agreement_by_hand() {
        let cases = [
            (&[1.0, 0.0][..], &[1.000_05, 0.0][..], None),
            (&[0.0, 1.0], &[0.0, 1.000_2], Some(1)),
            (&[1.0, 0.999_99], &[0.999_96, 1.0], None),
            (&[f32::NAN, 0.0], &[f32::NAN, 0.0], Some(0)),
            (&[1.0, 0.0], &[1.0, f32::NAN], Some(1)),
        ];
        for (wanted, found, expected) in cases {
            let at = differing(wanted, found, |_| TOLERANCE);
            assert_eq!(at, expected, "{wanted:?} {found:?}");
        }
    }

    #[test]
    fn rows_of_a_step_by_hand() {
        // Two episodes of three steps, two numbers each.
        let values: Vec<f32> = (0_u8..12).map(f32::from).collect();
        assert_eq!(of_step(&values, 2, 0, 3), [0.0, 1.0, 6.0, 7.0]);
        assert_eq!(of_step(&values, 2, 2, 3), [4.0, 5.0, 10.0, 11.0]);
    }
}
