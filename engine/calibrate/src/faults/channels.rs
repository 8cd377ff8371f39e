//! Force channels that do not follow the force.

use std::ops::Range;

use pubs_run::recording::Frame;

use super::{Checker, Severity, seconds};
use crate::column::Column;

/// A channel is saturated where its extreme value stands in so many rows on end,
const SATURATED_ROWS: usize = 5;
/// and is larger than this, N.
const SATURATED_N: f64 = 5.0;
/// It is stuck where it stands still for so long while the arm moves, s.
const STUCK_S: f64 = 1.0;
/// In a recording of so many rows a channel cannot be zero throughout.
const DEAD_ROWS: usize = 100;

pub(super) fn check(checker: &mut Checker<'_>) {
    for axis in 0..3 {
        check_channel(checker, axis);
    }
}

fn check_channel(checker: &mut Checker<'_>, axis: usize) {
    let frames = checker.frames();
    let column = Column::Force(axis);
    let force = |row: usize| frames[row].reading.force_n[axis];
    let values = || (0..frames.len()).map(force);
    if frames.len() >= DEAD_ROWS && values().all(|value| value == 0.0) {
        let place = checker.source.cell(frames, 0, column);
        let found = "the force is 0 in every row".to_owned();
        let cure = "see whether the sensor gives this axis";
        checker.add(Severity::Warning, place, found, "a force that varies", cure);
        return;
    }
    let extremes = [
        values().fold(f64::INFINITY, f64::min),
        values().fold(f64::NEG_INFINITY, f64::max),
    ];
    let (mut saturated, mut stuck) = (Vec::new(), Vec::new());
    for run in runs(frames, axis) {
        let value = force(run.start);
        if run.len() >= SATURATED_ROWS && extremes.contains(&value) && value.abs() > SATURATED_N {
            saturated.push(run);
        } else if value != 0.0 && is_stuck(&frames[run.clone()]) {
            stuck.push(run);
        }
    }
    tell(
        checker,
        column,
        &saturated,
        "forces within the range of the sensor",
        "the channel is saturated: record with a larger range of the sensor, or more gently",
    );
    tell(
        checker,
        column,
        &stuck,
        "a force that varies while the arm moves",
        "the channel is stuck: see whether the sensor was read at every period, and record again",
    );
}

/// Tells of the first run, and how many there are.
fn tell(checker: &mut Checker<'_>, column: Column, runs: &[Range<usize>], rule: &str, cure: &str) {
    let Some(first) = runs.first() else { return };
    let frames = checker.frames();
    let value = column.number(&frames[first.start]).unwrap_or(f64::NAN);
    let others = match runs.len() - 1 {
        0 => String::new(),
        more => format!(", and so in {more} more places"),
    };
    let found = format!("{value} N stands in {} rows on end{others}", first.len());
    let place = checker.source.cell(frames, first.start, column);
    checker.add(Severity::Fault, place, found, rule, cure);
}

/// Rows on end with the same finite force.
fn runs(frames: &[Frame], axis: usize) -> Vec<Range<usize>> {
    let force = |row: usize| frames[row].reading.force_n[axis];
    let mut runs: Vec<Range<usize>> = Vec::new();
    for row in (0..frames.len()).filter(|&row| force(row).is_finite()) {
        match runs.last_mut() {
            Some(run) if run.end == row && force(run.start) == force(row) => run.end += 1,
            _ => runs.push(row..row + 1),
        }
    }
    runs
}

fn is_stuck(run: &[Frame]) -> bool {
    let [first, .., last] = run else { return false };
    let moving = run.iter().filter(|frame| frame.speed_m_s != 0.0).count();
    seconds(first, last) >= STUCK_S && 2 * moving > run.len()
}
