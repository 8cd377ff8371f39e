//! What the recording of a run says of it beyond the header of every recording: what a replay needs
//! beside object file and policies, and what its reader wants to know.

use std::collections::BTreeMap;

use pubs_policy::FeatureName;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Name of the metadata record that holds it.
pub(super) const RUN_METADATA: &str = "pubs-engine run";

/// How a run was set up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunHeader {
    /// Goals in turn (rad or m), and the index of the policy that serves each.
    pub goals: Vec<(f64, usize)>,
    /// ε_g, half the width of a goal's region (rad or m).
    pub goal_tolerance: f64,
    /// Mass and flattening of the shield; `None` where nothing was masked.
    pub shield: Option<(f64, f64)>,
    /// Policy steps allowed for each goal.
    pub max_steps: u32,
    /// Whether it ran on a virtual clock.
    pub lockstep: bool,
    /// Filter updates per policy step, where `--belief-frequency` asked for them.
    pub belief_frequency: Option<u32>,
    /// The vector unit on which the last bits depend.
    pub vector_unit: String,
    /// Name and version of the driver.
    pub driver: String,
    /// The whole `[driver]` table.
    pub driver_parameters: Value,
    /// Name and version of the observation model.
    pub model: String,
    /// What ran the policies.
    pub runtime: String,
    /// What was set over the object file, as it was typed.
    pub overrides: Vec<String>,
    /// The policies; their files are attached.
    pub policies: Vec<PolicyNote>,
    /// When it began, where it ran in real time (UTC, ISO 8601). A lockstep run does not say: it is
    /// the same byte for byte whenever it is made.
    pub started: Option<String>,
}

/// One policy of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PolicyNote {
    /// Where its file lay.
    pub name: String,
    /// sha256 of its weights.
    pub sha256: String,
    /// Its inputs, where the file carries no contract to say so.
    pub foreign_inputs: Option<Vec<FeatureName>>,
    /// Its contract, for readers; the attached file holds it as well.
    pub contract: Value,
}

impl RunHeader {
    /// Pairs of key and JSON text.
    pub(super) fn to_fields(&self) -> BTreeMap<String, String> {
        let Ok(Value::Object(fields)) = serde_json::to_value(self) else {
            unreachable!("a struct of named fields is a JSON object");
        };
        fields
            .into_iter()
            .map(|(key, value)| (key, value.to_string()))
            .collect()
    }

    /// The header from those pairs, or what is wrong with them.
    pub(super) fn from_fields(fields: &BTreeMap<String, String>) -> Result<Self, String> {
        let mut object = Map::new();
        for (key, text) in fields {
            let value = serde_json::from_str(text).map_err(|error| format!("`{key}`: {error}"))?;
            object.insert(key.clone(), value);
        }
        serde_json::from_value(Value::Object(object)).map_err(|error| error.to_string())
    }
}
