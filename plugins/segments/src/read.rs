//! From the `[observation]` table to checked segments.

use pubs_plugin::{ModelSetup, PluginError};
use serde_json::{Map, Value};

use crate::channel;
use crate::cover::{self, Unplaced};
use crate::faults::Faults;
use crate::fields::{Fields, Positions, Rule};
use crate::piecewise::{Curve, Segment};
use crate::unit::Unit;

const ANY_FORCE: Rule = Rule {
    holds: |_| true,
    says: "",
    cure: "",
};
const POSITIVE: Rule = Rule {
    holds: |sigma| sigma as f32 > 0.0,
    says: "it must be greater than 0",
    cure: "put the standard deviation of the force, N",
};
const PROBABILITY: Rule = Rule {
    holds: |p| (0.0..=1.0).contains(&p),
    says: "it must lie between 0 and 1",
    cure: "put the fraction of updates in which the handle moved",
};

/// Reads and checks every segment.
///
/// # Errors
/// One error that names all faults, a line for each: place, what was found, rule, cure.
pub(crate) fn segments(setup: &ModelSetup) -> Result<Vec<Segment>, PluginError> {
    let mut faults = Faults::default();
    let mut reader = Reader {
        setup,
        unit: Unit::of(setup.joint.r#type),
        faults: &mut faults,
    };
    reader.params();
    let mut segments = Vec::new();
    let mut unplaced = Vec::new();
    if let Some(tables) = reader.tables() {
        for (index, table) in tables.iter().enumerate() {
            match reader.segment(index, table) {
                Ok(segment) => segments.push(segment),
                Err(place) => unplaced.push(place),
            }
        }
        cover::check(setup, &segments, &unplaced, &mut faults);
    }
    faults.or_value(segments)
}

struct Reader<'a> {
    setup: &'a ModelSetup,
    unit: Unit,
    faults: &'a mut Faults,
}

impl<'a> Reader<'a> {
    fn params(&mut self) {
        let params = self.setup.observation.get("params");
        if let Some(params) =
            params.filter(|params| params.as_object().is_none_or(|map| !map.is_empty()))
        {
            self.faults.add(
                "params",
                &format!("found {params}"),
                "this model has no parameters",
                "remove it",
            );
        }
    }

    fn tables(&mut self) -> Option<&'a [Value]> {
        let (found, rule) = match self.setup.observation.get("segment") {
            Some(Value::Array(tables)) => return Some(tables),
            Some(_) => ("it is no list", "it must be a list of tables"),
            None => ("it is missing", "the model is made of segments"),
        };
        let cure = "write [[observation.segment]] tables, by hand or with `pubs-engine calibrate`";
        self.faults.add("segment", found, rule, cure);
        None
    }

    /// One segment, or what is known of its place; its faults are reported.
    fn segment(&mut self, index: usize, value: &Value) -> Result<Segment, Unplaced> {
        let place = format!("segment[{index}]");
        let Some(table) = value.as_object() else {
            self.faults.add(
                &place,
                &format!("it is {value}"),
                "it must be a table",
                "write it as [[observation.segment]]",
            );
            return Err(Unplaced::default());
        };
        let name_of = |key| table.get(key).and_then(Value::as_str).unwrap_or("?");
        let place = format!("{place} ({}, {})", name_of("action"), name_of("channel"));
        let action = self.action(&place, table);
        let channel = self.channel(&place, table);
        let tolerance = cover::tolerance(&self.setup.joint);
        let unplaced = Unplaced { action, channel };
        let mut fields = Fields {
            place,
            table,
            unit: self.unit,
            faults: self.faults,
        };
        let channel = channel.ok_or(unplaced)?;
        fields.only(&known_keys(channel, self.unit));
        let (from, to, curves) = body(&mut fields, channel, tolerance).ok_or(unplaced)?;
        let (mean, sigma) = curves;
        Ok(Segment {
            index,
            action: action.ok_or(unplaced)?,
            channel,
            from,
            to,
            mean,
            sigma,
        })
    }

    fn action(&mut self, place: &str, table: &Map<String, Value>) -> Option<usize> {
        let actions = &self.setup.actions;
        let named = name(table, "action");
        let found = actions
            .iter()
            .position(|action| table.get("action").and_then(Value::as_str) == Some(&action.name));
        let movements = || {
            actions
                .iter()
                .filter(|a| !a.stop)
                .map(|a| a.name.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        };
        match found {
            None => {
                self.faults.add(
                    place,
                    &named,
                    "it must be a movement action of the object",
                    &format!("name one of {}", movements()),
                );
                None
            }
            Some(index) if actions[index].stop => {
                self.faults.add(
                    place,
                    &named,
                    "an action that stops has no observation model",
                    "remove the segment",
                );
                None
            }
            found => found,
        }
    }

    fn channel(&mut self, place: &str, table: &Map<String, Value>) -> Option<usize> {
        let wanted = table.get("channel").and_then(Value::as_str);
        let found = channel::NAMES.iter().position(|&name| Some(name) == wanted);
        if found.is_none() {
            let cure = format!("name one of {}", channel::NAMES.join(", "));
            self.faults.add(
                place,
                &name(table, "channel"),
                "it must be a component of the observation",
                &cure,
            );
        }
        found
    }
}

/// How a fault shows the value of a key that names something.
fn name(table: &Map<String, Value>, key: &str) -> String {
    table.get(key).map_or_else(
        || format!("{key} is missing"),
        |value| format!("{key} is {value}"),
    )
}

fn known_keys(channel: usize, unit: Unit) -> Vec<String> {
    let values: &[&str] = if channel == channel::MOTION {
        &["probability"]
    } else {
        &["mean_n", "sigma_n"]
    };
    let names = ["action", "channel"]
        .iter()
        .chain(values)
        .map(|&key| key.to_owned());
    names
        .chain(["from", "to", "position"].map(|stem| unit.key(stem)))
        .collect()
}

/// Ends, mean and sigma of a segment whose channel is known; all faults are reported.
fn body(
    fields: &mut Fields<'_>,
    channel: usize,
    tolerance: f64,
) -> Option<(f64, f64, (Curve, Curve))> {
    let ends = ends(fields);
    let positions = fields.positions(ends, tolerance);
    let curves = if channel == channel::MOTION {
        fields
            .curve("probability", &positions, &PROBABILITY)
            .zip(Some(Curve::constant(1.0)))
    } else {
        let mean = fields.curve("mean_n", &positions, &ANY_FORCE);
        let sigma = fields.curve("sigma_n", &positions, &POSITIVE);
        mean.zip(sigma)
    };
    let curves = curves?;
    unused_positions(fields, &positions);
    let (from, to) = ends?;
    Some((from, to, curves))
}

fn ends(fields: &mut Fields<'_>) -> Option<(f64, f64)> {
    let from = fields.position("from");
    let to = fields.position("to");
    let (from, to) = from.zip(to)?;
    if from < to {
        return Some((from, to));
    }
    let (from_key, to_key, unit) = (fields.unit.key("from"), fields.unit.key("to"), fields.unit);
    let found = format!(
        "{from_key} is {} and {to_key} is {}",
        unit.show(from),
        unit.show(to)
    );
    fields.fault(
        &found,
        "a segment must end above its start",
        "swap or correct the ends",
    );
    None
}

fn unused_positions(fields: &mut Fields<'_>, positions: &Positions) {
    let key = fields.unit.key("position");
    let lists = ["mean_n", "sigma_n", "probability"]
        .into_iter()
        .filter_map(|key| fields.table.get(key));
    if matches!(positions, Positions::Given(_)) && !lists.into_iter().any(Value::is_array) {
        let found = format!("{key} is there, but no value is a list");
        fields.fault(
            &found,
            "positions need a list of values",
            &format!("remove {key}, or give one value for each position"),
        );
    }
}
