//! Blind policies: one action for ever. Their values are where the lower bound begins.

use std::time::Instant;

use crate::pomdp::Pomdp;
use crate::qmdp::iterate;

/// The value of each action repeated for ever, one vector for each action.
///
/// Comes up from below, so that a stop at `deadline` leaves a lower bound all the same.
pub fn blind_values(pomdp: &Pomdp, residual: f64, deadline: Option<Instant>) -> Vec<Vec<f64>> {
    let actions = 0..pomdp.actions().len();
    actions
        .map(|action| blind_value(pomdp, action, residual, deadline))
        .collect()
}

fn blind_value(pomdp: &Pomdp, action: usize, residual: f64, deadline: Option<Instant>) -> Vec<f64> {
    let rewards = &pomdp.rewards[action];
    let worst = rewards.iter().copied().fold(f64::MAX, f64::min);
    let mut values = vec![worst / (1.0 - pomdp.discount()); rewards.len()];
    let mut after = values.clone();
    iterate(pomdp.discount(), residual, deadline, || {
        let mut change: f64 = 0.0;
        for (state, value) in after.iter_mut().enumerate() {
            let next = pomdp.transitions[action].dot(state, &values);
            *value = rewards[state] + pomdp.discount() * next;
            change = change.max((*value - values[state]).abs());
        }
        std::mem::swap(&mut values, &mut after);
        change
    });
    values
}
