//! Whether a policy fits the object it is to move.

use std::fmt;

use serde_json::Value;

use crate::hash::{canonical_json, task_hash};
use crate::{Contract, Goal};

/// Goals closer than this, relative to their size, are the same goal.
const SAME_GOAL: f64 = 1e-6;

/// What the object at hand asks of a policy.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Joint, actions, speeds, rates, reward and belief, as JSON.
    pub task: Value,
    /// Hash of the observation model.
    pub observation_hash: String,
    /// Action names in order.
    pub actions: Vec<String>,
    /// The goal wanted, rad, m or plain; `None` where any will do.
    pub goal: Option<f64>,
}

/// Worth saying, but no reason to refuse.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Warning {
    /// Recalibrated since the training: what the paper claims to work (§III-C, §IV-E).
    Observation {
        /// The hash in the policy.
        policy: String,
        /// The object's.
        object: String,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Observation { policy, object } = self;
        write!(
            formatter,
            "the policy was trained with another observation model (policy {}, object {}); \
             it should still work, retrain if it does not",
            short(policy),
            short(object)
        )
    }
}

/// Why a policy does not fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// Trained for another task.
    #[error(
        "the policy was trained for another task (object {name:?}, task {policy}; here {object}):{}\
         \ntrain one for this object, or go back to the values it was trained with (--belief-frequency, where \
         rates or observations differ)", list(.differences)
    )]
    Task {
        /// The object named in the policy.
        name: String,
        /// The hash in the policy.
        policy: String,
        /// The object's.
        object: String,
        /// One line per key: `control.safe_speed_m_s: policy 0.05, object 0.06`.
        differences: Vec<String>,
    },
    /// The outputs would be taken for other actions.
    #[error(
        "the policy chooses among {}, the object among {}; train one for this object",
        policy.join(", "),
        object.join(", ")
    )]
    Actions {
        /// The policy's, in order.
        policy: Vec<String>,
        /// The object's, in order.
        object: Vec<String>,
    },
    /// Trained for one goal, wanted for another.
    #[error(
        "the policy was trained for the goal {policy}, not {wanted}; train one for every goal, or for that one"
    )]
    Goal {
        /// The policy's, with its unit.
        policy: String,
        /// The one asked for.
        wanted: String,
    },
}

impl Contract {
    /// Compares with what the object at hand asks for.
    ///
    /// # Errors
    /// Where the policy must not be used.
    pub fn compare(&self, expected: &Expected) -> Result<Vec<Warning>, Mismatch> {
        let object = task_hash(&expected.task);
        if self.task_hash != object {
            return Err(Mismatch::Task {
                name: self.object.clone(),
                policy: short(&self.task_hash).to_owned(),
                object: short(&object).to_owned(),
                differences: self.task_differences(&expected.task),
            });
        }
        if self.actions != expected.actions {
            return Err(Mismatch::Actions {
                policy: self.actions.clone(),
                object: expected.actions.clone(),
            });
        }
        self.compare_goal(expected.goal)?;
        Ok(self
            .compare_observation(&expected.observation_hash)
            .into_iter()
            .collect())
    }

    fn compare_goal(&self, wanted: Option<f64>) -> Result<(), Mismatch> {
        match (self.goal, wanted) {
            (Goal::Fixed { value, .. }, Some(wanted)) if !same(value, wanted) => {
                Err(Mismatch::Goal {
                    policy: self.in_words(value),
                    wanted: self.in_words(wanted),
                })
            }
            _ => Ok(()),
        }
    }

    /// A joint state as people write it; its unit follows from the joint that the task names.
    fn in_words(&self, state: f64) -> String {
        let task: Value = serde_json::from_str(&self.task).unwrap_or(Value::Null);
        match task.pointer("/joint/type").and_then(Value::as_str) {
            Some("revolute") => format!("{:.1}°", state.to_degrees()),
            Some("prismatic") => format!("{:.1} cm", state * 100.0),
            _ => state.to_string(),
        }
    }

    fn compare_observation(&self, object: &str) -> Option<Warning> {
        (self.observation_hash != object).then(|| Warning::Observation {
            policy: self.observation_hash.clone(),
            object: object.to_owned(),
        })
    }

    fn task_differences(&self, object: &Value) -> Vec<String> {
        let parsed = |text: &str| serde_json::from_str(text).unwrap_or(Value::Null);
        let mut found = Vec::new();
        // Both go through the text, so that neither is rounded alone.
        differences(
            "",
            &parsed(&self.task),
            &parsed(&canonical_json(object)),
            &mut found,
        );
        found
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_GOAL * a.abs().max(b.abs()).max(SAME_GOAL)
}

fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

fn list(differences: &[String]) -> String {
    differences
        .iter()
        .map(|line| format!("\n  {line}"))
        .collect()
}

/// Goes down both values side by side and notes each leaf that differs, by its dotted key.
fn differences(key: &str, policy: &Value, object: &Value, found: &mut Vec<String>) {
    match (policy, object) {
        (Value::Object(ours), Value::Object(theirs)) => {
            let mut names: Vec<&String> = ours.keys().chain(theirs.keys()).collect();
            names.sort();
            names.dedup();
            for name in names {
                let key = if key.is_empty() {
                    name.clone()
                } else {
                    format!("{key}.{name}")
                };
                pair(&key, ours.get(name), theirs.get(name), found);
            }
        }
        (Value::Array(ours), Value::Array(theirs)) if ours.len() == theirs.len() => {
            for (index, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                differences(&format!("{key}[{index}]"), ours, theirs, found);
            }
        }
        (Value::Null, object) if !object.is_null() => {
            found.push(format!("{key}: policy has none, object {object}"));
        }
        (policy, Value::Null) if !policy.is_null() => {
            found.push(format!("{key}: policy {policy}, object has none"));
        }
        _ if policy != object => found.push(format!("{key}: policy {policy}, object {object}")),
        _ => {}
    }
}

fn pair(key: &str, policy: Option<&Value>, object: Option<&Value>, found: &mut Vec<String>) {
    match (policy, object) {
        (Some(policy), Some(object)) => differences(key, policy, object, found),
        (Some(policy), None) => found.push(format!("{key}: policy {policy}, object has none")),
        (None, Some(object)) => found.push(format!("{key}: policy has none, object {object}")),
        (None, None) => {}
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use serde_json::json;

    fn task() -> Value {
        json!({
            "control": {"safe_speed_m_s": 0.05, "rate_hz": 100},
            "actions": [{"name": "stop"}, {"name": "safe_open"}],
            "joint": {"upper": 2.181_661_564_992_912},
        })
    }

    fn contract(goal: Goal) -> Contract {
        let text = json!({
            "format_version": 1, "object": "door2", "task_hash": "", "task": "", "observation_hash": "aa",
            "goal": goal, "tolerance": 0.1, "inputs": [], "actions": ["stop", "safe_open"], "shield": null,
            "discount": 0.99, "policy_rate_hz": 10, "seed": 1, "steps": 2, "recipe": "paper",
            "evaluation_reward": 0.5, "engine_version": "0.1.0",
        });
        let mut contract: Contract = serde_json::from_value(text).unwrap();
        contract.set_task(&task());
        contract
    }

    fn expected() -> Expected {
        let actions = vec!["stop".into(), "safe_open".into()];
        Expected {
            task: task(),
            observation_hash: "aa".into(),
            actions,
            goal: None,
        }
    }

    #[test]
    fn what_fits_is_taken_without_a_word() {
        for goal in [None, Some(0.3)] {
            assert_eq!(
                contract(Goal::Every).compare(&Expected { goal, ..expected() }),
                Ok(vec![])
            );
        }
        let fixed = contract(Goal::Fixed {
            value: 0.3,
            fraction: 0.5,
        });
        for goal in [None, Some(0.3), Some(0.1 + 0.2)] {
            assert_eq!(
                fixed.compare(&Expected { goal, ..expected() }),
                Ok(vec![]),
                "{goal:?}"
            );
        }
        let mut whole = expected();
        whole.task["control"]["rate_hz"] = json!(100.0);
        assert_eq!(
            fixed.compare(&whole),
            Ok(vec![]),
            "100 and 100.0 are the same rate"
        );
    }

    #[test]
    fn another_task_is_refused_key_by_key() {
        type Change = fn(&mut Value);
        let cases: [(Change, &str); 5] = [
            (
                |t| t["control"]["safe_speed_m_s"] = json!(0.06),
                "control.safe_speed_m_s: policy 0.05, object 0.06",
            ),
            (
                |t| t["control"]["high_speed_m_s"] = json!(0.15),
                "control.high_speed_m_s: policy has none, object 0.15",
            ),
            (
                |t| t["control"] = json!({"rate_hz": 100}),
                "control.safe_speed_m_s: policy 0.05, object has none",
            ),
            (
                |t| t["actions"][1]["name"] = json!("open"),
                r#"actions[1].name: policy "safe_open", object "open""#,
            ),
            (
                |t| t["actions"] = json!([]),
                r#"actions: policy [{"name":"stop"},{"name":"safe_open"}], object []"#,
            ),
        ];
        for (change, line) in cases {
            let mut object = expected();
            change(&mut object.task);
            let fault = contract(Goal::Every).compare(&object).unwrap_err();
            let Mismatch::Task { differences, .. } = &fault else {
                panic!("{fault}")
            };
            assert_eq!(differences, &[line.to_owned()]);
            let text = fault.to_string();
            assert!(
                text.contains(line) && text.contains(&task_hash(&task())[..12]),
                "{text}"
            );
            assert!(
                text.contains(&task_hash(&object.task)[..12]),
                "both hashes are shown: {text}"
            );
        }
    }

    #[test]
    fn goal_actions_and_observation() {
        let fixed = contract(Goal::Fixed {
            value: 0.3,
            fraction: 0.5,
        });
        let fault = fixed
            .compare(&Expected {
                goal: Some(0.31),
                ..expected()
            })
            .unwrap_err();
        assert_eq!(
            fault,
            Mismatch::Goal {
                policy: "0.3".to_owned(),
                wanted: "0.31".to_owned(),
            }
        );
        let mut object = expected();
        object.actions.reverse();
        let fault = fixed.compare(&object).unwrap_err();
        assert!(matches!(fault, Mismatch::Actions { .. }), "{fault}");
        let warnings = fixed
            .compare(&Expected {
                observation_hash: "bb".into(),
                ..expected()
            })
            .unwrap();
        let text = warnings[0].to_string();
        assert!(
            warnings.len() == 1 && text.contains("policy aa, object bb"),
            "{text}"
        );
    }
}
