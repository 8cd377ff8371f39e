//! What is drawn while a rollout is collected, one step at a time, is what learning finds again
//! when it goes through the sequences; states go on from one rollout to the next.

use super::*;
use crate::progress::Episodes;
use crate::reference::{Clocks, probabilities};
use crate::rollout::Collector;

#[test]
fn rollouts_follow_from_the_states_at_their_beginning() {
    let lstm = Lstm {
        layers: 2,
        width: 5,
    };
    let mut learner = with_gradients(VectorUnit::best(), lstm);
    learner.most = 3;
    let mut clocks = Clocks {
        copies: COPIES,
        time: 0,
    };
    let mut rollout = Rollout::new(&clocks, LENGTH);
    let mut episodes = Episodes::new(COPIES);
    let mut generator = stream(1, "actions");
    let mut last = [&learner.policy, &learner.value].map(|trainee| in_f64(&trainee.states));
    for number in 1..=3 {
        let collector = Collector {
            unit: VectorUnit::best(),
            actor: learner.actor(),
            scaling: &InputScaling::identity(FEATURES),
            generator: &mut generator,
            episodes: &mut episodes,
            steps: 0,
        };
        rollout.collect(&mut clocks, collector).unwrap();
        learner.estimate(&mut rollout, 0.9, 0.95);
        for (trainee, last) in [&learner.policy, &learner.value].into_iter().zip(&mut last) {
            let first = in_f64(&trainee.first_states);
            assert_close(
                &[first],
                std::slice::from_ref(last),
                2e-6,
                &format!("states, {number}"),
            );
            let parameters = parameters_of(trainee);
            let (_, states) = trajectory(&rollout, lstm, &trainee.first_states, &parameters);
            *last = states_after(&rollout, &states);
        }
        check_probabilities(&rollout, lstm, &learner.policy, number);
    }
}

/// The last states of the copies, 0 where an episode ended.
fn states_after(rollout: &Rollout, states: &[Vec<f64>]) -> Vec<f64> {
    let samples = (0..COPIES).map(|copy| copy * LENGTH + LENGTH - 1);
    let kept = samples.map(|sample| match rollout.ended[sample] {
        true => vec![0.0; states[sample].len()],
        false => states[sample].clone(),
    });
    kept.flatten().collect()
}

fn check_probabilities(rollout: &Rollout, lstm: Lstm, policy: &Trainee, number: usize) {
    let logits = outputs(rollout, lstm, &policy.first_states, &parameters_of(policy));
    for (sample, logits) in logits.iter().enumerate() {
        let taken = rollout.taken[sample] as usize;
        let expected = probabilities(rollout, logits, sample)[taken].ln();
        let found = f64::from(rollout.log_probabilities[sample]);
        assert!(
            (found - expected).abs() < 2e-6,
            "rollout {number}, sample {sample}: ln π = {found}, not {expected}"
        );
    }
}
