//! Segments as the lines of their tables.

use std::collections::HashMap;

use super::{EditError, StateUnit};
use crate::{Channel, Segment, Values};

const FORCE_DECIMALS: usize = 2;
const PROBABILITY_DECIMALS: usize = 3;

/// Ends of the range are given by the joint and must be met to a millionth of the range.
const LIMIT_DECIMALS: usize = 9;

/// The lines of each segment that is left after rounding.
pub(super) fn tables(unit: StateUnit, segments: &[Segment]) -> Result<Vec<Vec<String>>, EditError> {
    if segments.is_empty() {
        return Err(EditError::NoSegments);
    }
    segments.iter().try_for_each(check)?;
    let tables = segments.iter().zip(ends(unit, segments));
    Ok(tables
        .filter(|(_, (from, to))| from.value < to.value)
        .map(|(segment, ends)| table(unit, segment, ends))
        .collect())
}

/// One line of a comment; control characters, which TOML forbids there, become spaces.
pub(super) fn comment(line: &str) -> String {
    let line: String = line
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    format!("# {line}").trim_end().to_owned()
}

/// A number as it is written, and what it is when read again.
#[derive(Debug, Clone, PartialEq)]
struct Decimal {
    text: String,
    value: f64,
}

impl Decimal {
    /// `value` with at most so many digits after the point, and one at least.
    fn new(value: f64, decimals: usize) -> Self {
        let mut text = format!("{value:.decimals$}");
        text.truncate(text.trim_end_matches('0').len());
        if text.ends_with('.') {
            text.push('0');
        }
        if text == "-0.0" {
            text.remove(0);
        }
        let value = text.parse().unwrap_or(value);
        Self { text, value }
    }

    fn clamped(self, from: &Self, to: &Self) -> Self {
        match self {
            low if low.value <= from.value => from.clone(),
            high if high.value >= to.value => to.clone(),
            inside => inside,
        }
    }
}

/// Where each segment starts and ends once rounded: neighbours share their boundary, and the
/// outermost ends of an action and channel keep their digits. Some may have no length.
fn ends(unit: StateUnit, segments: &[Segment]) -> Vec<(Decimal, Decimal)> {
    let limit = |state: f64| Decimal::new(unit.from_si(state), LIMIT_DECIMALS);
    let mut ranges: HashMap<_, (Decimal, Decimal)> = HashMap::new();
    for segment in segments {
        let (from, to) = (limit(segment.from), limit(segment.to));
        let range = ranges.entry((&segment.action, segment.channel));
        let range = range.or_insert_with(|| (from.clone(), to.clone()));
        if from.value < range.0.value {
            range.0 = from;
        }
        if to.value > range.1.value {
            range.1 = to;
        }
    }
    let boundary = |state: f64, range: &(Decimal, Decimal)| {
        // Two digits more first: neighbours that differ by a rounding error agree on a half.
        let nearly = Decimal::new(unit.from_si(state), LIMIT_DECIMALS).value;
        Decimal::new(nearly, unit.decimals()).clamped(&range.0, &range.1)
    };
    let both = |segment: &Segment| {
        let range = &ranges[&(&segment.action, segment.channel)];
        let written = |state: f64| match limit(state) {
            end if end == range.0 || end == range.1 => end,
            _ => boundary(state, range),
        };
        (written(segment.from), written(segment.to))
    };
    segments.iter().map(both).collect()
}

fn table(unit: StateUnit, segment: &Segment, (from, to): (Decimal, Decimal)) -> Vec<String> {
    let name = toml_edit::Value::from(segment.action.as_str()).to_string();
    let mut lines: Vec<String> = segment
        .note
        .iter()
        .flat_map(|n| n.lines().map(comment))
        .collect();
    lines.push("[[observation.segment]]".to_owned());
    lines.push(format!("action = {name}"));
    lines.push(format!("channel = \"{}\"", segment.channel.name()));
    lines.push(format!("{} = {}", unit.key("from"), from.text));
    lines.push(format!("{} = {}", unit.key("to"), to.text));
    match &segment.values {
        Values::Moves { probability } => {
            let probability = Decimal::new(*probability, PROBABILITY_DECIMALS);
            lines.push(format!("probability = {}", probability.text));
        }
        Values::Force {
            position,
            mean_n,
            sigma_n,
        } => {
            let at = |&state: &f64| match state {
                state if state <= segment.from => from.clone(),
                state if state >= segment.to => to.clone(),
                state => Decimal::new(unit.from_si(state), unit.decimals()).clamped(&from, &to),
            };
            let (kept, places) = increasing(position.iter().map(at));
            let means: Vec<_> = kept.iter().map(|&i| force(mean_n[i])).collect();
            let sigmas = if sigma_n.len() == 1 {
                vec![sigma(sigma_n[0])]
            } else {
                kept.iter().map(|&i| sigma(sigma_n[i])).collect()
            };
            lines.push(format!("sigma_n = {}", number_or_list(&sigmas)));
            if places.len() > 1 {
                lines.push(format!("{} = {}", unit.key("position"), list(&places)));
            }
            lines.push(format!("mean_n = {}", number_or_list(&means)));
        }
    }
    lines
}

/// Those that lie above all before them, and their indices.
fn increasing(places: impl Iterator<Item = Decimal>) -> (Vec<usize>, Vec<String>) {
    let mut highest = f64::NEG_INFINITY;
    let risen = places.enumerate().filter(|(_, place)| {
        let rises = place.value > highest;
        highest = highest.max(place.value);
        rises
    });
    risen.map(|(index, place)| (index, place.text)).unzip()
}

fn force(value: f64) -> String {
    Decimal::new(value, FORCE_DECIMALS).text
}

/// A sigma never rounds to 0, which would make every other force impossible.
fn sigma(value: f64) -> String {
    force(value.max(0.01))
}

fn number_or_list(values: &[String]) -> String {
    match values {
        [one] => one.clone(),
        several => list(several),
    }
}

fn list(values: &[String]) -> String {
    format!("[{}]", values.join(", "))
}

fn check(segment: &Segment) -> Result<(), EditError> {
    let fault = match &segment.values {
        _ if !(segment.from < segment.to && (segment.to - segment.from).is_finite()) => {
            Some("it must end above its start")
        }
        Values::Moves { .. } if segment.channel != Channel::Moves => {
            Some("a probability belongs to m_p")
        }
        Values::Moves { probability } if !(0.0..=1.0).contains(probability) => {
            Some("a probability lies between 0 and 1")
        }
        Values::Moves { .. } => None,
        Values::Force { .. } if segment.channel == Channel::Moves => {
            Some("m_p has a probability, no force")
        }
        Values::Force {
            position,
            mean_n,
            sigma_n,
        } => force_fault(position, mean_n, sigma_n),
    };
    let Some(fault) = fault else { return Ok(()) };
    Err(EditError::Segment {
        action: segment.action.clone(),
        channel: segment.channel.name(),
        from: segment.from,
        to: segment.to,
        fault,
    })
}

fn force_fault(position: &[f64], mean_n: &[f64], sigma_n: &[f64]) -> Option<&'static str> {
    let count = position.len();
    if count == 0 || mean_n.len() != count || ![1, count].contains(&sigma_n.len()) {
        return Some("it needs one mean for each position, and one sigma for each or for all");
    }
    let increasing = position.windows(2).all(|pair| pair[0] < pair[1]);
    if !increasing || !position.iter().chain(mean_n).all(|value| value.is_finite()) {
        return Some("positions must increase, and means must be finite");
    }
    let positive = sigma_n
        .iter()
        .all(|&sigma| sigma > 0.0 && sigma.is_finite());
    (!positive).then_some("sigma must be above 0")
}
