//! One unit of work of the reproduction, and what is stored of it.
//!
//! A cell is one JSON file, `cells/<id>.json` of a results folder. Field names are those of the
//! file. States are in SI, for abstract joints in their own numbers.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::evaluation::Evaluation;
pub use crate::reads::EntropyInput;
pub use pubs_policy::Method;

/// The goal of a training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GoalName {
    /// The upper limit.
    Open,
    /// Half-way between the limits.
    Middle,
    /// The lower limit.
    Closed,
    /// The goal that an abstract object's file gives.
    Own,
}

/// An offline solver, §IV-C.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverMethod {
    /// Littman, Cassandra and Kaelbling, 1995.
    Qmdp,
    /// Kurniawati, Hsu and Lee, 2008.
    Sarsop,
}

/// What one unit of work is; its [`Unit::id`] is its file name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Unit {
    /// One training with one seed, and its evaluation.
    Training {
        /// Name of the object: drawer1 … door2, sim_object, light_dark*.
        task: String,
        /// Its goal.
        goal: GoalName,
        /// How it is trained.
        method: Method,
        /// What stands for the entropy; says nothing where the method has no belief
        /// ([`EntropyInput::None`] by custom).
        entropy: EntropyInput,
        /// Filter updates per policy step; `None`: as the object file says.
        belief_frequency: Option<u32>,
        /// Of the training.
        seed: u64,
    },
    /// A solver's policy on an abstract object.
    Solver {
        /// Name of the object.
        task: String,
        /// Which solver.
        method: SolverMethod,
        /// Time limit, s; not part of the id.
        timeout_s: f64,
        /// As for a training.
        belief_frequency: Option<u32>,
    },
    /// Trials through the whole run loop on the virtual arm, at the middle goal (Table IV).
    Arm {
        /// Name of the object.
        task: String,
        /// How many; not part of the id.
        trials: u64,
        /// Whether the sensor drifts.
        drift: bool,
    },
}

/// A stored cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// What was done.
    pub unit: Unit,
    /// Version of the engine that did it.
    pub engine_version: String,
    /// The vector unit on which the last bits depend.
    pub vector_unit: String,
    /// Hash of the task that was compiled from the object file.
    pub task_hash: String,
    /// When it was done: RFC 3339, UTC.
    pub made_at: String,
    /// Wall time of the whole unit, s.
    pub time_s: f64,
    /// What came out.
    pub result: CellResult,
}

/// What came out of a [`Unit`] of the same kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[expect(
    clippy::large_enum_variant,
    reason = "there are hundreds, and nearly all are trainings"
)]
pub enum CellResult {
    /// Of [`Unit::Training`].
    Training {
        /// File name in the results' `policies` folder.
        policy: String,
        /// How it was trained, in words: what differs from the defaults.
        recipe: String,
        /// Environment steps of the training.
        steps: u64,
        /// Wall time of the training alone, s.
        training_s: f64,
        /// On the trials by which the best seed is chosen.
        selection: Judged,
        /// On trials of which nothing was chosen; these are reported.
        fresh: Judged,
    },
    /// Of [`Unit::Solver`].
    Solver {
        /// Lower bound of the value of the first belief, discounted.
        lower: f64,
        /// Upper bound of it.
        upper: f64,
        /// Vectors of the policy.
        alpha_vectors: u64,
        /// Time of the solver alone, s.
        solve_s: f64,
        /// File name in the results' `policies` folder.
        policy: String,
        /// Trials of the policy.
        evaluation: Figures,
    },
    /// Of [`Unit::Arm`].
    Arm {
        /// In order of their seeds.
        trials: Vec<ArmTrial>,
    },
}

/// The same trials without and with the shield.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Without, as the paper.
    pub plain: Figures,
    /// With; `None` where the method has no belief or the object no high-force action.
    pub shielded: Option<Figures>,
}

/// The figures of an evaluation that the tables need.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// How many trials.
    pub trials: u64,
    /// Mean sum of rewards.
    pub mean_reward: f64,
    /// Its standard error.
    pub mean_reward_se: f64,
    /// Mean Σ γ^t R_t.
    pub mean_discounted_reward: f64,
    /// Its standard error.
    pub mean_discounted_reward_se: f64,
    /// Share that stopped in the goal region.
    pub success_rate: f64,
    /// High-force actions that would have left the limits.
    pub safety_violations: u64,
    /// Trials that reached the cap.
    pub time_outs: u64,
    /// Stops outside the goal region.
    pub failed_stops: u64,
    /// Mean |s − s_g| of the trials that stopped; `None` where none did.
    pub mean_goal_error: Option<f64>,
    /// Mean policy steps.
    pub mean_steps: f64,
    /// Share of trials at whose end the belief's 90 % interval held the true state; `None` where
    /// there is no belief.
    pub coverage_90: Option<f64>,
}

/// How a trial on the arm ended: the outcomes of `run`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Stopped in the goal region.
    Reached,
    /// Stopped outside it.
    Missed,
    /// Reached the cap.
    TimedOut,
    /// Stopped for safety.
    SafetyStop,
    /// Something failed.
    Fault,
}

/// One trial on the virtual arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArmTrial {
    /// Of the run and of its world.
    pub seed: u64,
    /// True joint state at first.
    pub start: f64,
    /// The goal.
    pub goal: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// |s − s_g| at the end; `None` where nobody knows.
    pub goal_error: Option<f64>,
    /// From the first action to the end, s.
    pub time_s: f64,
    /// High-force actions that would have left the limits.
    pub safety_violations: u64,
    /// What of the world was varied, and by which factor.
    pub world: BTreeMap<String, f64>,
}

impl Unit {
    /// Letters, digits, `_` and `-`: names the cell's file.
    pub fn id(&self) -> String {
        let frequency = |frequency: &Option<u32>| match frequency {
            Some(frequency) => format!("-k{frequency}"),
            None => String::new(),
        };
        match self {
            Self::Training {
                task,
                goal,
                method,
                entropy,
                belief_frequency,
                seed,
            } => {
                let frequency = frequency(belief_frequency);
                let [goal, method, entropy] = [goal.name(), method.name(), entropy.name()];
                format!("training-{task}-{goal}-{method}-{entropy}{frequency}-seed{seed}")
            }
            Self::Solver {
                task,
                method,
                belief_frequency,
                ..
            } => {
                let frequency = frequency(belief_frequency);
                format!("solver-{task}-{}{frequency}", method.name())
            }
            Self::Arm { task, drift, .. } => {
                let drift = if *drift { "-drift" } else { "" };
                format!("arm-{task}{drift}")
            }
        }
    }

    /// Name of the object.
    pub fn task(&self) -> &str {
        match self {
            Self::Training { task, .. } | Self::Solver { task, .. } | Self::Arm { task, .. } => {
                task
            }
        }
    }
}

impl From<&Evaluation> for Figures {
    fn from(found: &Evaluation) -> Self {
        Self {
            trials: found.trials,
            mean_reward: found.mean_reward,
            mean_reward_se: found.mean_reward_se,
            mean_discounted_reward: found.mean_discounted_reward,
            mean_discounted_reward_se: found.mean_discounted_reward_se,
            success_rate: found.success_rate,
            safety_violations: found.safety_violations,
            time_outs: found.time_outs,
            failed_stops: found.failed_stops,
            mean_goal_error: found.mean_goal_error,
            mean_steps: found.mean_steps,
            coverage_90: found.coverage_90,
        }
    }
}

impl CellResult {
    /// Whether it can be the result of such a unit.
    pub fn is_of(&self, unit: &Unit) -> bool {
        matches!(
            (self, unit),
            (Self::Training { .. }, Unit::Training { .. })
                | (Self::Solver { .. }, Unit::Solver { .. })
                | (Self::Arm { .. }, Unit::Arm { .. })
        )
    }
}

impl GoalName {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Middle => "middle",
            Self::Closed => "closed",
            Self::Own => "own",
        }
    }
}

impl SolverMethod {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Qmdp => "qmdp",
            Self::Sarsop => "sarsop",
        }
    }
}

impl fmt::Display for SolverMethod {
    /// As in the paper.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Qmdp => "QMDP",
            Self::Sarsop => "SARSOP",
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn ids_name_what_was_done() {
        let training = |task: &str, goal, method, entropy, belief_frequency| Unit::Training {
            task: task.to_owned(),
            goal,
            method,
            entropy,
            belief_frequency,
            seed: 1,
        };
        let solver = |belief_frequency| Unit::Solver {
            task: "light_dark".to_owned(),
            method: SolverMethod::Sarsop,
            timeout_s: 60.0,
            belief_frequency,
        };
        let arm = |drift| Unit::Arm {
            task: "door2".to_owned(),
            trials: 20,
            drift,
        };
        let belief = EntropyInput::Belief;
        let cases = [
            (
                training("door2", GoalName::Middle, Method::Pubs, belief, None),
                "training-door2-middle-pubs-belief-seed1",
            ),
            (
                training("light_dark", GoalName::Own, Method::Pubs, belief, Some(5)),
                "training-light_dark-own-pubs-belief-k5-seed1",
            ),
            (
                training(
                    "drawer1",
                    GoalName::Closed,
                    Method::Lstm2,
                    EntropyInput::None,
                    None,
                ),
                "training-drawer1-closed-lstm2-none-seed1",
            ),
            (solver(None), "solver-light_dark-sarsop"),
            (solver(Some(1)), "solver-light_dark-sarsop-k1"),
            (arm(false), "arm-door2"),
            (arm(true), "arm-door2-drift"),
        ];
        for (unit, id) in cases {
            assert_eq!(unit.id(), id, "{unit:?}");
            let text = serde_json::to_string(&unit).unwrap();
            let back: Unit = serde_json::from_str(&text).unwrap();
            assert_eq!(back, unit, "{text}");
        }
    }
}
