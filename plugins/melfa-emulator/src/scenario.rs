//! Faults at times, from a TOML file.

use std::path::Path;

use serde::Deserialize;
use toml::Value;

use crate::fault::Fault;

/// What the time of an event counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The start of the emulator.
    #[default]
    Start,
    /// The first motion of the arm.
    Motion,
}

/// A fault at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// s after the origin.
    pub at_s: f64,
    /// What the time counts from.
    pub after: Origin,
    /// What happens.
    pub fault: Fault,
}

/// The events that are still to come.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scenario {
    events: Vec<Event>,
}

/// Why a scenario was refused.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("scenario {path} cannot be read: {reason}")]
    Unreadable {
        /// As asked for.
        path: String,
        /// The system's account.
        reason: String,
    },
    /// Not TOML, or not `[[event]]` tables alone.
    #[error("scenario: {0}")]
    Format(String),
    /// An event that is none.
    #[error("scenario, event {number}: {reason}")]
    Event {
        /// From 1.
        number: usize,
        /// What is wrong with it.
        reason: String,
    },
}

impl Scenario {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// Where it cannot be read or is no scenario.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let text = std::fs::read_to_string(path).map_err(|error| ScenarioError::Unreadable {
            path: path.display().to_string(),
            reason: error.to_string(),
        })?;
        Self::parse(&text)
    }

    /// Reads its text.
    ///
    /// # Errors
    ///
    /// Where it is no scenario.
    pub fn parse(text: &str) -> Result<Self, ScenarioError> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct File {
            #[serde(default)]
            event: Vec<toml::Table>,
        }
        let file: File =
            toml::from_str(text).map_err(|error| ScenarioError::Format(error.to_string()))?;
        let events = file.event.into_iter().enumerate().map(|(index, table)| {
            event(table).map_err(|reason| ScenarioError::Event {
                number: index + 1,
                reason,
            })
        });
        Ok(Self {
            events: events.collect::<Result<_, _>>()?,
        })
    }

    /// The faults whose time has come, in the order of the file; they are told once.
    pub fn due(&mut self, now_s: f64, first_motion_s: Option<f64>) -> Vec<Fault> {
        let origin_s = |origin| match origin {
            Origin::Start => Some(0.0),
            Origin::Motion => first_motion_s,
        };
        let is_due = |event: &mut Event| {
            origin_s(event.after).is_some_and(|origin_s| now_s >= origin_s + event.at_s)
        };
        self.events
            .extract_if(.., is_due)
            .map(|event| event.fault)
            .collect()
    }
}

fn event(mut table: toml::Table) -> Result<Event, String> {
    let at_s = match table.remove("at_s") {
        Some(Value::Float(at_s)) if at_s >= 0.0 => at_s,
        Some(Value::Integer(at_s)) if at_s >= 0 => at_s as f64,
        _ => return Err("at_s should be a number of seconds, 0 or more".to_owned()),
    };
    let after = match table.remove("after") {
        Some(value) => value
            .try_into()
            .map_err(|error: toml::de::Error| error.to_string())?,
        None => Origin::default(),
    };
    let table = Value::Table(table);
    if !is_finite(&table) {
        return Err("a number is infinite or none".to_owned());
    }
    let fault = table
        .try_into()
        .map_err(|error: toml::de::Error| error.to_string())?;
    Ok(Event { at_s, after, fault })
}

/// TOML has numbers that no fault can have.
fn is_finite(value: &Value) -> bool {
    match value {
        Value::Float(number) => number.is_finite(),
        Value::Array(values) => values.iter().all(is_finite),
        Value::Table(table) => table.values().all(is_finite),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn events_come_once_at_their_times() {
        let text = r#"
            [[event]]
            at_s = 2
            do = "emergency_stop"
            [[event]]
            at_s = 0.5
            after = "motion"
            do = "pull"
            force_n = 30.0
            seconds = 0.2
        "#;
        let mut scenario = Scenario::parse(text).unwrap();
        let pull = Fault::Pull {
            force_n: 30.0,
            seconds: 0.2,
        };
        let stop = Fault::EmergencyStop { pressed: true };
        assert_eq!(scenario.due(1.9, None), []);
        assert_eq!(scenario.due(2.0, None), [stop]);
        assert_eq!(scenario.due(3.0, None), [], "once, and nothing has moved");
        assert_eq!(scenario.due(3.4, Some(3.0)), []);
        assert_eq!(scenario.due(3.5, Some(3.0)), [pull]);
    }

    #[test]
    fn faulty_events_are_named() {
        let refusal = |text: &str| Scenario::parse(text).unwrap_err().to_string();
        for (text, words) in [
            ("[[event]]\nat_s = -1.0\ndo = \"slip\"", "event 1: at_s"),
            ("[[event]]\nat_s = 1.0\ndo = \"fly\"", "fly"),
            ("[[event]]\nat_s = 1.0\ndo = \"pull\"\nforce = 3.0", "force"),
            (
                "[[event]]\nat_s = 1.0\ndo = \"pull\"\nforce_n = nan\nseconds = 1.0",
                "a number",
            ),
            ("[events]\n", "events"),
        ] {
            let refusal = refusal(text);
            assert!(refusal.contains(words), "{text:?} gave {refusal:?}");
        }
    }
}
