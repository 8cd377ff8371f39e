//! The exact Bayes update over the states of a POMDP.

use crate::pomdp::Pomdp;

/// The belief after `action` and `observation`, and how probable that observation was; `None`
/// where the belief holds it for impossible.
pub fn update(
    pomdp: &Pomdp,
    belief: &[f64],
    action: usize,
    observation: usize,
) -> Option<(Vec<f64>, f64)> {
    let mut next = predict(pomdp, belief, action);
    let mut total = 0.0;
    for (state, weight) in next.iter_mut().enumerate() {
        if *weight > 0.0 {
            *weight *= likelihood(pomdp, action, state, observation);
            total += *weight;
        }
    }
    if total <= 0.0 {
        return None;
    }
    next.iter_mut().for_each(|weight| *weight /= total);
    Some((next, total))
}

/// The belief after `action`, before anything is observed.
pub fn predict(pomdp: &Pomdp, belief: &[f64], action: usize) -> Vec<f64> {
    let mut next = vec![0.0; belief.len()];
    for (state, &weight) in belief.iter().enumerate() {
        if weight > 0.0 {
            for (to, probability) in pomdp.transition(action, state) {
                next[to] += weight * probability;
            }
        }
    }
    next
}

fn likelihood(pomdp: &Pomdp, action: usize, state: usize, observation: usize) -> f64 {
    let (columns, values) = pomdp.observation_rows[action].row(state);
    columns
        .binary_search(&(observation as u32))
        .map_or(0.0, |place| values[place])
}
