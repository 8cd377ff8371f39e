//! One episode of the surrogate MDP.

use std::sync::Arc;

use pubs_core::belief::{BeliefError, Filter, Model};
use pubs_core::reward::violates_safety;
use pubs_core::shield::{self, Shield};
use pubs_core::{Motion, Task};
use rand::Rng;

use super::{Simulator, unsteady::Unsteady};

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

/// A true state, a goal, and the belief that follows.
pub struct Episode {
    task: Arc<Task>,
    simulator: Simulator,
    filter: Filter,
    goal: f64,
    steps: u32,
    unsteady: Unsteady,
}

impl Episode {
    /// An episode to be [`begun`](Self::begin).
    pub fn new(task: Arc<Task>, model: Arc<dyn Model>) -> Self {
        Self {
            simulator: Simulator::new(&task, Arc::clone(&model)),
            filter: Filter::new(&task, model),
            goal: task.joint.lower,
            steps: 0,
            unsteady: Unsteady::default(),
            task,
        }
    }

    /// Begins anew at a true state with a belief that knows nothing.
    pub fn begin(&mut self, state: f64, goal: f64, rng: &mut impl Rng) {
        self.simulator.place(state, rng);
        self.filter.reset();
        self.goal = goal;
        self.steps = 0;
        self.unsteady = Unsteady::default();
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

    /// The belief.
    pub fn belief(&self) -> &Filter {
        &self.filter
    }

    /// Mean, entropy and, where `features` has room for three, mean − goal.
    pub fn features(&self, features: &mut [f32]) {
        let summary = self.filter.summary();
        let all = [
            summary.mean as f32,
            summary.entropy as f32,
            (summary.mean - self.goal) as f32,
        ];
        features.copy_from_slice(&all[..features.len()]);
    }

    /// Which actions a shield allows.
    pub fn allowed(&self, shield: Option<&Shield>, allowed: &mut [bool]) {
        shield::allowed(shield, &self.task, &self.filter, allowed);
    }

    /// One policy step, eq. (1).
    ///
    /// # Errors
    /// Where the filter or the model fails.
    pub fn step(&mut self, index: usize, rng: &mut impl Rng) -> Result<Step, BeliefError> {
        self.steps += 1;
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
        for _ in 0..observations {
            let part = displacement / f64::from(observations);
            let (made, observation) = self.simulator.step(index, action, part, rng)?;
            if self.unsteady.passes_over(made) {
                self.filter.follow(made);
                continue;
            }
            match self.filter.update(index, made, observation) {
                Ok(_) => {}
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
        Ok(Step {
            reward: reward.time,
            stopped: None,
        })
    }
}
