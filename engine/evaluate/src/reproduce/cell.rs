//! One unit of work of the reproduction, and what is stored of it.
//!
//! A cell is one JSON file, `cells/<id>.json` of a results folder. Field names are those of the
//! file. States are in SI, for abstract joints in their own numbers.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use crate::evaluation::Figures;

pub use pubs_run::Outcome;

pub use super::unit::{EntropyInput, GoalName, Method, SolverMethod, Unit};

/// A stored cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// What was done.
    pub unit: Unit,
    /// Version of the engine that did it.
    pub engine_version: String,
    /// The vector unit on which the last bits depend.
    pub vector_unit: String,
    /// Hashes of the task that was compiled from the object file, less its filter, and of its
    /// observation model.
    pub task_hash: String,
    /// Hash of the filter's settings; `None` where none follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter_hash: Option<String>,
    /// Hash of the shield; `None` where none has a say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shield_hash: Option<String>,
    /// When it was done: RFC 3339, UTC.
    pub made_at: String,
    /// Wall time of the whole unit, s.
    pub time_s: f64,
    /// Whether it was taken from a kept report, so that its policy may not be there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub without_policy: bool,
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
        /// Of the weights of the policy.
        #[serde(default)]
        policy_sha256: String,
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
        /// Of the weights of the policy that was taken, the best seed's at that time.
        #[serde(default)]
        policy_sha256: String,
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
