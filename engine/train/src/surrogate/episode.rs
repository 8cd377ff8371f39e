//! One episode of the surrogate MDP.

use std::sync::Arc;

use pubs_core::belief::{BeliefError, Filter, Model, Summary};
use pubs_core::input::Seen;
use pubs_core::repetition::{Place, Repetition};
use pubs_core::reward::violates_safety;
use pubs_core::shield::{self, Shield};
use pubs_core::{Action, Motion, Task};
use rand::{Rng, RngExt};

use super::{Senses, Simulator, unsteady::Unsteady};

/// What a belief that knows nothing looks like; inputs of the belief are never asked for where no
/// filter follows.
const NOTHING_KNOWN: Summary = Summary {
    mean: 0.0,
    entropy: 1.0,
};

/// How an episode ended by the task's own rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stopped {
    /// Stop inside the goal region.
    Reached,
    /// Stop outside it.
    Missed,
    /// A high-force action that would have left the limits.
    Violated,
    /// The belief broke down for good; on an arm the run would be stopped here.
    Lost,
}

/// What one policy step brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// R(a, s').
    pub reward: f64,
    /// Whether it ended the episode.
    pub stopped: Option<Stopped>,
}

/// A true state, a goal, and what is felt and believed of it.
pub struct Episode {
    task: Arc<Task>,
    senses: Senses,
    simulator: Simulator,
    filter: Option<Filter>,
    goal: f64,
    steps: u32,
    unsteady: Unsteady,
    repetition: Repetition,
    readings: Vec<f32>,
    has_read: bool,
    random_entropy: f32,
}

impl Episode {
    /// An episode to be [`begun`](Self::begin).
    pub fn new(task: Arc<Task>, model: Arc<dyn Model>, senses: Senses) -> Self {
        Self {
            simulator: Simulator::new(&task, Arc::clone(&model)),
            readings: vec![0.0; model.channels().len()],
            filter: senses.belief.then(|| Filter::new(&task, model)),
            goal: task.joint.lower,
            steps: 0,
            unsteady: Unsteady::default(),
            repetition: Repetition::default(),
            has_read: false,
            random_entropy: 0.0,
            senses,
            task,
        }
    }

    /// Begins anew at a true state with a belief that knows nothing.
    pub fn begin(&mut self, state: f64, goal: f64, rng: &mut impl Rng) {
        self.simulator.place(state, rng);
        if let Some(filter) = &mut self.filter {
            filter.reset();
        }
        self.goal = goal;
        self.steps = 0;
        self.unsteady = Unsteady::default();
        self.repetition = Repetition::default();
        self.readings.fill(0.0);
        self.has_read = false;
        self.draw_entropy(rng);
    }

    /// The true state (rad, m or plain).
    pub fn state(&self) -> f64 {
        self.simulator.state()
    }

    /// The goal state.
    pub fn goal(&self) -> f64 {
        self.goal
    }

    /// Policy steps so far.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// The belief, where a filter follows.
    pub fn belief(&self) -> Option<&Filter> {
        self.filter.as_ref()
    }

    /// The newest reading of each channel that counts, `[C]`, 0 before the first: those that the
    /// belief would be updated with.
    pub fn readings(&self) -> &[f32] {
        &self.readings
    }

    /// Whether the latest step brought readings that count.
    pub fn has_read(&self) -> bool {
        self.has_read
    }

    /// The policy's inputs, in order.
    pub fn features(&self, features: &mut [f32]) {
        let seen = Seen {
            summary: self.filter.as_ref().map_or(NOTHING_KNOWN, Filter::summary),
            goal: self.goal,
            readings: &self.readings,
            random_entropy: self.random_entropy,
        };
        seen.fill(&self.senses.inputs, features);
    }

    /// Which actions a shield allows, less those that have just changed nothing; without a belief,
    /// all.
    pub fn allowed(&self, shield: Option<&Shield>, allowed: &mut [bool]) {
        let Some(filter) = &self.filter else {
            allowed.fill(true);
            return;
        };
        shield::allowed(shield, &self.task, filter, allowed);
        for (action, allowed) in allowed.iter_mut().enumerate() {
            *allowed &= self.repetition.allows(action);
        }
    }

    /// One policy step, eq. (1).
    ///
    /// # Errors
    /// Where the filter or the model fails.
    pub fn step(&mut self, index: usize, rng: &mut impl Rng) -> Result<Step, BeliefError> {
        self.steps += 1;
        self.has_read = false;
        self.draw_entropy(rng);
        let task = Arc::clone(&self.task);
        let (reward, action) = (&task.reward, &task.actions[index]);
        let Motion::Move {
            displacement,
            observations,
            ..
        } = action.motion
        else {
            let state = self.simulator.state();
            let reached = reward.in_goal_region(state, self.goal);
            let stopped = if reached {
                Stopped::Reached
            } else {
                Stopped::Missed
            };
            return Ok(Step {
                reward: reward.of_stop(state, self.goal) + reward.time,
                stopped: Some(stopped),
            });
        };
        if violates_safety(&task.joint, action, self.simulator.state()) {
            return Ok(Step {
                reward: reward.safety_violation + reward.time,
                stopped: Some(Stopped::Violated),
            });
        }
        self.unsteady.change_to(&task, index);
        if let Some(place) = self.place() {
            self.repetition.begin(index, place);
        }
        for _ in 0..observations {
            let part = displacement / f64::from(observations);
            match self.follow(index, action, part, rng) {
                Ok(()) => {}
                Err(BeliefError::Impossible { .. }) => {
                    let reward = reward.failed_stop + reward.time;
                    return Ok(Step {
                        reward,
                        stopped: Some(Stopped::Lost),
                    });
                }
                Err(error) => return Err(error),
            }
        }
        if let Some(place) = self.place() {
            self.repetition.end(&self.task.joint, place);
        }
        Ok(Step {
            reward: reward.time,
            stopped: None,
        })
    }

    /// Carries out a part of an action, feels, and lets the belief follow.
    fn follow(
        &mut self,
        index: usize,
        action: &Action,
        displacement: f64,
        rng: &mut impl Rng,
    ) -> Result<(), BeliefError> {
        let (made, observation) = self.simulator.step(index, action, displacement, rng)?;
        let counts = !self.unsteady.passes_over(made);
        if counts {
            self.readings.copy_from_slice(observation);
            self.has_read = true;
        }
        match &mut self.filter {
            None => {}
            Some(filter) if counts => {
                filter.update(index, made, observation)?;
            }
            Some(filter) => filter.follow(made),
        }
        Ok(())
    }

    /// Handle and belief, where a filter follows.
    fn place(&self) -> Option<Place> {
        self.filter.as_ref().map(|filter| Place {
            handle: self.simulator.state(),
            summary: filter.summary(),
        })
    }

    /// Draws only where somebody reads it, so that the other streams stay as they are.
    fn draw_entropy(&mut self, rng: &mut impl Rng) {
        if self.senses.draws() {
            self.random_entropy = rng.random();
        }
    }
}
