//! Whether a recording can be fitted: everything that is wrong with it, before anything is.
//!
//! | check | fault | warning |
//! |---|---|---|
//! | header | other joint type, other sensor, unknown actions | other object |
//! | values | not finite, no unit quaternion | |
//! | time | goes backwards, leaves out periods of a demonstration | leaves them out elsewhere |
//! | path | a jump of the tool | |
//! | force channels | saturated, stuck | zero throughout |
//! | force columns | swapped, of the wrong sign or scale where the arm was blocked | in fewer than half of those places |
//! | extent | less than the joint's range, too few demonstrations | |

mod channels;
mod directions;
mod extent;
mod header;
#[cfg(test)]
mod tests;
mod values;

use pubs_core::Task;
use pubs_core::joint::Pose;
use pubs_run::recording::{Frame, Recording};

use crate::column::Column;
use crate::fault::{Fault, Place};
use crate::source::Source;

/// What a recording is expected to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Expectation {
    /// Demonstrations of each movement action.
    pub demonstrations: usize,
    /// Whether another sensor than the object's will do.
    pub any_sensor: bool,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Reasons to refuse the recording.
    pub faults: Vec<Fault>,
    /// What the user should know.
    pub warnings: Vec<Fault>,
}

/// Checks a recording against the object that it is to calibrate. Like faults of a column are told
/// once, at the first row, with the number of the others.
pub fn check(
    recording: &Recording,
    source: &Source,
    task: &Task,
    expectation: Expectation,
) -> Findings {
    let mut checker = Checker {
        recording,
        source,
        task,
        findings: Findings::default(),
    };
    header::check(&mut checker, expectation.any_sensor);
    let sound = values::check(&mut checker);
    values::check_times(&mut checker);
    values::check_jumps(&mut checker, &sound);
    channels::check(&mut checker);
    directions::check(&mut checker, &sound);
    extent::check(&mut checker, &sound, expectation.demonstrations);
    checker.findings
}

/// A recording under examination.
struct Checker<'a> {
    recording: &'a Recording,
    source: &'a Source,
    task: &'a Task,
    findings: Findings,
}

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Severity {
    Fault,
    Warning,
}

impl<'a> Checker<'a> {
    fn frames(&self) -> &'a [Frame] {
        &self.recording.frames
    }

    fn add(
        &mut self,
        severity: Severity,
        place: Place,
        found: String,
        rule: impl Into<String>,
        cure: impl Into<String>,
    ) {
        let fault = Fault {
            file: self.source.file().to_owned(),
            place,
            found,
            rule: rule.into(),
            cure: cure.into(),
        };
        match severity {
            Severity::Fault => self.findings.faults.push(fault),
            Severity::Warning => self.findings.warnings.push(fault),
        }
    }

    /// Tells of the first of `rows`, and how many there are; of none where there are none.
    fn add_rows(
        &mut self,
        severity: Severity,
        column: Column,
        rows: &[usize],
        found: impl Fn(usize) -> String,
        rule: &str,
        cure: &str,
    ) {
        let Some((&first, others)) = rows.split_first() else {
            return;
        };
        let found = match others.len() {
            0 => found(first),
            1 => format!("{}, and 1 more row is like it", found(first)),
            more => format!("{}, and {more} more rows are like it", found(first)),
        };
        let place = self.source.cell(self.frames(), first, column);
        self.add(severity, place, found, rule, cure);
    }

    /// Index of a frame's action in the object's own list, which may be in another order.
    fn action(&self, frame: &Frame) -> Option<usize> {
        let name = self.recording.header.actions.get(frame.action)?;
        let actions = &self.task.actions;
        actions.iter().position(|action| action.name == *name)
    }
}

fn pose(frame: &Frame) -> Pose {
    Pose::new(frame.reading.position_m, frame.reading.orientation_xyzw)
}

/// Seconds from one frame to a later one; negative where the clock went backwards.
fn seconds(from: &Frame, to: &Frame) -> f64 {
    let [from_ns, to_ns] = [from, to].map(|frame| i128::from(frame.reading.time_ns));
    (to_ns - from_ns) as f64 * 1e-9
}
