//! `pubs-engine run`: moving an object, on a virtual clock and in real time.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::io::Read;
use std::process::Stdio;
use std::time::{Duration, Instant};

use common::{Answer, assert_fields, command, door2, door2_policy, path_text, pubs, root, words};
use serde_json::Value;

/// 10° of `reward.goal_tolerance_deg`.
const TOLERANCE_RAD: f64 = 0.174_533;
const RUN_FIELDS: [&str; 12] = [
    "outcome",
    "judged_by",
    "goal",
    "belief",
    "true_state",
    "goal_error",
    "time_s",
    "policy_steps",
    "safety_violations",
    "guard_stops",
    "lateness",
    "recording",
];
const LOOPS: [&str; 3] = ["controller", "filter", "policy"];

/// `run` of door2 with the shipped policy; a policy that does not fit is an error, no training.
fn run(line: &str) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    let (object, policy) = (door2(), door2_policy());
    let mut arguments = vec![
        "run",
        object.as_str(),
        "--policy",
        policy.as_str(),
        "--json",
        "--no-record",
    ];
    arguments.extend(words(line));
    pubs(folder.path(), &arguments)
}

fn assert_within_tolerance(report: &Value, goal_rad: f64) {
    let goal = report["goal"].as_f64().unwrap();
    let state = report["true_state"].as_f64().unwrap();
    assert!(
        (goal - goal_rad).abs() < 1e-5,
        "goal {goal}, not {goal_rad}"
    );
    assert!(
        (state - goal_rad).abs() <= TOLERANCE_RAD,
        "came to {state} rad, not {goal_rad}"
    );
    let error = report["goal_error"].as_f64().unwrap();
    assert!(
        ((state - goal).abs() - error).abs() < 1e-9,
        "goal_error {error}"
    );
}

#[test]
fn lockstep_reaches_the_middle_and_reports_every_field() {
    let answer = run("--goal 0.5 --lockstep");
    let report = answer.assert_code(0).json();
    assert_fields(&report, &RUN_FIELDS);
    assert_fields(&report["belief"], &["mean", "entropy"]);
    for name in LOOPS {
        let lateness = &report["lateness"][name];
        assert_fields(lateness, &["p50_us", "p99_us", "max_us", "missed"]);
        assert_eq!(
            lateness["max_us"], 0,
            "a virtual clock is never late: {name}"
        );
    }
    assert_eq!(report["outcome"], "reached");
    assert_eq!(report["judged_by"], "truth");
    assert_eq!(report["safety_violations"], 0);
    assert_within_tolerance(&report, 62.5_f64.to_radians());
}

/// The README's first command, which looks for the policy by itself.
#[test]
fn the_shipped_policy_is_found_beside_the_objects() {
    let folder = tempfile::tempdir().unwrap();
    let line = [
        "run",
        &door2(),
        "--goal",
        "0.5",
        "--lockstep",
        "--no-record",
    ];
    let answer = pubs(folder.path(), &line);
    answer.assert_code(0);
    assert!(answer.stdout.contains("reached"), "{}", answer.stdout);
    assert_eq!(
        folder.path().read_dir().unwrap().count(),
        0,
        "it left files behind"
    );
}

#[test]
fn a_seed_decides_every_byte() {
    let [first, again, other] =
        ["7", "7", "8"].map(|seed| run(&format!("--goal 0.5 --lockstep --seed {seed}")).stdout);
    assert_eq!(first, again, "one seed gave two runs");
    let state = |text: &str| serde_json::from_str::<Value>(text).unwrap()["true_state"].clone();
    assert_ne!(state(&first), state(&other), "two seeds gave one run");
}

#[test]
fn goals_are_reached_one_after_the_other() {
    let report = run("--goal 0.25 --goal 40deg --lockstep")
        .assert_code(0)
        .json();
    let goals = report["goals"].as_array().unwrap();
    assert_eq!(goals.len(), 2, "{report}");
    for (goal, degrees) in goals.iter().zip([31.25_f64, 40.0]) {
        assert_eq!(goal["outcome"], "reached", "{goal}");
        assert_within_tolerance(goal, degrees.to_radians());
    }
    assert_within_tolerance(&report, 40.0_f64.to_radians());
}

#[test]
fn a_second_goal_at_a_limit_is_not_run_into() {
    // Each of these broke the limit at high force while the shield left no margin.
    let cases = [
        ("drawer1", "closed", 1),
        ("drawer1", "open", 2),
        ("drawer1", "open", 3),
        ("drawer2", "closed", 1),
        ("drawer2", "open", 2),
        ("drawer2", "open", 3),
        ("drawer2", "open", 4),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (object, limit, seed) in cases {
        let object = path_text(&root().join(format!("objects/{object}.toml")));
        let line = format!(
            "run {object} --goal 0.5 --goal {limit} --seed {seed} --lockstep --no-record --json"
        );
        let answer = pubs(folder.path(), &words(&line));
        let report = answer.assert_code(0).json();
        assert_eq!(report["safety_violations"], 0, "{line}: {report}");
    }
}

#[test]
fn a_run_that_is_cut_short_times_out() {
    let report = run("--goal 0.5 --lockstep --max-steps 1")
        .assert_code(3)
        .json();
    assert_eq!(report["outcome"], "timed_out");
    assert_eq!(report["policy_steps"], 1);
}

#[test]
fn real_time_ends_and_measures_its_lateness() {
    let answer = run("--goal 0.5");
    let report = answer.json();
    let outcome = report["outcome"].as_str().unwrap();
    assert!(
        matches!(
            (answer.code, outcome),
            (0, "reached") | (3, "missed" | "timed_out")
        ),
        "code {} and {report}\n{}",
        answer.code,
        answer.stderr
    );
    let latest = LOOPS.map(|name| report["lateness"][name]["max_us"].as_f64().unwrap());
    assert!(
        latest.iter().any(|latest| *latest > 0.0),
        "no loop was ever late: {report}"
    );
    assert!(report["time_s"].as_f64().unwrap() > 0.5, "{report}");
}

#[test]
fn an_interrupt_stops_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    // A goal so far off that the run is still under way when the signal comes.
    let (object, policy) = (door2(), door2_policy());
    let arguments = [
        "run",
        &object,
        "--policy",
        &policy,
        "--goal",
        "0.9",
        "--json",
        "--no-record",
    ];
    let mut child = command(folder.path(), &arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    common::signal(&child, libc::SIGINT);
    let signalled = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if signalled.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            panic!("the program ignores an interrupt");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let mut stderr = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut stderr)
        .unwrap();
    let took = signalled.elapsed();
    let answer = Answer::from_output(
        "run, interrupted".to_owned(),
        child.wait_with_output().unwrap(),
    );
    assert_eq!(answer.code, 4, "{stderr}\n{}", answer.stdout);
    let report = answer.json();
    assert_eq!(report["outcome"], "safety_stop");
    assert!(
        report["reason"].as_str().unwrap().contains("interrupt"),
        "{report}"
    );
    assert!(
        took < Duration::from_secs(2),
        "it took {took:?} to come to rest"
    );
}
