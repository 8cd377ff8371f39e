//! What PPO asks of the task it learns.

/// How an episode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// By the task's own rules: nothing more could be gained or lost.
    Terminated,
    /// Cut off from outside, by a cap on its length: the value of its last state still counts.
    Truncated,
}

/// What one step of one environment brought.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepOutcome {
    /// Reward of the step.
    pub reward: f32,
    /// Whether the step ended the episode.
    pub end: Option<End>,
    /// Whether the episode ended as it should; for progress only.
    pub success: bool,
    /// Whether the step was a safety violation; for progress only.
    pub violation: bool,
}

/// Several independent copies of one task, stepped together. An episode that ends begins anew
/// within the same step.
pub trait Environments {
    /// Why a step failed.
    type Error: std::error::Error + 'static;

    /// Number of copies, at least 1.
    fn count(&self) -> usize;

    /// Numbers in one observation, in the order of the policy's inputs.
    fn features(&self) -> usize;

    /// Number of actions.
    fn actions(&self) -> usize;

    /// Writes the present observations `[count][features]`, unscaled, and which actions may be
    /// taken `[count][actions]`; at least one each.
    fn observe(&self, features: &mut [f32], allowed: &mut [bool]);

    /// Carries out one action in each copy, `[count]`, and writes the outcomes `[count]`.
    ///
    /// # Errors
    /// Where a copy cannot go on; training ends with that error.
    fn step(&mut self, actions: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), Self::Error>;

    /// Writes the last observation `[features]` of the episode of copy `index` that the latest
    /// step truncated. Asked for no other copy.
    fn last_features(&self, index: usize, features: &mut [f32]);
}
