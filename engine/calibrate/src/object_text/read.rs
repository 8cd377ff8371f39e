//! The segments that an object file holds.

use serde_json::Value;

use super::StateUnit;
use crate::segment::{Channel, Segment, Values};

/// A segment that is not what `calibrate` writes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("observation.segment[{index}]: {reason}; `pubs-engine check` shows it at its line")]
pub struct SegmentError {
    /// Which one, from 0.
    pub index: usize,
    /// What is missing or wrong.
    pub reason: String,
}

/// The segments of an `[observation]` table, states in SI; none where the table has none.
///
/// # Errors
/// Where a segment lacks a key.
pub fn segments_of(observation: &Value, unit: StateUnit) -> Result<Vec<Segment>, SegmentError> {
    let tables = observation.get("segment").and_then(Value::as_array);
    tables
        .into_iter()
        .flatten()
        .enumerate()
        .map(|(index, table)| segment(table, unit).map_err(|reason| SegmentError { index, reason }))
        .collect()
}

fn segment(table: &Value, unit: StateUnit) -> Result<Segment, String> {
    let text = |key: &str| {
        let found = table.get(key).and_then(Value::as_str);
        found
            .map(str::to_owned)
            .ok_or_else(|| format!("`{key}` is missing"))
    };
    let state = |stem: &str| {
        let key = format!("{stem}_{}", unit.suffix());
        let found = table.get(&key).and_then(Value::as_f64);
        found
            .map(|found| found / unit.per_si())
            .ok_or_else(|| format!("`{key}` is missing"))
    };
    let channel = text("channel")?;
    let channel = Channel::ALL
        .into_iter()
        .find(|known| known.name() == channel)
        .ok_or_else(|| format!("channel `{channel}` is not one of an arm"))?;
    let (from, to) = (state("from")?, state("to")?);
    let key = format!("position_{}", unit.suffix());
    let position = match numbers(table, &key) {
        Some(position) => position.into_iter().map(|at| at / unit.per_si()).collect(),
        None => vec![0.5 * (from + to)],
    };
    let needed = |key: &str| numbers(table, key).ok_or_else(|| format!("`{key}` is missing"));
    let values = if channel == Channel::Moves {
        let shares = needed("probability")?;
        Values::Moves {
            probability: shares.iter().sum::<f64>() / shares.len().max(1) as f64,
        }
    } else {
        let mean_n = needed("mean_n")?;
        Values::Force {
            mean_n: if mean_n.len() == 1 {
                vec![mean_n[0]; position.len()]
            } else {
                mean_n
            },
            sigma_n: needed("sigma_n")?,
            position,
        }
    };
    Ok(Segment {
        action: text("action")?,
        channel,
        from,
        to,
        values,
        note: None,
    })
}

/// One number or a list of them.
fn numbers(table: &Value, key: &str) -> Option<Vec<f64>> {
    match table.get(key)? {
        Value::Array(list) => list.iter().map(Value::as_f64).collect(),
        one => Some(vec![one.as_f64()?]),
    }
}
