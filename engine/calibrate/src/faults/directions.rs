//! Whether the force columns are what they say, told from where the arm was blocked.
//!
//! A safe action stops where the force along the motion passes `force_threshold_n`. Where the arm
//! wanted to move and was at rest, that force must therefore be there; a column that holds it in
//! its stead, or its negative, shows columns that were swapped or have the other sign.

use std::ops::Range;

use pubs_core::joint::{Direction, Path};
use pubs_core::observation::ArmObservation;

use super::{Checker, Severity, pose, seconds};
use crate::column::Column;

/// The arm must have been blocked for so long, s.
const BLOCKED_S: f64 = 0.2;
/// Of the threshold, this much must be there: the force falls a little once the arm rests.
const SHARE: f64 = 0.7;

/// What is wrong with a place where the arm was blocked.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Verdict {
    Reversed,
    /// Another axis of the tool holds the force, N.
    Elsewhere {
        axis: usize,
        force_n: f64,
    },
    Nowhere,
}

/// A place where the arm was blocked and the force along the motion is not there.
struct Wrong {
    row: usize,
    verdict: Verdict,
    /// Axis of the tool that points along the motion most.
    expected_axis: usize,
    along_n: f64,
    /// Median force of that axis, N.
    axis_n: f64,
}

pub(super) fn check(checker: &mut Checker<'_>, sound: &[bool]) {
    let frames = checker.frames();
    let grasp = sound
        .iter()
        .position(|&sound| sound)
        .map(|row| &frames[row]);
    let path = grasp.and_then(|grasp| Path::at_grasp(&checker.task.joint, &pose(grasp)));
    let (Some(path), Some(control)) = (path, checker.task.control) else {
        return;
    };
    let least_n = SHARE * control.force_threshold_n;
    let blocked = blocked(checker, sound);
    let wrong: Vec<Wrong> = blocked
        .iter()
        .filter_map(|run| judge(checker, run, &path, least_n))
        .collect();
    let Some(first) = wrong.first() else { return };
    let severity = if 2 * wrong.len() > blocked.len() {
        Severity::Fault
    } else {
        Severity::Warning
    };
    let expected = Column::Force(first.expected_axis).name();
    let Wrong {
        along_n, axis_n, ..
    } = first;
    let (found, cure) = match first.verdict {
        Verdict::Reversed => (
            format!("{along_n:.1} N along the motion"),
            "the sign is reversed: a force by the tool on the object is positive along the motion; turn the signs of the force columns".to_owned(),
        ),
        Verdict::Elsewhere { axis, force_n } => (
            format!("{along_n:.1} N along the motion ({expected}: {axis_n:.1} N)"),
            format!(
                "{} seems to hold it, with {force_n:.1} N: are the columns swapped, or `opening_direction` wrong?",
                Column::Force(axis).name()
            ),
        ),
        Verdict::Nowhere => (
            format!("{along_n:.1} N along the motion, and as little along any axis"),
            "see whether forces are in newtons and the sensor was tared, and whether `force_threshold_n` is that of the recording".to_owned(),
        ),
    };
    let found = format!(
        "{found} while the arm was blocked, in {} of {} such places",
        wrong.len(),
        blocked.len()
    );
    let rule = format!(
        "about `force_threshold_n`, {} N, or more",
        control.force_threshold_n
    );
    let place = checker
        .source
        .cell(frames, first.row, Column::Force(first.expected_axis));
    checker.add(severity, place, found, rule, cure);
}

/// Rows on end at which a safe action wanted to move and the arm rested.
fn blocked(checker: &Checker<'_>, sound: &[bool]) -> Vec<Range<usize>> {
    let frames = checker.frames();
    let is_blocked = |row: usize| {
        let frame = &frames[row];
        let action = checker
            .action(frame)
            .map(|index| &checker.task.actions[index]);
        let safe = action.is_some_and(|action| !action.is_stop() && !action.is_high_force());
        sound[row] && safe && frame.settled && frame.speed_m_s == 0.0
    };
    let mut runs: Vec<Range<usize>> = Vec::new();
    for row in (0..frames.len()).filter(|&row| is_blocked(row)) {
        match runs.last_mut() {
            Some(run) if run.end == row && frames[run.start].action == frames[row].action => {
                run.end += 1;
            }
            _ => runs.push(row..row + 1),
        }
    }
    runs.retain(|run| seconds(&frames[run.start], &frames[run.end - 1]) >= BLOCKED_S);
    runs
}

/// What is wrong there, if anything is.
fn judge(checker: &Checker<'_>, run: &Range<usize>, path: &Path, least_n: f64) -> Option<Wrong> {
    let frames = &checker.frames()[run.clone()];
    let action = &checker.task.actions[checker.action(&frames[0])?];
    let direction = Direction::of(action.sign());
    let along_n = median(frames.iter().map(|frame| {
        ArmObservation::new(path, &pose(frame), direction, frame.reading.force_n, false).f_d
    }));
    if along_n >= least_n {
        return None;
    }
    let axes_n =
        [0, 1, 2].map(|axis| median(frames.iter().map(|frame| frame.reading.force_n[axis])));
    let pose = pose(&frames[0]);
    let tangent = pose.orientation.inverse() * path.tangent(&pose, direction);
    let expected_axis = largest(tangent.into());
    let axis = largest(axes_n);
    let verdict = if along_n <= -least_n {
        Verdict::Reversed
    } else if axis != expected_axis && axes_n[axis].abs() >= least_n {
        Verdict::Elsewhere {
            axis,
            force_n: axes_n[axis],
        }
    } else {
        Verdict::Nowhere
    };
    Some(Wrong {
        row: run.start,
        verdict,
        expected_axis,
        along_n,
        axis_n: axes_n[expected_axis],
    })
}

/// The axis with the largest magnitude.
fn largest(parts: [f64; 3]) -> usize {
    (0..3)
        .max_by(|&a, &b| parts[a].abs().total_cmp(&parts[b].abs()))
        .unwrap_or(0)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
