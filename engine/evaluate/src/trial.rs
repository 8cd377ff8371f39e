//! Trials: episodes from random starts with deterministic actions and a cap, §IV-A.3.

use std::sync::Arc;

use pubs_core::belief::{BeliefError, Filter, Model};
use pubs_core::seed::stream;
use pubs_core::shield::Shield;
use pubs_core::{Goal, Joint, Task};
use pubs_train::surrogate::{Episode, Senses, Stopped, draw_goal, draw_start};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::decider::Decider;

/// Trials that go through the policy together: few enough that their filters stay in a core's
/// cache. Fixed, so that results do not depend on threads.
pub const BATCH: u64 = 32;

/// The share of the belief whose interval is judged.
pub const COVERAGE: f64 = 0.9;

/// Why trials could not go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrialError {
    /// The filter or its model failed.
    #[error(transparent)]
    Belief(#[from] BeliefError),
    /// The policy failed.
    #[error("the policy failed: {0}")]
    Policy(#[from] pubs_policy::RunError),
}

/// How trials are drawn and cut off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialOptions {
    /// One goal state for all, or drawn per trial as in training.
    pub goal: Option<f64>,
    /// Cap on policy steps.
    pub max_steps: u32,
    /// Mask of high-force actions.
    pub shield: Option<Shield>,
    /// Seed of all trials.
    pub seed: u64,
}

/// How one trial went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Sum of rewards.
    pub reward: f64,
    /// Σ γ^t R_t.
    pub discounted_reward: f64,
    /// How it ended; `None`: at the cap.
    pub stopped: Option<Stopped>,
    /// Policy steps.
    pub steps: u32,
    /// |s − s_g| at the end.
    pub goal_error: f64,
    /// Whether the belief's 90 % interval held the true state at the end; `None` where no filter
    /// followed.
    pub covered: Option<bool>,
    /// Recoveries of the belief.
    pub recoveries: u32,
}

struct Running {
    index: usize,
    episode: Episode,
    rng: Xoshiro256PlusPlus,
    reward: f64,
    discounted_reward: f64,
    weight: f64,
}

/// Runs trials number `first` to `first + count − 1`; trial i is the same whoever runs it.
///
/// # Errors
/// Where filter, model or policy fail.
pub fn run_batch(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    decider: &mut dyn Decider,
    options: &TrialOptions,
    first: u64,
    count: u64,
) -> Result<Vec<Trial>, TrialError> {
    let senses = decider.senses(options.shield.as_ref());
    let mut running: Vec<Running> = (0..count)
        .map(|index| begin(task, model, &senses, options, first, index))
        .collect();
    let mut trials = vec![None; running.len()];
    let mut actions = Vec::new();
    decider.begin(running.len());
    while !running.is_empty() {
        let episodes: Vec<(usize, &Episode)> = running
            .iter()
            .map(|one| (one.index, &one.episode))
            .collect();
        decider.decide(&episodes, options.shield.as_ref(), &mut actions)?;
        let mut still = Vec::with_capacity(running.len());
        for (mut one, &action) in running.into_iter().zip(&actions) {
            let stopped = one.step(task, action)?;
            if stopped.is_some() || one.episode.steps() >= options.max_steps {
                let index = one.index;
                trials[index] = Some(one.finish(stopped));
            } else {
                still.push(one);
            }
        }
        running = still;
    }
    Ok(trials.into_iter().flatten().collect())
}

fn begin(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    senses: &Senses,
    options: &TrialOptions,
    first: u64,
    index: u64,
) -> Running {
    let seed = stream(options.seed, "trials").wrapping_add(first + index);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let start = draw_start(&task.joint, &mut rng);
    let goal = options
        .goal
        .unwrap_or_else(|| draw_goal(&task.joint, &mut rng));
    let mut episode = Episode::new(Arc::clone(task), Arc::clone(model), senses.clone());
    episode.begin(start, goal, &mut rng);
    Running {
        index: index as usize,
        episode,
        rng,
        reward: 0.0,
        discounted_reward: 0.0,
        weight: 1.0,
    }
}

impl Running {
    fn step(&mut self, task: &Task, action: usize) -> Result<Option<Stopped>, TrialError> {
        let step = self.episode.step(action, &mut self.rng)?;
        self.reward += step.reward;
        self.discounted_reward += self.weight * step.reward;
        self.weight *= task.reward.discount;
        Ok(step.stopped)
    }

    fn finish(self, stopped: Option<Stopped>) -> Trial {
        let state = self.episode.state();
        let belief = self.episode.belief();
        let covered = belief.map(|belief| {
            let (from, to) = belief.interval(COVERAGE);
            (from..=to).contains(&state)
        });
        Trial {
            reward: self.reward,
            discounted_reward: self.discounted_reward,
            stopped,
            steps: self.episode.steps(),
            goal_error: (state - self.episode.goal()).abs(),
            covered,
            recoveries: belief.map_or(0, Filter::recoveries),
        }
    }
}

/// The goal of a trial in words, for tables.
pub fn goal_label(joint: &Joint, goal: Option<f64>) -> String {
    goal.map_or_else(
        || "every".to_owned(),
        |state| Goal::Fraction((state - joint.lower) / joint.range()).to_string(),
    )
}
