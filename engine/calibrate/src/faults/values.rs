//! Values that no arm has, and moments that do not follow each other.

use pubs_run::recording::Frame;

use super::{Checker, Severity, seconds};
use crate::column::Column;

/// How far the norm of an orientation may be from 1, as for the readings of drivers.
const UNIT_TOLERANCE: f64 = 1e-3;
/// Longer than so many control periods nothing may be missing.
const GAP_PERIODS: f64 = 5.0;
/// Between two frames the tool may move this much faster than the high speed.
const JUMP_FACTOR: f64 = 2.0;
/// And this much further, for noise and the give of the arm.
const JUMP_SLACK_M: f64 = 0.005;

/// Checks each frame by itself; which of them have a pose and forces that can be used.
pub(super) fn check(checker: &mut Checker<'_>) -> Vec<bool> {
    let frames = checker.frames();
    let mut sound = vec![true; frames.len()];
    for column in Column::ALL {
        let value = |index: usize| column.number(&frames[index]);
        let rows = rows_where(frames, |index| {
            value(index).is_some_and(|number| !number.is_finite())
        });
        for &row in &rows {
            sound[row] = false;
        }
        checker.add_rows(
            Severity::Fault,
            column,
            &rows,
            |row| format!("found {}", value(row).unwrap_or(f64::NAN)),
            "a finite number",
            "leave out these rows, or record again",
        );
    }
    let norm = |frame: &Frame| {
        let squares = frame.reading.orientation_xyzw.map(|part| part * part);
        squares.iter().sum::<f64>().sqrt()
    };
    let rows = rows_where(frames, |row| {
        sound[row] && (norm(&frames[row]) - 1.0).abs() > UNIT_TOLERANCE
    });
    for &row in &rows {
        sound[row] = false;
    }
    checker.add_rows(
        Severity::Fault,
        Column::Orientation(0),
        &rows,
        |row| {
            let orientation = frames[row].reading.orientation_xyzw;
            format!(
                "the quaternion {orientation:?} has the norm {:.4}",
                norm(&frames[row])
            )
        },
        "the norm 1",
        "give the orientation as a unit quaternion x, y, z, w",
    );
    sound
}

/// Time may neither go backwards nor leave out periods.
pub(super) fn check_times(checker: &mut Checker<'_>) {
    let frames = checker.frames();
    let step_s = |row: usize| seconds(&frames[row - 1], &frames[row]);
    let backwards = rows_after_first(frames, |row| step_s(row) < 0.0);
    checker.add_rows(
        Severity::Fault,
        Column::Time,
        &backwards,
        |row| format!("time goes back by {:.3} s", -step_s(row)),
        "times that do not go backwards",
        "put the rows in the order of time, and give one recording per file",
    );
    let most_s = GAP_PERIODS / checker.recording.header.rate_hz;
    let gaps = rows_after_first(frames, |row| step_s(row) > most_s);
    let within = |row: &usize| {
        let [before, after] = [&frames[row - 1], &frames[*row]];
        after.demonstration != 0
            && (before.action, before.demonstration) == (after.action, after.demonstration)
    };
    let (inside, between): (Vec<usize>, Vec<usize>) = gaps.into_iter().partition(within);
    let rule = format!("at most {GAP_PERIODS} control periods, {most_s:.3} s, between two poses");
    for (severity, rows, what) in [
        (Severity::Fault, inside, "within a demonstration"),
        (Severity::Warning, between, "between demonstrations"),
    ] {
        checker.add_rows(
            severity,
            Column::Time,
            &rows,
            |row| format!("{:.3} s are missing before this row, {what}", step_s(row)),
            &rule,
            "record again, on a machine that keeps up",
        );
    }
}

/// The tool cannot be elsewhere at once.
pub(super) fn check_jumps(checker: &mut Checker<'_>, sound: &[bool]) {
    let Some(control) = checker.task.control else {
        return;
    };
    let frames = checker.frames();
    let step_m = |row: usize, axis: usize| {
        frames[row].reading.position_m[axis] - frames[row - 1].reading.position_m[axis]
    };
    let moved_m = |row: usize| {
        (0..3)
            .map(|axis| step_m(row, axis).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let most_m = |row: usize| {
        let step_s = seconds(&frames[row - 1], &frames[row]).max(0.0);
        JUMP_FACTOR * control.high_speed_m_s * step_s + JUMP_SLACK_M
    };
    let rows = rows_after_first(frames, |row| {
        sound[row - 1] && sound[row] && moved_m(row) > most_m(row)
    });
    let Some(&first) = rows.first() else { return };
    let furthest = (0..3)
        .max_by(|&a, &b| step_m(first, a).abs().total_cmp(&step_m(first, b).abs()))
        .unwrap_or(0);
    checker.add_rows(
        Severity::Fault,
        Column::Position(furthest),
        &rows,
        |row| format!("the tool jumps by {:.1} mm", moved_m(row) * 1e3),
        &format!(
            "at most {:.1} mm from the row before, {JUMP_FACTOR} times `high_speed_m_s` and {:.0} mm",
            most_m(first) * 1e3,
            JUMP_SLACK_M * 1e3
        ),
        "record again without a break, or give each part as a file of its own",
    );
}

fn rows_where(frames: &[Frame], is_so: impl Fn(usize) -> bool) -> Vec<usize> {
    (0..frames.len()).filter(|&row| is_so(row)).collect()
}

fn rows_after_first(frames: &[Frame], is_so: impl Fn(usize) -> bool) -> Vec<usize> {
    (1..frames.len()).filter(|&row| is_so(row)).collect()
}
