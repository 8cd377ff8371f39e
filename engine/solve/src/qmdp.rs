//! QMDP (Littman, Cassandra & Kaelbling 1995): value iteration as if the state were seen after the
//! next action. One alpha vector for each action; an upper bound on the POMDP's value.

use std::time::Instant;

use crate::pomdp::Pomdp;

/// Q(s, a) of the underlying MDP, one vector for each action.
///
/// Comes down from above, so that a stop at `deadline` leaves an upper bound all the same; else it
/// stops where the largest change says that no value is more than `residual` from its limit.
pub fn q_values(pomdp: &Pomdp, residual: f64, deadline: Option<Instant>) -> Vec<Vec<f64>> {
    let mut q = vec![vec![ceiling(pomdp); pomdp.states().len()]; pomdp.actions().len()];
    let mut best = vec![ceiling(pomdp); pomdp.states().len()];
    iterate(pomdp.discount(), residual, deadline, || {
        let mut change: f64 = 0.0;
        for (action, values) in q.iter_mut().enumerate() {
            for (state, value) in values.iter_mut().enumerate() {
                let next = pomdp.transitions[action].dot(state, &best);
                *value = pomdp.rewards[action][state] + pomdp.discount() * next;
            }
        }
        for (state, value) in best.iter_mut().enumerate() {
            let after = q
                .iter()
                .map(|values| values[state])
                .fold(f64::MIN, f64::max);
            change = change.max((after - *value).abs());
            *value = after;
        }
        change
    });
    q
}

/// No policy is worth more than this in any state.
pub(crate) fn ceiling(pomdp: &Pomdp) -> f64 {
    let best = pomdp.rewards.iter().flatten().copied();
    best.fold(f64::MIN, f64::max) / (1.0 - pomdp.discount())
}

/// Repeats a contraction until what remains of its geometric series is below `residual`.
pub(crate) fn iterate(
    discount: f64,
    residual: f64,
    deadline: Option<Instant>,
    mut step: impl FnMut() -> f64,
) {
    loop {
        let change = step();
        if change * discount / (1.0 - discount) <= residual {
            return;
        }
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return;
        }
    }
}
