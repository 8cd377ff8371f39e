//! Episodes for the trainer, several at once, with the curriculum of §IV-A.3.

use std::sync::Arc;

use pubs_core::belief::{BeliefError, Model};
use pubs_core::reward::Reward;
use pubs_core::shield::Shield;
use pubs_core::{Input, Task};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::curriculum::Starts;
use super::{Curriculum, Episode, Goals, Senses, Stopped, draw_goal};
use crate::environment::{End, Environments, StepOutcome};

/// How episodes are drawn while training.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingOptions {
    /// Which goals.
    pub goals: Goals,
    /// What the policy reads.
    pub inputs: Arc<[Input]>,
    /// Copies stepped together.
    pub count: usize,
    /// Where episodes start.
    pub curriculum: Curriculum,
    /// An episode is cut off after so many policy steps; `None`: never.
    pub episode_cap: Option<u32>,
    /// Mask of high-force actions while training.
    pub shield: Option<Shield>,
    /// Seed of every draw.
    pub seed: u64,
}

/// Several episodes of one task.
pub struct SurrogateEnvironments {
    task: Arc<Task>,
    options: TrainingOptions,
    episodes: Vec<Episode>,
    rng: Xoshiro256PlusPlus,
    starts: Starts,
    /// The largest reward of a task is 1 for the learner, whatever its object file calls it.
    reward_scale: f64,
    last_features: Vec<f32>,
}

impl SurrogateEnvironments {
    /// Episodes begun.
    pub fn new(task: Arc<Task>, model: &Arc<dyn Model>, options: TrainingOptions) -> Self {
        let senses = Senses::new(Arc::clone(&options.inputs), options.shield.is_some());
        let episodes = (0..options.count)
            .map(|_| Episode::new(Arc::clone(&task), Arc::clone(model), senses.clone()))
            .collect();
        let count = options.count;
        let mut environments = Self {
            starts: Starts::new(options.curriculum),
            reward_scale: reward_scale(&task.reward),
            task,
            episodes,
            rng: Xoshiro256PlusPlus::seed_from_u64(options.seed),
            last_features: vec![0.0; count * options.inputs.len()],
            options,
        };
        for index in 0..count {
            environments.begin(index);
        }
        environments
    }

    fn begin(&mut self, index: usize) {
        let joint = &self.task.joint;
        let goal = match self.options.goals {
            Goals::One(goal) => goal,
            Goals::Every => draw_goal(joint, &mut self.rng),
        };
        let state = self.starts.draw(joint, goal, &mut self.rng);
        self.episodes[index].begin(state, goal, &mut self.rng);
    }
}

/// Brings the largest reward of an episode's end to 1. The two networks share one limit on the
/// length of a gradient, and values of a hundred leave none of it to the policy.
fn reward_scale(reward: &Reward) -> f64 {
    let ends = [reward.goal, reward.failed_stop, reward.safety_violation];
    let largest = ends.into_iter().map(f64::abs).fold(0.0, f64::max);
    if largest > 0.0 { 1.0 / largest } else { 1.0 }
}

impl Environments for SurrogateEnvironments {
    type Error = BeliefError;

    fn count(&self) -> usize {
        self.episodes.len()
    }

    fn features(&self) -> usize {
        self.options.inputs.len()
    }

    fn actions(&self) -> usize {
        self.task.actions.len()
    }

    fn observe(&self, features: &mut [f32], allowed: &mut [bool]) {
        let width = self.features();
        let actions = self.actions();
        for (index, episode) in self.episodes.iter().enumerate() {
            episode.features(&mut features[index * width..(index + 1) * width]);
            episode.allowed(
                self.options.shield.as_ref(),
                &mut allowed[index * actions..(index + 1) * actions],
            );
        }
    }

    fn step(&mut self, actions: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), BeliefError> {
        let width = self.features();
        for (index, (&action, outcome)) in actions.iter().zip(outcomes).enumerate() {
            let step = self.episodes[index].step(action, &mut self.rng)?;
            let capped = self
                .options
                .episode_cap
                .is_some_and(|cap| self.episodes[index].steps() >= cap);
            let end = match step.stopped {
                Some(_) => Some(End::Terminated),
                None => capped.then_some(End::Truncated),
            };
            *outcome = StepOutcome {
                reward: (step.reward * self.reward_scale) as f32,
                end,
                success: step.stopped == Some(Stopped::Reached),
                violation: step.stopped == Some(Stopped::Violated),
            };
            if end.is_some() {
                self.starts.record(outcome.success);
                self.episodes[index]
                    .features(&mut self.last_features[index * width..(index + 1) * width]);
                self.begin(index);
            }
        }
        Ok(())
    }

    fn last_features(&self, index: usize, features: &mut [f32]) {
        let width = self.features();
        features.copy_from_slice(&self.last_features[index * width..(index + 1) * width]);
    }
}

#[cfg(test)]
mod tests {
    use pubs_core::reward::Shape;

    use super::*;

    #[test]
    fn the_largest_reward_of_an_end_becomes_1() {
        let scale = |goal, failed_stop, safety_violation| {
            reward_scale(&Reward {
                shape: Shape::Flat,
                goal_tolerance: 0.5,
                goal,
                failed_stop,
                safety_violation,
                time: -1.0,
                discount: 0.99,
            })
        };
        let cases = [
            ((1.0, -1.0, -1.0), 1.0),
            ((101.0, -99.0, -100.0), 1.0 / 101.0),
            ((10.0, -40.0, 0.0), 0.025),
            ((0.0, 0.0, 0.0), 1.0),
        ];
        for ((goal, failed, violation), expected) in cases {
            let found = scale(goal, failed, violation);
            assert!(
                (found - expected).abs() < 1e-15,
                "{goal}, {failed}, {violation}: {found}, expected {expected}"
            );
        }
    }
}
