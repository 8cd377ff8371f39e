//! What a policy reads at each of its steps.
//!
//! The paper's policy reads the belief summary x = (μ, H), §III-B. Its baselines read raw
//! observations instead (§IV-B), and two ablations see another entropy or none (§IV-D). Trainer,
//! trials and robot fill the same list of inputs.

use crate::belief::Summary;

/// One number that a policy reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// μ of eq. (9) (rad, m or plain).
    MeanState,
    /// H of eq. (10) over ln N.
    Entropy,
    /// μ − s_g, for a policy that serves every goal.
    MeanMinusGoal,
    /// s_g, for a policy without a belief that serves every goal.
    Goal,
    /// A number drawn uniformly from [0, 1] at each policy step: the ablation Random H.
    RandomEntropy,
    /// The newest reading of the observation model's channel of this index, 0 before the first.
    Reading(usize),
}

impl Input {
    /// Whether it comes from the particle filter.
    pub fn is_of_belief(self) -> bool {
        matches!(self, Self::MeanState | Self::Entropy | Self::MeanMinusGoal)
    }
}

/// Everything that a policy could read at one step.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// Mean and entropy.
    pub summary: Summary,
    /// s_g (rad, m or plain).
    pub goal: f64,
    /// The newest reading of each channel, `[C]`.
    pub readings: &'a [f32],
    /// A fresh draw from [0, 1].
    pub random_entropy: f32,
}

impl Seen<'_> {
    /// Writes the `inputs` in their order.
    ///
    /// # Panics
    /// Where an input reads a channel that is not among the readings.
    pub fn fill(&self, inputs: &[Input], features: &mut [f32]) {
        for (feature, input) in features.iter_mut().zip(inputs) {
            *feature = self.value(*input);
        }
    }

    fn value(&self, input: Input) -> f32 {
        match input {
            Input::MeanState => self.summary.mean as f32,
            Input::Entropy => self.summary.entropy as f32,
            Input::MeanMinusGoal => (self.summary.mean - self.goal) as f32,
            Input::Goal => self.goal as f32,
            Input::RandomEntropy => self.random_entropy,
            Input::Reading(channel) => self.readings[channel],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_reads_its_own_number() {
        let seen = Seen {
            summary: Summary {
                mean: 0.75,
                entropy: 0.5,
            },
            goal: 0.25,
            readings: &[3.0, 4.0],
            random_entropy: 0.125,
        };
        let cases = [
            (Input::MeanState, 0.75, true),
            (Input::Entropy, 0.5, true),
            (Input::MeanMinusGoal, 0.5, true),
            (Input::Goal, 0.25, false),
            (Input::RandomEntropy, 0.125, false),
            (Input::Reading(1), 4.0, false),
        ];
        for (input, expected, of_belief) in cases {
            let mut features = [0.0];
            seen.fill(&[input], &mut features);
            assert_eq!(features, [expected], "{input:?}");
            assert_eq!(input.is_of_belief(), of_belief, "{input:?}");
        }
    }
}
