//! What a policy of alpha vectors says of the grid that it was solved on.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::GridOptions;

/// The object, its goal and its grid: enough to make the POMDP again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridOrigin {
    /// Name of the object.
    pub object: String,
    /// Its goal (rad, m or plain).
    pub goal: f64,
    /// How fine the grid is.
    pub grid: GridOptions,
    /// Filter updates per policy step, where it was not the object file's.
    pub belief_frequency: Option<u32>,
}

impl GridOrigin {
    /// As a policy file carries it.
    pub fn to_value(&self) -> Value {
        serde_json::to_value(self).unwrap_or(Value::Null)
    }

    /// Reads it back; `None` where the policy is for something else than an object.
    pub fn of(value: Option<&Value>) -> Option<Self> {
        serde_json::from_value(value?.clone()).ok()
    }
}
