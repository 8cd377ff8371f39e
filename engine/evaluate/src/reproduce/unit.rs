//! What one unit of work of the reproduction is, and its name.

use std::fmt;

use serde::{Deserialize, Serialize};

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
        /// Whether the shield masks high-force actions in training already; the paper has none.
        #[serde(default)]
        shielded: bool,
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

/// Whether a task's PuBS is trained under the shield in every table: in Sim Object nothing but
/// the limits is felt, and without a shield the first thing a policy finds is that large moves end
/// badly.
pub fn explored_under_shield(task: &str) -> bool {
    task == "sim_object"
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
                shielded,
                seed,
            } => {
                let frequency = frequency(belief_frequency);
                let shield = if *shielded { "-shield" } else { "" };
                let [goal, method, entropy] = [goal.name(), method.name(), entropy.name()];
                format!("training-{task}-{goal}-{method}-{entropy}{shield}{frequency}-seed{seed}")
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

    /// Filter updates per policy step; `None`: as the object file says.
    pub fn belief_frequency(&self) -> Option<u32> {
        match self {
            Self::Training {
                belief_frequency, ..
            }
            | Self::Solver {
                belief_frequency, ..
            } => *belief_frequency,
            Self::Arm { .. } => None,
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
            shielded: explored_under_shield(task),
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
                training("sim_object", GoalName::Own, Method::Pubs, belief, None),
                "training-sim_object-own-pubs-belief-shield-seed1",
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
