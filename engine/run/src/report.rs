//! What a run gives back; field names are the program's `--json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::lateness::LatenessSummary;

/// How a goal ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Stopped inside the goal region.
    Reached,
    /// Stopped outside it.
    Missed,
    /// The policy did not stop within the cap on its steps.
    TimedOut,
    /// The guard, a safety violation or a person stopped it.
    SafetyStop,
    /// A loop or the driver failed.
    Fault,
}

/// Whose word the outcome rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JudgedBy {
    /// The true joint state, which a virtual world tells.
    Truth,
    /// The mean of the belief: nobody knows the true state.
    Belief,
}

/// Mean (rad, m or plain) and entropy (0 to 1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BeliefReport {
    /// μ of eq. (9).
    pub mean: f64,
    /// H of eq. (10) divided by ln N.
    pub entropy: f64,
}

/// One goal of a run. States in rad or m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoalReport {
    /// How it ended.
    pub outcome: Outcome,
    /// By whose word.
    pub judged_by: JudgedBy,
    /// s_g.
    pub goal: f64,
    /// The belief at the end.
    pub belief: BeliefReport,
    /// The true state at the end, where somebody knows.
    pub true_state: Option<f64>,
    /// |true state − goal|.
    pub goal_error: Option<f64>,
    /// From the first belief to the verdict.
    pub time_s: f64,
    /// Actions chosen, the stop among them.
    pub policy_steps: u32,
    /// How often each action was chosen.
    pub actions: BTreeMap<String, u32>,
}

/// Lateness of the three loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LatenessReport {
    /// 100 Hz.
    pub controller: LatenessSummary,
    /// 30 Hz.
    pub filter: LatenessSummary,
    /// 10 Hz.
    pub policy: LatenessSummary,
}

/// A whole run. The fields of the last goal stand at the top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// Name of the object.
    pub object: String,
    /// The policy that chose the actions.
    pub policy: String,
    /// Whether high-force actions were masked near limits.
    pub shield: bool,
    /// How the run ended: as its last goal did.
    pub outcome: Outcome,
    /// By whose word.
    pub judged_by: JudgedBy,
    /// s_g of the last goal.
    pub goal: f64,
    /// The belief at the end.
    pub belief: BeliefReport,
    /// The true state at the end.
    pub true_state: Option<f64>,
    /// |true state − goal|.
    pub goal_error: Option<f64>,
    /// The whole run.
    pub time_s: f64,
    /// Over all goals.
    pub policy_steps: u32,
    /// High-force actions that would have left the limits; null where nobody knows the state.
    pub safety_violations: Option<u32>,
    /// Stops by the guard.
    pub guard_stops: u32,
    /// Why the guard stopped, in words.
    pub reason: Option<String>,
    /// How late the loops were; zero on a virtual clock.
    pub lateness: LatenessReport,
    /// Whether the kernel granted real-time scheduling.
    pub real_time: bool,
    /// The recording; null where none was made.
    pub recording: Option<String>,
    /// Entries that the recording lacks because the disk was too slow.
    pub recording_dropped: u64,
    /// Why the recording ends early, in words.
    pub recording_fault: Option<String>,
    /// How often the belief's recovery rule acted.
    pub recoveries: u32,
    /// Each of the first recoveries in words.
    pub notes: Vec<String>,
    /// The vector unit on which the last bits depend.
    pub vector_unit: String,
    /// The seed of the run.
    pub seed: u64,
    /// Each goal in turn.
    pub goals: Vec<GoalReport>,
}
