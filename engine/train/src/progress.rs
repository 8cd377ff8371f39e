//! How training goes, for whoever watches.

use std::collections::VecDeque;

use crate::environment::StepOutcome;

/// Latest episodes that the means are taken over.
const WINDOW: usize = 1000;

/// The state of a training. Rates and means are over the latest 1,000 finished episodes, and
/// `None` until the first one has finished.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Progress {
    /// Steps of the environment done.
    pub steps: usize,
    /// Steps to do in all.
    pub total_steps: usize,
    /// Time since the start, s.
    pub time_s: f64,
    /// Episodes finished.
    pub episodes: usize,
    /// Mean undiscounted return.
    pub mean_return: Option<f32>,
    /// Share of episodes that ended in success.
    pub success_rate: Option<f32>,
    /// Share of episodes with a safety violation.
    pub violation_rate: Option<f32>,
    /// Safety violations since the start.
    pub violations: usize,
}

impl Progress {
    /// Mean steps per second since the start.
    #[must_use]
    pub fn steps_per_s(&self) -> f64 {
        if self.time_s > 0.0 {
            self.steps as f64 / self.time_s
        } else {
            0.0
        }
    }
}

/// One episode.
#[derive(Debug, Clone, Copy, Default)]
struct Episode {
    total_reward: f32,
    success: bool,
    violation: bool,
}

/// Follows the episodes of all copies.
#[derive(Debug)]
pub(crate) struct Episodes {
    running: Vec<Episode>,
    finished: VecDeque<Episode>,
    episodes: usize,
    violations: usize,
}

impl Episodes {
    pub(crate) fn new(environments: usize) -> Self {
        Self {
            running: vec![Episode::default(); environments],
            finished: VecDeque::with_capacity(WINDOW),
            episodes: 0,
            violations: 0,
        }
    }

    pub(crate) fn record(&mut self, environment: usize, outcome: &StepOutcome) {
        let episode = &mut self.running[environment];
        episode.total_reward += outcome.reward;
        episode.violation |= outcome.violation;
        self.violations += usize::from(outcome.violation);
        if outcome.end.is_some() {
            episode.success = outcome.success;
            if self.finished.len() == WINDOW {
                self.finished.pop_front();
            }
            self.finished.push_back(std::mem::take(episode));
            self.episodes += 1;
        }
    }

    pub(crate) fn progress(&self, steps: usize, total_steps: usize, time_s: f64) -> Progress {
        let count = self.finished.len() as f32;
        let mean = |value: fn(&Episode) -> f32| {
            (count > 0.0).then(|| self.finished.iter().map(value).sum::<f32>() / count)
        };
        Progress {
            steps,
            total_steps,
            time_s,
            episodes: self.episodes,
            mean_return: mean(|episode| episode.total_reward),
            success_rate: mean(|episode| f32::from(u8::from(episode.success))),
            violation_rate: mean(|episode| f32::from(u8::from(episode.violation))),
            violations: self.violations,
        }
    }
}
