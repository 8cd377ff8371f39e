//! A recording by hand for a slide and a hinge, and each thing that can be wrong with it.
#![allow(clippy::unwrap_used)]

mod hand;
mod virtual_arm;

use std::path::Path;

use pubs_core::Task;
use pubs_plugin::JointType;
use pubs_run::recording::{Frame, Recording};

use super::{Expectation, Findings, check};
use crate::{Fault, Source};
use hand::{ACTIONS, BLOCKED_ROWS, RADIUS_M, hinge, recording, slide};

const EXPECTED: Expectation = Expectation {
    demonstrations: 2,
    any_sensor: false,
};

/// A table with its first frame in line 11.
fn table(recording: &Recording) -> Source {
    let lines = (0..recording.frames.len()).map(|row| row + 11).collect();
    Source::csv(Path::new("pull.csv"), lines)
}

fn check_table(recording: &Recording, task: &Task) -> Findings {
    check(recording, &table(recording), task, EXPECTED)
}

fn texts(faults: &[Fault]) -> Vec<String> {
    faults.iter().map(Fault::to_string).collect()
}

/// What is expected of a broken recording.
enum Says {
    Fault(&'static str),
    Warning(&'static str),
}

/// The breakage, what it does, and the one thing that must be said of it.
type Case = (&'static str, fn(&mut Recording), Says);

fn every_case_says_one_thing(cases: &[Case]) {
    for (hinged, task) in [(false, slide()), (true, hinge())] {
        for (name, spoil, says) in cases {
            let mut recording = recording(hinged);
            spoil(&mut recording);
            let findings = check_table(&recording, &task);
            let [faults, warnings] = [&findings.faults, &findings.warnings].map(|said| texts(said));
            let (said, others, expected) = match says {
                Says::Fault(text) => (faults, warnings, text),
                Says::Warning(text) => (warnings, faults, text),
            };
            let expected = format!("pull.csv: {expected}");
            assert!(
                said.len() == 1 && said[0].contains(&expected) && others.is_empty(),
                "{name} (hinge: {hinged}): {said:#?} should be `{expected}` alone, beside {others:#?}"
            );
        }
    }
}

#[test]
fn nothing_is_said_of_a_good_recording() {
    for (hinged, task) in [(false, slide()), (true, hinge())] {
        let good = recording(hinged);
        assert_eq!(
            check_table(&good, &task),
            Findings::default(),
            "hinge: {hinged}"
        );
        // With the actions in another order than the object has them.
        let mut reordered = good.clone();
        reordered.header.actions.reverse();
        for frame in &mut reordered.frames {
            frame.action = ACTIONS.len() - 1 - frame.action;
        }
        let findings = check_table(&reordered, &task);
        assert_eq!(findings, Findings::default(), "hinge: {hinged}");
        // Begun elsewhere: the path is the same through any of its poses.
        let mut later = good;
        later.frames.drain(..BLOCKED_ROWS + 300);
        later.frames.truncate(800);
        let findings = check_table(&later, &task);
        assert_eq!(texts(&findings.faults), [""; 0], "hinge: {hinged}");
    }
}

#[test]
fn the_header_must_be_the_objects() {
    every_case_says_one_thing(&[
        (
            "another joint",
            |recording| recording.header.joint = JointType::Abstract,
            Says::Fault("`# joint`: the recording is of a joint that is abstract; expected "),
        ),
        (
            "another object",
            |recording| recording.header.object = "wardrobe".to_owned(),
            Says::Warning("`# object`: the recording is of `wardrobe`; expected `closet`"),
        ),
        (
            "another sensor",
            |recording| recording.header.sensor = "fingertip".to_owned(),
            Says::Fault(
                "`# sensor`: the forces are those of the sensor `fingertip`; expected `wrist`",
            ),
        ),
        (
            "an action that the object does not have",
            |recording| recording.header.actions.push("high_opne".to_owned()),
            Says::Fault(
                "`# actions`: `high_opne` is no action of `closet`; expected only stop, safe_open, safe_close, high_open, high_close (is `high_open` meant?)",
            ),
        ),
    ]);
    let mut fingertip = recording(false);
    fingertip.header.sensor = "fingertip".to_owned();
    let mut task = slide();
    let accepting = Expectation {
        any_sensor: true,
        ..EXPECTED
    };
    let findings = check(&fingertip, &table(&fingertip), &task, accepting);
    assert_eq!((findings.faults.len(), findings.warnings.len()), (0, 1));
    task.sensor = None;
    assert_eq!(check_table(&fingertip, &task), Findings::default());
}

#[test]
fn values_and_times_must_be_possible() {
    every_case_says_one_thing(&[
        (
            "a force that is not a number",
            |recording| recording.frames[100].reading.force_n[1] = f64::NAN,
            Says::Fault("line 111, column force_y_n: found NaN; expected a finite number"),
        ),
        (
            "three infinite torques",
            |recording| {
                for row in [50, 60, 70] {
                    recording.frames[row].reading.torque_nm[2] = f64::INFINITY;
                }
            },
            Says::Fault("line 61, column torque_z_nm: found inf, and 2 more rows are like it"),
        ),
        (
            "a true state that is not a number",
            |recording| recording.frames[9].truth = Some(f64::NAN),
            Says::Fault("line 20, column true_state: found NaN"),
        ),
        (
            "an orientation of norm 2",
            |recording| recording.frames[4].reading.orientation_xyzw = [0.0, 0.0, 0.0, 2.0],
            Says::Fault(
                "line 15, column qx: the quaternion [0.0, 0.0, 0.0, 2.0] has the norm 2.0000; expected the norm 1",
            ),
        ),
        (
            "a clock that goes back",
            |recording| {
                for frame in &mut recording.frames[30..] {
                    frame.reading.time_ns -= 20_000_000;
                }
            },
            Says::Fault("line 41, column time_s: time goes back by 0.010 s"),
        ),
        (
            "seven periods left out of a demonstration",
            |recording| {
                recording.frames.drain(100..106);
            },
            Says::Fault(
                "line 111, column time_s: 0.070 s are missing before this row, within a demonstration; expected at most 5 control periods, 0.050 s",
            ),
        ),
        (
            "a pause between demonstrations",
            |recording| {
                let second = recording
                    .frames
                    .iter()
                    .position(|frame| frame.demonstration == 2);
                for frame in &mut recording.frames[second.unwrap()..] {
                    frame.reading.time_ns += 3_000_000_000;
                }
            },
            Says::Warning(
                "line 713, column time_s: 3.010 s are missing before this row, between demonstrations",
            ),
        ),
    ]);
}

#[test]
fn periods_that_are_left_out_without_a_pause_are_no_fault() {
    let mut thinned = recording(false);
    thinned.frames.drain(100..104);
    assert_eq!(check_table(&thinned, &slide()), Findings::default());
}

#[test]
fn a_jump_of_the_tool_is_a_fault() {
    for (hinged, task) in [(false, slide()), (true, hinge())] {
        for (shift_m, jumps) in [(0.02, true), (0.005, false)] {
            let mut shifted = recording(hinged);
            for frame in &mut shifted.frames[200..] {
                frame.reading.position_m[1] += shift_m;
            }
            let said = texts(&check_table(&shifted, &task).faults);
            let expected = "pull.csv: line 211, column y_m: the tool jumps by ";
            assert_eq!(
                said.iter().any(|said| said.starts_with(expected)),
                jumps,
                "{shift_m} m, hinge {hinged}: {said:#?}"
            );
        }
    }
    // In a long gap the arm may go as far as its speed allows, and that is a gap alone.
    let mut gap = recording(false);
    gap.frames.drain(100..140);
    let said = texts(&check_table(&gap, &slide()).faults);
    assert!(
        said.len() == 1 && said[0].contains("are missing"),
        "{said:#?}"
    );
}

#[test]
fn force_channels_must_follow_the_force() {
    every_case_says_one_thing(&[
        (
            "a sensor with a range of 12 N",
            |recording| {
                for frame in &mut recording.frames {
                    for force in &mut frame.reading.force_n {
                        *force = force.clamp(-12.0, 12.0);
                    }
                }
            },
            Says::Fault(
                "line 251, column force_z_n: -12 N stands in 31 rows on end, and so in 3 more places",
            ),
        ),
        (
            "a channel that stands still",
            |recording| {
                for frame in &mut recording.frames[20..130] {
                    frame.reading.force_n[1] = 0.25;
                }
            },
            Says::Fault(
                "line 31, column force_y_n: 0.25 N stands in 110 rows on end; expected a force that varies",
            ),
        ),
        (
            "a channel that is not there",
            |recording| {
                for frame in &mut recording.frames {
                    frame.reading.force_n[0] = 0.0;
                }
            },
            Says::Warning("line 11, column force_x_n: the force is 0 in every row"),
        ),
    ]);
}

#[test]
fn force_columns_must_be_what_they_say() {
    every_case_says_one_thing(&[
        (
            "x and z swapped",
            |recording| {
                for frame in &mut recording.frames {
                    frame.reading.force_n.swap(0, 2);
                }
            },
            Says::Fault("line 251, column force_z_n: "),
        ),
        (
            "every sign turned",
            |recording| {
                for frame in &mut recording.frames {
                    frame.reading.force_n = frame.reading.force_n.map(|force| -force);
                }
            },
            Says::Fault("line 251, column force_z_n: -1"),
        ),
        (
            "kilograms for newtons",
            |recording| {
                for frame in &mut recording.frames {
                    frame.reading.force_n = frame.reading.force_n.map(|force| force / 9.81);
                }
            },
            Says::Fault(
                "line 251, column force_z_n: 1.6 N along the motion, and as little along any axis while the arm was blocked, in 4 of 4 such places; expected about `force_threshold_n`, 15 N, or more",
            ),
        ),
        (
            "somebody leans on the door once",
            |recording| {
                for frame in &mut recording.frames[240..240 + BLOCKED_ROWS] {
                    frame.reading.force_n[2] += 8.0;
                }
            },
            Says::Warning("line 251, column force_z_n: 8"),
        ),
    ]);
    type Spoil = fn(&mut [f64; 3]);
    let cures: [(Spoil, &str); 3] = [
        (
            |force| force.swap(0, 2),
            "force_x_n seems to hold it, with -1",
        ),
        (
            |force| force.swap(1, 2),
            "force_y_n seems to hold it, with -1",
        ),
        (
            |force| *force = force.map(|part| -part),
            "the sign is reversed",
        ),
    ];
    for (spoil, expected) in cures {
        let mut spoilt = recording(true);
        for frame in &mut spoilt.frames {
            spoil(&mut frame.reading.force_n);
        }
        let said = texts(&check_table(&spoilt, &hinge()).faults);
        assert!(
            said[0].contains(expected),
            "{said:#?} should say `{expected}`"
        );
    }
}

#[test]
fn an_arm_that_was_not_blocked_by_its_controller_tells_nothing() {
    // A high-force action at rest, one that is not settled, and a rest too short to judge.
    let spoils: [fn(&mut Frame); 2] = [|frame| frame.action += 2, |frame| frame.settled = false];
    for spoil in spoils {
        let mut resting = recording(false);
        for frame in &mut resting.frames {
            frame.reading.force_n[2] *= -1.0;
            if frame.speed_m_s == 0.0 {
                spoil(frame);
            }
        }
        assert_eq!(check_table(&resting, &slide()), Findings::default());
    }
}

#[test]
fn the_recording_must_go_from_limit_to_limit_and_often_enough() {
    every_case_says_one_thing(&[
        (
            "one action short",
            |recording| {
                recording
                    .done
                    .retain(|done| (done.action.as_str(), done.demonstration) != ("high_close", 2));
            },
            Says::Fault(
                "`# done`: too few demonstrations were carried out to their end: safe_open has 2, safe_close has 2, high_open has 2, high_close has 1 (1 more begun); expected at least 2 of each",
            ),
        ),
        (
            "one demonstration named twice",
            |recording| {
                for done in &mut recording.done {
                    done.demonstration = 1;
                }
            },
            Says::Fault(
                "`# done`: too few demonstrations were carried out to their end: safe_open has 1 (1 more begun)",
            ),
        ),
    ]);
    for (task, hinged, needed, range) in [
        (
            slide(),
            false,
            "expected at least 12.2 cm of the 12.8 cm",
            0.128,
        ),
        (
            hinge(),
            true,
            "expected at least 23.4° of the 24.4°",
            0.128 / RADIUS_M,
        ),
    ] {
        let mut longer = task.clone();
        longer.joint.upper = range;
        let said = texts(&check_table(&recording(hinged), &longer).faults);
        assert!(
            said.len() == 1 && said[0].contains(needed),
            "{said:#?} should say `{needed}`"
        );
        assert!(
            said[0].starts_with("pull.csv: the joint moves through "),
            "{said:#?}"
        );
        // 3 mm of give and 2 % of the range may be missing: 12 cm do for 12.5 cm.
        longer.joint.upper = range * 0.125 / 0.128;
        assert_eq!(
            check_table(&recording(hinged), &longer),
            Findings::default()
        );
    }
}

#[test]
fn messages_are_named_where_the_recording_is_mcap() {
    let mut broken = recording(false);
    broken.frames[100].reading.force_n[0] = f64::NAN;
    broken.frames[40].truth = Some(0.5);
    broken.frames[50].truth = Some(f64::INFINITY);
    broken.header.sensor = "fingertip".to_owned();
    broken.done.clear();
    let source = Source::mcap(Path::new("pull.mcap"));
    let said = texts(&check(&broken, &source, &slide(), EXPECTED).faults).join("\n");
    for expected in [
        "pull.mcap: metadata `sensor`: the forces are",
        "pull.mcap: /wrench message 101 (t = 1.00 s), force.x: found NaN",
        "pull.mcap: /truth message 2 (t = 0.50 s), joint_state: found inf",
        "pull.mcap: too few demonstrations",
    ] {
        assert!(said.contains(expected), "`{said}` should say `{expected}`");
    }
}

#[test]
fn an_empty_recording_is_short_and_nothing_else() {
    let mut empty = recording(true);
    empty.frames.clear();
    let said = texts(&check_table(&empty, &hinge()).faults);
    assert!(
        said.len() == 1 && said[0].contains("moves through 0.0°"),
        "{said:#?}"
    );
}
