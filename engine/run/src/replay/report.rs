//! What a replay gives back; field names are the program's `--json`.

use serde::Serialize;
use serde_json::Value;

/// How much of one thing was compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Compared {
    /// Messages.
    pub compared: u64,
    /// Those that differ by more than the tolerance.
    pub differ: u64,
}

/// One place where run and replay differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Since the first tick of the run.
    pub time_s: f64,
    /// Topic of the recording.
    pub topic: &'static str,
    /// Which tick or step, from 1.
    pub step: u64,
    /// Which value of the message.
    pub field: &'static str,
    /// In the run.
    pub recorded: Value,
    /// In the replay.
    pub replayed: Value,
}

/// A whole replay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Whether all that could be compared is the same and nothing is missing.
    pub same: bool,
    /// The first difference of all.
    pub first: Option<Difference>,
    /// The first on each topic, in the order of time.
    pub differences: Vec<Difference>,
    /// Displacement and forces, 100 Hz.
    pub observations: Compared,
    /// Mean, entropy and what the shield allows, 30 Hz.
    pub beliefs: Compared,
    /// 10 Hz.
    pub actions: Compared,
    /// How long the recording is.
    pub time_s: f64,
    /// What the recording lacks, in words.
    pub missing: Vec<String>,
    /// The vector unit of the run.
    pub recorded_on: String,
    /// The one of the replay: the same where this machine has it.
    pub replayed_on: String,
}
