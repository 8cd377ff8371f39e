//! A sign is shown at the first step only and must be recalled at the last: which of two actions
//! is asked for then pays 1, the other −1. What a policy sees in between says how much time has
//! passed, and nothing of the sign, so one without memory is worth 0 on average.

use std::convert::Infallible;

use pubs_train::{End, Environments, StepOutcome, rng};
use rand::RngExt;

pub const FEATURES: usize = 2;
pub const ACTIONS: usize = 2;
/// Steps of an episode; the last one counts.
pub const LENGTH: usize = 6;

/// What is seen at a step of an episode with this sign.
pub fn observation(sign: bool, step: usize) -> [f32; FEATURES] {
    let shown = match (step, sign) {
        (0, true) => 1.0,
        (0, false) => -1.0,
        _ => 0.0,
    };
    [shown, step as f32 / LENGTH as f32]
}

pub struct Recall {
    signs: Vec<bool>,
    steps: Vec<usize>,
    generator: rng::Generator,
}

impl Recall {
    pub fn new(count: usize, seed: u64) -> Self {
        let mut generator = rng::stream(seed, "recall");
        Self {
            signs: (0..count).map(|_| generator.random()).collect(),
            // Copies that do not end together, so that episodes start everywhere in a rollout.
            steps: (0..count).map(|index| index % LENGTH).collect(),
            generator,
        }
    }
}

impl Environments for Recall {
    type Error = Infallible;

    fn count(&self) -> usize {
        self.signs.len()
    }

    fn features(&self) -> usize {
        FEATURES
    }

    fn actions(&self) -> usize {
        ACTIONS
    }

    fn observe(&self, features: &mut [f32], allowed: &mut [bool]) {
        allowed.fill(true);
        let copies = self.signs.iter().zip(&self.steps);
        for (row, (sign, step)) in features.chunks_exact_mut(FEATURES).zip(copies) {
            row.copy_from_slice(&observation(*sign, *step));
        }
    }

    fn step(&mut self, actions: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), Infallible> {
        for (index, (action, outcome)) in actions.iter().zip(outcomes).enumerate() {
            *outcome = StepOutcome::default();
            self.steps[index] += 1;
            if self.steps[index] == LENGTH {
                outcome.success = (*action == 1) == self.signs[index];
                outcome.reward = if outcome.success { 1.0 } else { -1.0 };
                outcome.end = Some(End::Terminated);
                self.steps[index] = 0;
                self.signs[index] = self.generator.random();
            }
        }
        Ok(())
    }

    fn last_features(&self, _index: usize, _features: &mut [f32]) {}
}
