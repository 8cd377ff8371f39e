//! Reading the keys of one segment table.

use serde_json::{Map, Value};

use crate::faults::Faults;
use crate::piecewise::Curve;
use crate::unit::Unit;

/// What a number must satisfy, and how to say so.
pub(crate) struct Rule {
    pub(crate) holds: fn(f64) -> bool,
    pub(crate) says: &'static str,
    pub(crate) cure: &'static str,
}

/// The positions that lists of a segment refer to.
pub(crate) enum Positions {
    /// There is no such key: every value is one number.
    Absent,
    /// Already reported; lists go unchecked.
    Faulty,
    /// In SI, strictly increasing.
    Given(Vec<f64>),
}

/// One segment table while it is read; faults go to `faults` under the name `place`.
pub(crate) struct Fields<'a> {
    pub(crate) place: String,
    pub(crate) table: &'a Map<String, Value>,
    pub(crate) unit: Unit,
    pub(crate) faults: &'a mut Faults,
}

impl Fields<'_> {
    /// Reports a fault of this segment.
    pub(crate) fn fault(&mut self, found: &str, rule: &str, cure: &str) {
        self.faults.add(&self.place, found, rule, cure);
    }

    /// Reports every key that is not one of `known`; one in another joint's unit gets that cure.
    pub(crate) fn only(&mut self, known: &[String]) {
        let table = self.table;
        for key in table.keys().filter(|key| !known.contains(key)) {
            match ["from", "to", "position"]
                .into_iter()
                .find(|stem| is_of_another_unit(key, stem, self.unit))
            {
                Some(stem) => self.wrong_unit(key, stem),
                None => self.fault(
                    &format!("unknown key {key}"),
                    &format!("the keys of this channel are {}", known.join(", ")),
                    "remove or rename it",
                ),
            }
        }
    }

    fn wrong_unit(&mut self, key: &str, stem: &str) {
        let right = self.unit.key(stem);
        let rule = format!("the type of this joint has positions in the unit of {right}");
        self.fault(
            &format!("key {key} is in the wrong unit"),
            &rule,
            &format!("give {right} in its place"),
        );
    }

    /// A position in SI under `stem` with the joint's suffix. Says nothing of a missing key where
    /// one in a wrong unit stands for it, which [`only`](Self::only) reports.
    pub(crate) fn position(&mut self, stem: &str) -> Option<f64> {
        let key = self.unit.key(stem);
        let table = self.table;
        let Some(value) = table.get(&key) else {
            if !table.keys().any(|k| is_of_another_unit(k, stem, self.unit)) {
                self.missing(&key, "say where the segment starts and ends");
            }
            return None;
        };
        self.finite(&key, value).map(|v| self.unit.to_si(v))
    }

    /// The list `position`, checked against the segment's ends where these are known.
    pub(crate) fn positions(&mut self, ends: Option<(f64, f64)>, tolerance: f64) -> Positions {
        let key = self.unit.key("position");
        let table = self.table;
        let Some(value) = table.get(&key) else {
            let elsewhere = table
                .keys()
                .any(|k| is_of_another_unit(k, "position", self.unit));
            return if elsewhere {
                Positions::Faulty
            } else {
                Positions::Absent
            };
        };
        let Value::Array(items) = value else {
            self.fault(
                &format!("{key} is {value}"),
                "it must be a list of numbers",
                "write it in brackets",
            );
            return Positions::Faulty;
        };
        let Some(list) = self.list(&key, items) else {
            return Positions::Faulty;
        };
        let si: Vec<f64> = list.iter().map(|&v| self.unit.to_si(v)).collect();
        let ordered = self.increasing(&key, &list);
        let inside = ends.is_none_or(|ends| self.inside(&key, &si, ends, tolerance));
        if ordered && inside {
            Positions::Given(si)
        } else {
            Positions::Faulty
        }
    }

    fn increasing(&mut self, key: &str, list: &[f64]) -> bool {
        let Some(i) = list.windows(2).position(|pair| pair[1] <= pair[0]) else {
            return true;
        };
        let found = format!(
            "{key}[{}] = {} does not lie above {key}[{i}] = {}",
            i + 1,
            list[i + 1],
            list[i]
        );
        self.fault(
            &found,
            "positions must be strictly increasing",
            "sort them and drop repeats",
        );
        false
    }

    fn inside(&mut self, key: &str, list: &[f64], (from, to): (f64, f64), tolerance: f64) -> bool {
        let Some(i) = list
            .iter()
            .position(|&p| p < from - tolerance || p > to + tolerance)
        else {
            return true;
        };
        let (unit, at) = (self.unit, list[i]);
        let found = format!("{key}[{i}] = {} is outside the segment", unit.show(at));
        let rule = format!(
            "positions must lie between {} and {}",
            unit.show(from),
            unit.show(to)
        );
        self.fault(&found, &rule, "drop it, or move the segment's ends");
        false
    }

    /// A value over the segment: a number, or a list as long as the positions.
    pub(crate) fn curve(&mut self, key: &str, positions: &Positions, rule: &Rule) -> Option<Curve> {
        let table = self.table;
        match table.get(key) {
            None => {
                self.missing(
                    key,
                    "give a number, or a list with one value for each position",
                );
                None
            }
            Some(Value::Array(items)) => {
                let list = self.list(key, items)?;
                let obeyed = self.all_obey(key, &list, rule);
                let position = self.matching(key, &list, positions)?;
                obeyed.then(|| Curve::new(position, list))
            }
            Some(value) => {
                let value = self.finite(key, value)?;
                if (rule.holds)(value) {
                    return Some(Curve::constant(value));
                }
                self.fault(&format!("{key} is {value}"), rule.says, rule.cure);
                None
            }
        }
    }

    fn all_obey(&mut self, key: &str, list: &[f64], rule: &Rule) -> bool {
        let Some(i) = list.iter().position(|&v| !(rule.holds)(v)) else {
            return true;
        };
        self.fault(&format!("{key}[{i}] is {}", list[i]), rule.says, rule.cure);
        false
    }

    fn matching(&mut self, key: &str, list: &[f64], positions: &Positions) -> Option<Vec<f64>> {
        let position_key = self.unit.key("position");
        match positions {
            Positions::Faulty => None,
            Positions::Given(position) if position.len() == list.len() => Some(position.clone()),
            Positions::Given(position) => {
                let found = format!(
                    "{key} has {} values and {position_key} has {}",
                    list.len(),
                    position.len()
                );
                self.fault(
                    &found,
                    "both lists must have one length",
                    "give one value for each position",
                );
                None
            }
            Positions::Absent => {
                let cure = format!("add {position_key}, or give {key} as one number");
                self.fault(
                    &format!("{key} is a list of {} without {position_key}", list.len()),
                    "a list needs positions",
                    &cure,
                );
                None
            }
        }
    }

    fn list(&mut self, key: &str, items: &[Value]) -> Option<Vec<f64>> {
        if items.is_empty() {
            self.fault(
                &format!("{key} is an empty list"),
                "it must hold one number at least",
                "fill it or remove the key",
            );
            return None;
        }
        // Every entry is looked at, so that all faults come out in one run.
        let numbers: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(i, item)| self.finite(&format!("{key}[{i}]"), item))
            .collect();
        numbers.into_iter().collect()
    }

    fn finite(&mut self, key: &str, value: &Value) -> Option<f64> {
        // JSON has no nan or inf: a TOML one arrives as null.
        if let Some(number) = value.as_f64().filter(|&number| (number as f32).is_finite()) {
            return Some(number);
        }
        let shown = if value.is_null() {
            "nan or inf".to_owned()
        } else {
            value.to_string()
        };
        self.fault(
            &format!("{key} is {shown}"),
            "it must be a finite number (single precision)",
            "put a number there",
        );
        None
    }

    fn missing(&mut self, key: &str, cure: &str) {
        self.fault(
            &format!("{key} is missing"),
            "every segment of this channel needs it",
            cure,
        );
    }
}

fn is_of_another_unit(key: &str, stem: &str, unit: Unit) -> bool {
    key != unit.key(stem) && Unit::ALL.into_iter().any(|other| other.key(stem) == key)
}
