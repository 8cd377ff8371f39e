//! What a policy file promises: the metadata under the prefix `pubs.`.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::feature::UNITS;
use crate::hash::{canonical_json, task_hash};
use crate::{Fault, Feature, Method};

/// The version of the contract of a perceptron's policy.
pub const FORMAT_VERSION: u32 = 1;
/// The version of the contract of a recurrent policy: an engine that knows nothing of its state
/// must not run it, and refuses it by this number.
pub const RECURRENT_FORMAT_VERSION: u32 = 2;
/// The versions that this engine reads.
const KNOWN_VERSIONS: RangeInclusive<u64> = FORMAT_VERSION as u64..=RECURRENT_FORMAT_VERSION as u64;
/// Far above any policy; keeps a wrong file from filling the memory.
const WIDEST_STATE: usize = 1 << 20;
/// What the metadata keys begin with. Each value is JSON.
pub const PREFIX: &str = "pubs.";

/// Everything a policy file says of itself. Lengths in m, angles in rad, plain for abstract joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contract {
    /// [`FORMAT_VERSION`], or [`RECURRENT_FORMAT_VERSION`] where there is a state.
    pub format_version: u32,
    /// The object it was trained for.
    pub object: String,
    /// [`task_hash`] of `task`: must match the object's.
    pub task_hash: String,
    /// The [`canonical_json`] of joint, actions, speeds, rates, reward and belief.
    pub task: String,
    /// Hash of the observation model; may differ, with a warning (§III-C, §IV-E).
    pub observation_hash: String,
    /// Which goal it reaches.
    pub goal: Goal,
    /// Half the width of the goal region, in the joint's SI unit.
    pub tolerance: f64,
    /// The network's inputs in order.
    pub inputs: Vec<Feature>,
    /// The network's outputs in order, by action name.
    pub actions: Vec<String>,
    /// The shield it was trained and evaluated with.
    pub shield: Option<Shield>,
    /// Discount per policy step.
    pub discount: f64,
    /// Policy steps per second.
    pub policy_rate_hz: f64,
    /// The seed of its training.
    pub seed: u64,
    /// Environment steps of its training.
    pub steps: u64,
    /// The training recipe by name.
    pub recipe: String,
    /// Mean reward per episode in its evaluation.
    pub evaluation_reward: f64,
    /// The engine that trained it.
    pub engine_version: String,
    /// How it was trained; a file that does not say was trained by [`Method::Pubs`].
    #[serde(default, skip_serializing_if = "Method::is_pubs")]
    pub method: Method,
    /// What a recurrent policy carries from step to step; a perceptron's file has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<State>,
}

/// The state of a recurrent policy. A row of it holds, LSTM layer by LSTM layer from the first,
/// the layer's last output h and then its cell c; all zeros where an episode begins.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Width of each LSTM layer, at least one.
    pub lstm: Vec<usize>,
}

impl State {
    /// Numbers in a row: `Σ 2 · width`.
    #[must_use]
    pub fn width(&self) -> usize {
        self.lstm.iter().fold(0, |sum: usize, width| {
            sum.saturating_add(width.saturating_mul(2))
        })
    }

    fn check(&self) -> Result<(), String> {
        let lstm = &self.lstm;
        if lstm.is_empty() || lstm.contains(&0) || self.width() > WIDEST_STATE {
            return Err(format!(
                "has a state of LSTM layers {lstm:?}; each needs a width, all together at most {WIDEST_STATE} numbers"
            ));
        }
        Ok(())
    }
}

/// The goal of a policy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// Any: the goal is among the inputs.
    Every,
    /// This one.
    Fixed {
        /// Joint state, rad, m or plain.
        value: f64,
        /// Fraction of the range from closed to open.
        fraction: f64,
    },
}

/// High-force actions are masked where the flattened belief puts too much mass near that limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shield {
    /// Largest mass within one high-force step of the limit.
    pub mass: f64,
    /// Exponent on the particle weights.
    pub flattening: f64,
}

impl Contract {
    /// Checks what the types cannot: numbers, hash, and that no list is empty.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self) -> Result<(), String> {
        if self.inputs.is_empty() || self.actions.is_empty() {
            return Err("names no inputs or no actions".into());
        }
        let goal = match self.goal {
            Goal::Every => vec![],
            Goal::Fixed { value, fraction } => {
                vec![("goal value", value), ("goal fraction", fraction)]
            }
        };
        let shield = self.shield.map_or(vec![], |s| {
            vec![("shield mass", s.mass), ("flattening", s.flattening)]
        });
        let numbers = [
            ("tolerance", self.tolerance),
            ("discount", self.discount),
            ("policy_rate_hz", self.policy_rate_hz),
            ("evaluation_reward", self.evaluation_reward),
        ];
        let ranges = self
            .inputs
            .iter()
            .flat_map(|input| [input.lower, input.upper, input.offset, input.scale]);
        let ranges = ranges.map(|value| ("range or scaling of an input", value));
        let mut all = numbers.into_iter().chain(goal).chain(shield).chain(ranges);
        if let Some((name, value)) = all.find(|(_, value)| !value.is_finite()) {
            return Err(format!("says that {name} is {value}"));
        }
        if let Some(input) = self
            .inputs
            .iter()
            .find(|input| !UNITS.contains(&input.unit.as_str()))
        {
            let Feature { name, unit, .. } = input;
            return Err(format!(
                "says that {name} is in {unit:?}, known are {}",
                UNITS.join(", ")
            ));
        }
        if let Some(input) = self.inputs.iter().find(|input| !input.name.is_word()) {
            let name = input.name.to_string();
            return Err(format!(
                "names the input {name:?}, which does not read back"
            ));
        }
        self.check_state()?;
        self.check_task()
    }

    fn check_state(&self) -> Result<(), String> {
        let (wanted, kind) = match &self.state {
            None => (FORMAT_VERSION, "without"),
            Some(_) => (RECURRENT_FORMAT_VERSION, "with"),
        };
        let found = self.format_version;
        if found != wanted {
            return Err(format!(
                "has version {found}, but is one {kind} a state, which is version {wanted}"
            ));
        }
        self.state.as_ref().map_or(Ok(()), State::check)
    }

    fn check_task(&self) -> Result<(), String> {
        let task: Value = serde_json::from_str(&self.task)
            .map_err(|fault| format!("has a task that is no JSON: {fault}"))?;
        if !task.is_object() {
            return Err("has a task that is no table".into());
        }
        let found = crate::sha256_hex(&self.task);
        if found != self.task_hash {
            return Err(format!(
                "says task hash {}, but its task has {found}",
                self.task_hash
            ));
        }
        Ok(())
    }

    /// Sets `task` and `task_hash` from the task as JSON.
    pub fn set_task(&mut self, task: &Value) {
        self.task = canonical_json(task);
        self.task_hash = task_hash(task);
    }

    /// One entry per field, keys with the prefix, values JSON.
    pub(crate) fn to_metadata(&self) -> Result<BTreeMap<String, String>, String> {
        let Ok(Value::Object(fields)) = serde_json::to_value(self) else {
            return Err("cannot be written as JSON".into());
        };
        let entry = |(name, value): (String, Value)| {
            // The task is JSON already, and readers of the file want it as such.
            let text = if name == "task" {
                self.task.clone()
            } else {
                canonical_json(&value)
            };
            (format!("{PREFIX}{name}"), text)
        };
        Ok(fields.into_iter().map(entry).collect())
    }

    /// Reads the fields back; `entries` has them without the prefix and without the sums.
    pub(crate) fn from_metadata(entries: &BTreeMap<&str, &str>) -> Result<Self, Fault> {
        check_version(entries)?;
        let mut fields = Map::new();
        for (name, text) in entries {
            let value = if *name == "task" {
                Ok(Value::from(*text))
            } else {
                serde_json::from_str(text)
            };
            let value = value
                .map_err(|fault| Fault::Contract(format!("has {name} = {text:?}: {fault}")))?;
            fields.insert((*name).to_owned(), value);
        }
        let contract: Self = serde_json::from_value(Value::Object(fields))
            .map_err(|fault| Fault::Contract(format!("does not read: {fault}")))?;
        contract.check().map_err(Fault::Contract)?;
        Ok(contract)
    }
}

/// Comes before anything else is read: another version may have other fields.
pub(crate) fn check_version(entries: &BTreeMap<&str, &str>) -> Result<(), Fault> {
    let found = *entries.get("format_version").ok_or(Fault::NoContract)?;
    match found.parse::<u64>() {
        Ok(version) if KNOWN_VERSIONS.contains(&version) => Ok(()),
        Ok(version) => Err(Fault::FormatVersion {
            found: version,
            newer: version > *KNOWN_VERSIONS.end(),
        }),
        Err(_) => Err(Fault::Contract(format!(
            "has format_version = {found:?}, which is no number"
        ))),
    }
}
