//! Recording demonstrations of the virtual arm, through the guard and the loops of a run.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{Plan, recorded, task};
use pubs_calibrate::record::{BaselineLimits, RecordError};
use pubs_calibrate::traces::traces;
use pubs_run::Trip;

const OBJECTS: [&str; 4] = ["drawer1", "drawer2", "door1", "door2"];

#[test]
fn every_object_is_recorded_from_limit_to_limit_and_high_force_stays_away_from_them() {
    for name in OBJECTS {
        let task = task(name, &[]);
        let (recording, report) = recorded(&task, 2, 3);
        assert_eq!(report.trip, None, "{name}");
        assert_eq!((report.done.len(), recording.done.len()), (8, 8), "{name}");
        let (_, limits) = traces(&task, &recording, 0).unwrap();
        let range = limits.range.unwrap();
        assert!(
            (range - task.joint.range()).abs() < 0.01 * task.joint.range(),
            "{name}: measured {} between the stops, the limits are {} apart",
            task.joint.display(range),
            task.joint.display(task.joint.range())
        );
        // The zero is known to a thousandth or two of the range, and the tool runs ahead of the handle.
        let slack = 0.006 * task.joint.range() + 0.003 * task.joint.per_metre();
        for frame in &recording.frames {
            let action = &task.actions[frame.action];
            let truth = frame.truth.unwrap();
            let after = truth + action.displacement();
            let outside = (after - task.joint.upper).max(task.joint.lower - after);
            assert!(
                !action.is_high_force() || outside < slack,
                "{name}: `{}` at {} would leave the limits by {}",
                action.name,
                task.joint.display(truth),
                task.joint.display(outside)
            );
        }
    }
}

#[test]
fn locks_are_found_where_they_are_and_nowhere_else() {
    for (name, locked) in [
        ("drawer1", false),
        ("drawer2", true),
        ("door1", false),
        ("door2", true),
    ] {
        let task = task(name, &[]);
        let (recording, _) = recorded(&task, 1, 5);
        let (traces, _) = traces(&task, &recording, 0).unwrap();
        let safe_open = 1;
        let held = traces
            .iter()
            .filter(|trace| trace.action == safe_open && !trace.folded)
            .flat_map(|trace| &trace.points)
            .any(|point| point.held && point.state < task.joint.at_fraction(0.5));
        assert_eq!(
            held, locked,
            "{name}: safe_open is held near the closed limit"
        );
    }
}

#[test]
fn an_interrupted_recording_is_kept_and_gone_on_with() {
    let task = task("door2", &[]);
    let halted = Plan {
        halt_after: 9000,
        ..Plan::new(2, 1)
    };
    let (first, report) = halted.record(&task).unwrap();
    assert_eq!(report.trip, Some(Trip::Interrupted));
    assert!(
        first.frames.len() >= 9000,
        "{} frames kept",
        first.frames.len()
    );
    assert_eq!(
        first.frames.last().unwrap().speed_m_s,
        0.0,
        "the arm came to rest"
    );
    let before = first.done.len();
    assert!(
        (1..8).contains(&before),
        "{before} demonstrations were done by then"
    );
    let resumed = Plan {
        done: first.done.clone(),
        ..Plan::new(2, 2)
    };
    let (second, report) = resumed.record(&task).unwrap();
    assert_eq!(report.trip, None);
    assert_eq!(report.done.len(), 8, "{:?}", report.done);
    for done in &second.done {
        assert!(!first.done.contains(done), "{done:?} was recorded twice");
    }
}

#[test]
fn a_noisy_or_off_sensor_is_refused_with_its_figures_before_anything_moves() {
    let task = task("door1", &[]);
    let cases = [
        (
            BaselineLimits {
                off_n: 10.0,
                noise_n: 0.05,
            },
            "noisy at rest: standard deviation 0.3",
        ),
        (
            BaselineLimits {
                off_n: 0.01,
                noise_n: 1.0,
            },
            "N at rest after the tare",
        ),
    ];
    for (baseline, words) in cases {
        let plan = Plan {
            baseline: Some(baseline),
            ..Plan::new(1, 1)
        };
        let error: RecordError = plan.record(&task).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn limits_that_are_not_the_objects_end_in_a_ramped_stop_with_the_figures() {
    for (limits, words) in [
        ("[0.0, 60.0]", "further than the whole range"),
        ("[0.0, 200.0]", "the limits are"),
    ] {
        let task = task("door1", &[&format!("joint.limits_deg={limits}")]);
        // The world's door opens to 125 degrees.
        let (recording, report) = Plan::new(1, 4).record(&task).unwrap();
        let trip = report.trip.map(|trip| trip.to_string()).unwrap_or_default();
        assert!(trip.contains(words), "limits {limits}: {trip}");
        let speeds: Vec<f64> = recording
            .frames
            .iter()
            .map(|frame| frame.speed_m_s)
            .collect();
        assert_eq!(
            speeds.last(),
            Some(&0.0),
            "limits {limits}: the arm came to rest"
        );
        for pair in speeds.windows(2) {
            assert!(
                pair[0].abs() - pair[1].abs() <= 0.05 + 1e-9,
                "limits {limits}: from {} to {} m/s in one period",
                pair[0],
                pair[1]
            );
        }
    }
}
