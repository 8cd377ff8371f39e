//! Episodes for the trainer, several at once, with the curriculum of §IV-A.3.

use std::sync::Arc;

use pubs_core::belief::{BeliefError, Model};
use pubs_core::shield::Shield;
use pubs_core::{Input, Task};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Episode, Goals, Senses, Stopped, draw_goal, draw_start};
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
    /// Episodes start at a limit until so many have ended in the goal region.
    pub curriculum: u32,
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
    successes: u32,
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
            task,
            episodes,
            rng: Xoshiro256PlusPlus::seed_from_u64(options.seed),
            successes: 0,
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
        let (from, to) = joint.start;
        let state = if self.successes < self.options.curriculum {
            if self.rng.random() { to } else { from }
        } else {
            draw_start(joint, &mut self.rng)
        };
        let goal = match self.options.goals {
            Goals::One(goal) => goal,
            Goals::Every => draw_goal(joint, &mut self.rng),
        };
        self.episodes[index].begin(state, goal, &mut self.rng);
    }
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
                reward: step.reward as f32,
                end,
                success: step.stopped == Some(Stopped::Reached),
                violation: step.stopped == Some(Stopped::Violated),
            };
            self.successes += u32::from(outcome.success);
            if end.is_some() {
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
