//! Every way out ends in a ramped stop: an arm that is its own dummy twin, and everything that can
//! go wrong with it, in lockstep and in real time.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use common::{Dummy, Even, Log, ModelTrouble, SECOND, TROUBLE_AT_S, Trouble, always, task};
use pubs_core::belief::Model;
use pubs_run::{GoalPlan, Outcome, RunOptions, RunReport, run};

struct Case {
    action: usize,
    arm: Trouble,
    model: ModelTrouble,
    truth: Option<f64>,
    lockstep: bool,
    interrupt_after: Option<Duration>,
}

impl Case {
    fn new(arm: Trouble, lockstep: bool) -> Self {
        Self {
            action: 1,
            arm,
            model: ModelTrouble::None,
            truth: None,
            lockstep,
            interrupt_after: None,
        }
    }

    fn run(&self) -> (RunReport, Log) {
        let folder = tempfile::tempdir().unwrap();
        let log = Arc::new(Mutex::new(Log::default()));
        let interrupt = Arc::new(AtomicBool::new(false));
        if let Some(after) = self.interrupt_after {
            let interrupt = Arc::clone(&interrupt);
            std::thread::spawn(move || {
                std::thread::sleep(after);
                interrupt.store(true, Ordering::Release);
            });
        }
        let options = RunOptions {
            goals: vec![GoalPlan {
                state: 0.15,
                policy: 0,
            }],
            shield: None,
            max_steps: 20,
            lockstep: self.lockstep,
            seed: 1,
            policy: "always the same".to_owned(),
            interrupt,
        };
        let arm = Box::new(Dummy::new(self.arm, self.truth, &log));
        let model: Arc<dyn Model> = Even::new(self.model);
        let policies = vec![always(self.action, folder.path(), model.as_ref())];
        let report = run(
            &Arc::new(task()),
            arm,
            model,
            policies,
            &options,
            &mut |_| {},
        )
        .unwrap();
        let log = std::mem::take(&mut *log.lock().unwrap());
        (report, log)
    }
}

/// The commanded speed falls by no more than the deceleration of a stop allows, to rest.
fn assert_ramped_stop(log: &Log, name: &str) {
    assert!(log.stops >= 1, "{name}: the driver was never told to stop");
    let last = log.commands.last().map_or(0.0, |&(_, speed)| speed);
    assert_eq!(last, 0.0, "{name}: left with a command of {last} m/s");
    for pair in log.commands.windows(2) {
        let [(_, before), (time, after)] = [pair[0], pair[1]];
        let step = before.abs() - after.abs();
        assert!(
            step <= 5.0 / 100.0 + 1e-9,
            "{name}: from {before} to {after} m/s in one period at {time} s"
        );
    }
}

#[test]
fn trouble_in_lockstep_ends_in_a_ramped_stop() {
    let cases = [
        (Trouble::ReadFails, Outcome::Fault, "the link is gone"),
        (Trouble::ReportsFault, Outcome::Fault, "reports a fault"),
        (Trouble::ReadingsStop, Outcome::SafetyStop, "ms old"),
        (Trouble::ForceSpike, Outcome::SafetyStop, "force 58.0 N"),
        (
            Trouble::LeavesPath,
            Outcome::SafetyStop,
            "21.0 mm off the path",
        ),
        (Trouble::Jumps, Outcome::SafetyStop, "between two readings"),
    ];
    for (trouble, outcome, words) in cases {
        let (report, log) = Case {
            action: 2,
            ..Case::new(trouble, true)
        }
        .run();
        let name = format!("{trouble:?}");
        assert_eq!(report.outcome, outcome, "{name}: {report:?}");
        let reason = report.reason.unwrap_or_default();
        assert!(
            reason.contains(words),
            "{name}: `{words}` is missing in: {reason}"
        );
        assert_eq!(report.guard_stops, 1, "{name}");
        assert_ramped_stop(&log, &name);
        let fastest = log
            .commands
            .iter()
            .map(|&(_, speed)| speed)
            .fold(0.0, f64::max);
        assert!(
            (fastest - 0.15).abs() < 1e-9,
            "{name}: it never moved at full speed ({fastest} m/s)"
        );
        let stopped_at = log
            .commands
            .iter()
            .find(|&&(time, speed)| time > TROUBLE_AT_S && speed == 0.0);
        let stopped_s = stopped_at.map_or(f64::INFINITY, |&(time, _)| time - TROUBLE_AT_S);
        assert!(
            stopped_s < 0.2,
            "{name}: at rest only {stopped_s} s after the trouble"
        );
    }
}

#[test]
fn a_refused_command_is_the_end() {
    let (report, log) = Case::new(Trouble::CommandFails, true).run();
    assert_eq!(report.outcome, Outcome::Fault);
    assert!(
        report
            .reason
            .unwrap_or_default()
            .contains("the command was refused")
    );
    assert!(log.stops >= 1, "the driver was never told to stop");
}

#[test]
fn a_belief_that_breaks_down_stops_the_arm() {
    let cases = [
        (ModelTrouble::NotANumber, "not a number"),
        (ModelTrouble::Impossible, "no particle can explain"),
    ];
    for (model, words) in cases {
        let (report, log) = Case {
            model,
            ..Case::new(Trouble::None, true)
        }
        .run();
        let reason = report.reason.unwrap_or_default();
        assert_eq!(report.outcome, Outcome::Fault, "{model:?}: {reason}");
        assert!(
            reason.contains(words),
            "{model:?}: `{words}` is missing in: {reason}"
        );
        assert_ramped_stop(&log, &format!("{model:?}"));
    }
}

#[test]
fn a_violation_by_the_true_state_is_a_safety_stop() {
    // 15 mm per step, about 10 mm less at the start: the last step that fits ends near 0.295 m,
    // the next would pass 0.3 m, and the ramp to rest takes 3 mm at most.
    let (report, log) = Case {
        action: 2,
        truth: Some(0.247),
        ..Case::new(Trouble::None, true)
    }
    .run();
    assert_eq!(report.outcome, Outcome::SafetyStop, "{report:?}");
    assert_eq!(report.safety_violations, Some(1));
    assert_eq!(
        report.guard_stops, 0,
        "a violation is not a stop by the guard"
    );
    assert!(
        report.true_state.unwrap() < 0.3,
        "it left the limits: {:?}",
        report.true_state
    );
    assert_ramped_stop(&log, "violation");
}

#[test]
fn a_policy_that_never_stops_times_out() {
    let (report, log) = Case::new(Trouble::None, true).run();
    assert_eq!(report.outcome, Outcome::TimedOut);
    assert_eq!(report.policy_steps, 20);
    assert_eq!(
        report.safety_violations, None,
        "nobody knows the true state"
    );
    assert_ramped_stop(&log, "time-out");
}

#[test]
fn a_stop_is_judged_where_the_arm_rests() {
    for (truth, outcome) in [(0.15, Outcome::Reached), (0.25, Outcome::Missed)] {
        let (report, _) = Case {
            action: 0,
            truth: Some(truth),
            ..Case::new(Trouble::None, true)
        }
        .run();
        assert_eq!(report.outcome, outcome, "{report:?}");
        assert_eq!(report.policy_steps, 1);
    }
}

#[test]
fn lockstep_repeats_byte_for_byte() {
    let case = Case {
        truth: Some(0.1),
        ..Case::new(Trouble::None, true)
    };
    let [first, second] =
        [case.run(), case.run()].map(|(report, _)| serde_json::to_string(&report).unwrap());
    assert_eq!(first, second);
}

#[test]
fn trouble_in_real_time_ends_in_a_stop() {
    let live = |arm, model, interrupt_after| Case {
        model,
        interrupt_after,
        ..Case::new(arm, false)
    };
    let soon = Some(Duration::from_millis(700));
    let cases = [
        (
            "a panic in the driver",
            live(Trouble::ReadPanics, ModelTrouble::None, None),
            Outcome::Fault,
            "the dummy panics",
        ),
        (
            "a panic in the model",
            live(Trouble::None, ModelTrouble::Panics, None),
            Outcome::Fault,
            "the model panics",
        ),
        (
            "a hung model",
            live(Trouble::None, ModelTrouble::Hangs, None),
            Outcome::SafetyStop,
            "no sign of life from the filter",
        ),
        (
            "an interrupt",
            live(Trouble::None, ModelTrouble::None, soon),
            Outcome::SafetyStop,
            "interrupted",
        ),
        (
            "a lost link",
            live(Trouble::ReadFails, ModelTrouble::None, None),
            Outcome::Fault,
            "the link is gone",
        ),
    ];
    for (name, case, outcome, words) in cases {
        let begun = Instant::now();
        let (report, log) = case.run();
        let waited = begun.elapsed();
        assert!(
            waited < Duration::from_secs(10),
            "{name}: the report came only after {waited:?}"
        );
        let reason = report.reason.unwrap_or_default();
        assert_eq!(report.outcome, outcome, "{name}: {reason}");
        assert!(
            reason.contains(words),
            "{name}: `{words}` is missing in: {reason}"
        );
        assert!(log.stops >= 1, "{name}: the driver was never told to stop");
    }
}

#[test]
fn a_hung_driver_is_given_up() {
    let (report, _) = Case::new(Trouble::ReadHangs, false).run();
    assert_eq!(report.outcome, Outcome::SafetyStop);
    let reason = report.reason.unwrap_or_default();
    assert!(
        reason.contains("no sign of life from the controller"),
        "{reason}"
    );
    assert!(
        report.time_s < 5.0 && report.time_s * 1e9 < 5.0 * SECOND as f64,
        "{} s",
        report.time_s
    );
}
