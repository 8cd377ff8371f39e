//! What a policy does over mean and entropy, asked of it.

use pubs_policy::{FeatureName, Policy, RunError, choose};

/// Cells of the grid.
const COLUMNS: usize = 121;
const ROWS: usize = 61;

/// Where a policy is asked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked {
    /// Ends of the means (rad, m or plain).
    pub limits: [f64; 2],
    /// The goal, for a policy that reads it.
    pub goal: f64,
    /// Index of the stop action.
    pub stop: usize,
}

/// Its answers.
#[derive(Debug, Clone)]
pub(crate) struct Answers {
    /// Means, rising (rad, m or plain).
    pub mean: Vec<f64>,
    /// Entropies, from 0 to 1.
    pub entropy: Vec<f64>,
    /// Index of the chosen action: a row per entropy, a column per mean.
    pub action: Vec<Vec<usize>>,
}

impl Asked {
    /// Whether a policy with these inputs can be asked: it reads the belief, and the goal at most.
    pub fn is_fit(inputs: &[FeatureName]) -> bool {
        let of_goal = |input: &FeatureName| *input == FeatureName::Goal;
        let fit = |input: &FeatureName| input.is_of_belief() || of_goal(input);
        inputs.iter().all(fit) && inputs.iter().any(FeatureName::is_of_belief)
    }

    /// Asks at every point of a grid over the limits and [0, 1], without a shield, as the paper's
    /// Fig. 5.
    pub fn of(&self, policy: &mut Policy, inputs: &[FeatureName]) -> Result<Answers, RunError> {
        let share = |index: usize, count: usize| index as f64 / (count - 1) as f64;
        let [lower, upper] = self.limits;
        let mean: Vec<f64> = (0..COLUMNS)
            .map(|column| lower + share(column, COLUMNS) * (upper - lower))
            .collect();
        let entropy: Vec<f64> = (0..ROWS).map(|row| share(row, ROWS)).collect();
        let row = |(mean, entropy): (f64, f64)| {
            inputs.iter().map(move |input| match input {
                FeatureName::MeanState => mean as f32,
                FeatureName::MeanMinusGoal => (mean - self.goal) as f32,
                FeatureName::Goal => self.goal as f32,
                _ => entropy as f32,
            })
        };
        let points = entropy
            .iter()
            .flat_map(|&entropy| mean.iter().map(move |&mean| (mean, entropy)));
        let values: Vec<f32> = points.flat_map(row).collect();
        let mut logits = Vec::new();
        policy.logits(&values, COLUMNS * ROWS, &mut logits)?;
        let chosen: Vec<usize> = logits
            .chunks_exact(policy.actions())
            .map(|logits| choose(logits, self.stop, |_| true))
            .collect();
        Ok(Answers {
            mean,
            entropy,
            action: chosen
                .chunks_exact(COLUMNS)
                .map(<[usize]>::to_vec)
                .collect(),
        })
    }
}
