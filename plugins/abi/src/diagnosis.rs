//! What a driver finds when it is asked what stands in the way of moving.

use serde::{Deserialize, Serialize};

/// How a check went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckState {
    /// As it should be.
    Ok,
    /// The arm would move, but somebody should know.
    Warn,
    /// The arm would not move.
    Fault,
    /// Could not be looked at, because of an earlier fault or because it is not wanted.
    Skipped,
}

/// One thing looked at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DriverCheck {
    /// What was looked at, in a word or two.
    pub name: String,
    /// How it is.
    pub state: CheckState,
    /// What was found, with numbers and units.
    pub found: String,
    /// What to do about it; empty where there is nothing to do.
    pub cure: String,
}
