//! Segments read back from an `[observation]` table.

use serde_json::{Map, Value};

use super::StateUnit;
use crate::{Channel, Segment, Values};

/// Why a segment cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("segment[{index}]: {fault}")]
pub struct ReadError {
    /// Its place in the list, from 0.
    pub index: usize,
    /// What is wrong, with its key.
    pub fault: String,
}

/// The segments of an `[observation]` table, in its order, states in rad or m; none where it has
/// no `segment`. Notes, being comments, are not read.
///
/// # Errors
/// For the first segment with a missing, misspelt or unfitting value.
pub fn segments_of(observation: &Value, unit: StateUnit) -> Result<Vec<Segment>, ReadError> {
    let tables = observation.get("segment").and_then(Value::as_array);
    let tables = tables.map(Vec::as_slice).unwrap_or_default();
    let read = |(index, table): (usize, &Value)| {
        let fields = table.as_object().ok_or("it is no table".to_owned());
        let segment = fields.and_then(|table| segment(&Fields { table, unit }));
        segment.map_err(|fault| ReadError { index, fault })
    };
    tables.iter().enumerate().map(read).collect()
}

fn segment(fields: &Fields) -> Result<Segment, String> {
    let name = fields.text("channel")?;
    let channel = [Channel::FORCES.as_slice(), &[Channel::Moves]]
        .concat()
        .into_iter()
        .find(|channel| channel.name() == name)
        .ok_or(format!("channel is \"{name}\", no component"))?;
    let (from, to) = (fields.state("from")?, fields.state("to")?);
    let values = if channel == Channel::Moves {
        let probability = fields.number("probability")?;
        Values::Moves { probability }
    } else {
        fields.force(from)?
    };
    Ok(Segment {
        action: fields.text("action")?.to_owned(),
        channel,
        from,
        to,
        values,
        note: None,
    })
}

struct Fields<'a> {
    table: &'a Map<String, Value>,
    unit: StateUnit,
}

impl Fields<'_> {
    fn text(&self, key: &str) -> Result<&str, String> {
        let text = self.table.get(key).and_then(Value::as_str);
        text.ok_or(format!("{key} must be a name"))
    }

    fn number(&self, key: &str) -> Result<f64, String> {
        let number = self.table.get(key).and_then(Value::as_f64);
        number.ok_or(format!("{key} must be a number"))
    }

    fn state(&self, stem: &str) -> Result<f64, String> {
        let number = self.number(&self.unit.key(stem))?;
        Ok(self.unit.to_si(number))
    }

    /// A list, or a number as a list of one.
    fn list(&self, key: &str) -> Result<Vec<f64>, String> {
        let value = self.table.get(key).unwrap_or(&Value::Null);
        let items = value
            .as_array()
            .map_or(std::slice::from_ref(value), Vec::as_slice);
        let numbers: Option<Vec<f64>> = items.iter().map(Value::as_f64).collect();
        let filled = numbers.filter(|numbers| !numbers.is_empty());
        filled.ok_or(format!("{key} must be a number or a list of numbers"))
    }

    /// Mean and sigma; a mean that is one number holds at every position, or from the start on.
    fn force(&self, from: f64) -> Result<Values, String> {
        let key = self.unit.key("position");
        let position = if self.table.contains_key(&key) {
            let listed = self.list(&key)?;
            listed
                .into_iter()
                .map(|state| self.unit.to_si(state))
                .collect()
        } else {
            vec![from]
        };
        let (mut mean_n, sigma_n) = (self.list("mean_n")?, self.list("sigma_n")?);
        if mean_n.len() == 1 {
            mean_n = vec![mean_n[0]; position.len()];
        }
        if mean_n.len() != position.len() || ![1, position.len()].contains(&sigma_n.len()) {
            return Err(format!("{key}, mean_n and sigma_n must be of one length"));
        }
        Ok(Values::Force {
            position,
            mean_n,
            sigma_n,
        })
    }
}
