//! Rules between keys. Each looks only at values that are right by themselves, so that all
//! rules can be checked at once with the rest.

mod actions;
mod directions;
mod limits;
mod rates;
mod stop_force;

use figment::value::{Dict, Value};

use super::check::number;
use super::fault::Fault;
use super::layers::{Merged, Origin, defaults_for};
use super::places::{Part, Places};

/// Keys that the filter "rao_blackwell" alone uses.
pub(super) const FORCE_BIAS: [&str; 3] = [
    "belief.offset_sd_n",
    "belief.offset_walk_n",
    "belief.friction_sd_n",
];

/// Checks every rule. `at_fault` are the faults of single values.
pub(super) fn check(merged: &Merged, places: &Places, at_fault: &[Fault]) -> Vec<Fault> {
    let mut rules = Rules {
        merged,
        places,
        at_fault,
        faults: Vec::new(),
    };
    source(&mut rules);
    force_bias(&mut rules);
    limits::check(&mut rules);
    directions::check(&mut rules);
    actions::check(&mut rules);
    rates::check(&mut rules);
    stop_force::check(&mut rules);
    rules.faults
}

struct Rules<'a> {
    merged: &'a Merged,
    places: &'a Places,
    at_fault: &'a [Fault],
    faults: Vec<Fault>,
}

impl Rules<'_> {
    /// The value at a path, if it is there and nothing is wrong with it.
    fn value(&self, path: &str) -> Option<&Value> {
        let below = format!("{path}.");
        let wrong = |fault: &Fault| fault.key == path || fault.key.starts_with(&below);
        if self.at_fault.iter().any(wrong) {
            return None;
        }
        lookup(&self.merged.values, path)
    }

    fn number(&self, path: &str) -> Option<f64> {
        self.value(path).and_then(number)
    }

    fn numbers<const N: usize>(&self, path: &str) -> Option<[f64; N]> {
        let list = self.value(path)?.as_array()?;
        let numbers: Option<Vec<f64>> = list.iter().map(number).collect();
        numbers?.try_into().ok()
    }

    fn text(&self, path: &str) -> Option<&str> {
        self.value(path)?.as_str()
    }

    fn flag(&self, path: &str) -> Option<bool> {
        self.value(path)?.to_bool()
    }

    /// The first of these keys whose value is not the engine's default: the one that its author
    /// can see and mend. The first where all are defaults.
    fn stated<'k>(&self, keys: &[&'k str]) -> &'k str {
        let stated = |key: &&&str| self.places.origins.get(**key) != Some(&Origin::Default);
        keys.iter()
            .find(stated)
            .or(keys.first())
            .copied()
            .unwrap_or_default()
    }

    /// Whether the command line or the environment gave the value.
    fn is_typed(&self, key: &str) -> bool {
        let origin = self.places.origins.get(key);
        origin.and_then(Origin::typed).is_some()
    }

    fn fault(&mut self, key: &str, message: impl Into<String>, help: impl Into<String>) {
        self.faults
            .push(self.places.fault(key, Part::Value, message, help));
    }
}

fn lookup<'v>(values: &'v Dict, path: &str) -> Option<&'v Value> {
    let mut parts = path.split('.');
    let mut value = values.get(parts.next()?)?;
    for part in parts {
        value = match value {
            Value::Dict(_, inner) => inner.get(part)?,
            Value::Array(_, list) => list.get(part.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    Some(value)
}

/// Numbers that a sensor gave fit no other sensor, so the file says which.
fn source(rules: &mut Rules<'_>) {
    let arm = rules.value("control").is_some();
    let from_sensor = matches!(rules.text("source.kind"), Some("measured" | "virtual"));
    let named = lookup(&rules.merged.values, "source.sensor").is_some();
    if arm && from_sensor && !named {
        rules.fault(
            "source.sensor",
            "`source.sensor` is missing, and the numbers are not assumed",
            "add `sensor = \"…\"` to [source], as the driver reports it; a driver with another sensor is refused",
        );
    }
}

/// Only an arm's sensor has a bias, and only one filter uses what is said of it.
fn force_bias(rules: &mut Rules<'_>) {
    let Some(filter) = rules.text("belief.filter").map(str::to_owned) else {
        return;
    };
    if filter == "rao_blackwell" {
        if rules.text("joint.type") == Some("abstract") {
            rules.fault(
                "belief.filter",
                "`belief.filter` is \"rao_blackwell\", which estimates what an arm's force sensor is off by, and an abstract object has none",
                "the filter of an abstract object is \"sis\"",
            );
        }
        return;
    }
    for key in FORCE_BIAS {
        // The keys of a file stay where its filter is overridden, for a comparison.
        let left_over = rules.is_typed("belief.filter") && !rules.is_typed(key);
        if left_over || rules.places.origins.get(key) == Some(&Origin::Default) {
            continue;
        }
        // A default may be stated, as where the whole of [belief] was copied.
        let default = lookup(&defaults_for(None), key).and_then(number);
        if rules
            .number(key)
            .is_some_and(|value| Some(value) != default)
        {
            rules.fault(
                key,
                format!(
                    "`{key}` is stated, but `belief.filter` is \"{filter}\", which does not use it"
                ),
                "let belief.filter be \"rao_blackwell\", or leave the key out",
            );
        }
    }
}
