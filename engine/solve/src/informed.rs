//! The fast informed bound (Hauskrecht 2000): one alpha vector for each action, an upper bound at
//! least as tight as QMDP's, for it lets the next action depend on the observation.

use std::time::Instant;

use crate::pomdp::Pomdp;
use crate::qmdp::iterate;

/// The bound's vectors, brought down from `start` (an upper bound, such as QMDP's) until no value
/// is more than `residual` from its limit, or until `deadline`.
pub fn fast_informed_bound(
    pomdp: &Pomdp,
    start: Vec<Vec<f64>>,
    residual: f64,
    deadline: Option<Instant>,
) -> Vec<Vec<f64>> {
    let mut vectors = start;
    let mut after = vectors.clone();
    let mut sums = vec![0.0; vectors.len() * pomdp.observations().len()];
    iterate(pomdp.discount(), residual, deadline, || {
        let mut change: f64 = 0.0;
        for (action, values) in after.iter_mut().enumerate() {
            for (state, value) in values.iter_mut().enumerate() {
                let future = best_by_observation(pomdp, &vectors, action, state, &mut sums);
                *value = pomdp.rewards[action][state] + pomdp.discount() * future;
                change = change.max((*value - vectors[action][state]).abs());
            }
        }
        std::mem::swap(&mut vectors, &mut after);
        change
    });
    vectors
}

/// Σ_o max_a' Σ_s' T(s, a, s') Z(s', a, o) α_a'(s').
fn best_by_observation(
    pomdp: &Pomdp,
    vectors: &[Vec<f64>],
    action: usize,
    state: usize,
    sums: &mut [f64],
) -> f64 {
    let transitions = &pomdp.transitions[action];
    let observations = &pomdp.observation_rows[action];
    if let (&[next], &[probability]) = transitions.row(state) {
        // One next state: the observation tells nothing that is not known.
        let values = vectors.iter().map(|vector| vector[next as usize]);
        return probability * values.fold(f64::MIN, f64::max);
    }
    sums.fill(0.0);
    let width = vectors.len();
    for (next, probability) in transitions.entries(state) {
        for (observation, likelihood) in observations.entries(next) {
            let weight = probability * likelihood;
            let sums = &mut sums[observation * width..][..width];
            for (sum, vector) in sums.iter_mut().zip(vectors) {
                *sum += weight * vector[next];
            }
        }
    }
    // An observation that cannot be had here adds a maximum over zeros.
    let best = sums.chunks_exact(width);
    best.map(|values| values.iter().copied().fold(f64::MIN, f64::max))
        .sum()
}
