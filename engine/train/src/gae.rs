//! Generalised advantage estimation (Schulman et al., 2016, eq. 11 to 16).

/// Advantages of the steps of one environment, oldest first.
///
/// `values` holds V of the state before each step and, last, of the state after the last step, so
/// it is one longer. `ended[t]` says that step t ended an episode; what a truncated episode would
/// still have brought is expected in `rewards` already (discount · V of its last state).
pub(crate) fn advantages(
    discount: f32,
    lambda: f32,
    rewards: &[f32],
    values: &[f32],
    ended: &[bool],
    advantages: &mut [f32],
) {
    let mut following = 0.0;
    for t in (0..rewards.len()).rev() {
        let goes_on = if ended[t] { 0.0 } else { 1.0 };
        let error = rewards[t] + discount * goes_on * values[t + 1] - values[t];
        following = error + discount * lambda * goes_on * following;
        advantages[t] = following;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// γ = λ = 0.5. Step 1 terminates; step 3 is truncated in a state worth 6, so its reward of 1
    /// comes with 0.5 · 6 added; step 4 is cut by the end of the rollout, before a state worth 2.
    ///
    /// By hand, δ_t = r_t + 0.5 V_{t+1} − V_t (no V_{t+1} after an end):
    /// δ4 = 1 + 1 − 2 = 0,   A4 = 0
    /// δ3 = 4 − 3 = 1,       A3 = 1
    /// δ2 = 0 + 1.5 − 1 = 0.5, A2 = 0.5 + 0.25 · 1 = 0.75
    /// δ1 = −1 − 2 = −3,     A1 = −3
    /// δ0 = 2 + 1 − 4 = −1,  A0 = −1 + 0.25 · (−3) = −1.75
    #[test]
    fn matches_a_case_by_hand() {
        let rewards = [2.0, -1.0, 0.0, 1.0 + 0.5 * 6.0, 1.0];
        let values = [4.0, 2.0, 1.0, 3.0, 2.0, 2.0];
        let ended = [false, true, false, true, false];
        let mut result = [0.0; 5];
        advantages(0.5, 0.5, &rewards, &values, &ended, &mut result);
        assert_eq!(result, [-1.75, -3.0, 0.75, 1.0, 0.0]);
    }
}
