//! The MELFA driver and the controller emulator, end to end: reaching a goal, being looked at, and
//! every way in which the engine, the link or the controller gives up.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;
#[path = "common/emulator.rs"]
mod emulator;

use std::thread;
use std::time::Duration;

use common::{door2, path_text, pubs, shipped_plugins};
use emulator::{Emulator, Running, run_words};
use serde_json::{Value, json};

/// Acceleration that no stop may pass, m/s²: `control.stop_deceleration_m_s2` of door2 is 5, and the
/// controller's own filter and ramps add to it.
const LARGEST_STOP_M_S2: f64 = 16.0;

/// To and fro, so that the arm moves for as long as a test needs it to.
const LONG_WAY: [&str; 6] = ["0.8", "0.2", "0.8", "0.2", "0.8", "0.2"];

/// The words of a run of door2 over `emulator`.
fn words(emulator: &Emulator, goals: &[&str]) -> Vec<String> {
    run_words("door2", "door2.onnx", goals, &emulator.settings())
}

fn start(emulator: &Emulator, goals: &[&str]) -> Running {
    Running::start(&words(emulator, goals))
}

fn rests(state: &Value) -> bool {
    state["at_rest"] == true
}

fn assert_gentle(state: &Value, name: &str) {
    let peak = state["peaks"]["tool_smooth_acceleration_m_s2"]
        .as_f64()
        .unwrap();
    assert!(peak <= LARGEST_STOP_M_S2, "{name}: {peak:.1} m/s²");
}

#[test]
fn door2_reaches_its_goal_over_the_emulator() {
    let mut emulator = Emulator::start(&["--world", "door2", "--start", "0.3", "--seed", "1"]);
    let folder = tempfile::tempdir().unwrap();
    let answer = pubs(folder.path(), &words(&emulator, &["0.5"]));
    let report = answer.assert_code(0).json();
    assert_eq!(report["outcome"], "reached", "{report}");
    assert_eq!(report["judged_by"], "belief", "nobody knows the true state");
    assert_eq!(report["safety_violations"], Value::Null, "{report}");
    let state = emulator.state();
    let joint = state["object"]["joint_state"].as_f64().unwrap();
    let goal = report["goal"].as_f64().unwrap();
    assert!((joint - goal).abs() < 0.175, "at {joint} rad, not {goal}");
    assert!(rests(&state), "left moving: {state}");
    assert_gentle(&state, "a whole run");
    assert!(answer.stderr.contains("per reply"), "{}", answer.stderr);
}

#[test]
fn doctor_says_what_stands_in_the_way_and_moves_nothing() {
    let mut emulator = Emulator::start(&["--world", "door2", "--start", "0.3", "--mode", "manual"]);
    let look = |emulator: &Emulator, code: i32| {
        let folder = tempfile::tempdir().unwrap();
        let mut arguments = ["doctor", &door2(), "--json", "--plugin-dir"]
            .map(str::to_owned)
            .to_vec();
        arguments.push(path_text(shipped_plugins()));
        arguments.extend(emulator.settings());
        pubs(folder.path(), &arguments).assert_code(code).json()
    };
    let state_of = |report: &Value, name: &str| {
        let checks = report["checks"].as_array().unwrap().clone();
        let check = checks.into_iter().find(|check| check["name"] == name);
        let check = check.unwrap_or_else(|| panic!("no check {name}: {report}"));
        (check["state"].clone(), check["cure"].clone())
    };
    let (state, cure) = state_of(&look(&emulator, 1), "mode");
    assert_eq!(state, "fault");
    assert!(cure.as_str().unwrap().contains("AUTOMATIC"), "{cure}");

    emulator.tell(&json!({ "do": "mode", "mode": "auto" }));
    emulator.tell(&json!({ "do": "emergency_stop", "pressed": true }));
    let (state, _) = state_of(&look(&emulator, 1), "emergency stop");
    assert_eq!(state, "fault");

    emulator.tell(&json!({ "do": "emergency_stop", "pressed": false }));
    assert_eq!(emulator.state()["last_motion_s"], 0.0, "it moved");
}

/// What happens, the exit codes that it may end with, and the words of the report: 4 where the
/// controller's own safety functions stop the arm, 1 where the link is gone, and a run that reaches
/// its goals or misses one where R3 comes back.
const TROUBLE: [(&str, &[i32], &str); 6] = [
    (r#"{"do":"alarm","number":2800}"#, &[4], "alarm"),
    (r#"{"do":"emergency_stop"}"#, &[4], "emergency stop"),
    (r#"{"do":"contact_stop"}"#, &[4], "safety stop"),
    (r#"{"do":"silent","service":"monitor"}"#, &[1, 4], "force"),
    (r#"{"do":"silent","service":"mxt"}"#, &[1, 4], "old"),
    (r#"{"do":"r3","state":"close"}"#, &[0, 3], ""),
];

#[test]
fn trouble_at_the_controller_brings_the_arm_to_rest_and_nothing_resumes() {
    for (trouble, codes, words) in TROUBLE {
        let mut emulator = Emulator::start(&["--world", "door2", "--start", "0.2", "--seed", "1"]);
        let running = start(&emulator, &LONG_WAY[..2]);
        emulator.wait_for_motion();
        emulator.tell(&json!({ "do": "reset_peaks" }));
        emulator.tell(&serde_json::from_str(trouble).unwrap());
        let answer = running.end();
        assert!(
            codes.contains(&answer.code),
            "{trouble}: code {}\n{}\n{}",
            answer.code,
            answer.stdout,
            answer.stderr
        );
        let told = format!("{} {}", answer.stdout, answer.stderr).to_lowercase();
        assert!(told.contains(words), "{trouble}: {told}");
        assert!(emulator.wait(2.0, rests), "{trouble}: it never rested");
        let before = emulator.state()["last_motion_s"].clone();
        thread::sleep(Duration::from_millis(500));
        let after = emulator.state();
        assert_eq!(before, after["last_motion_s"], "{trouble}: it resumed");
        assert_gentle(&after, trouble);
    }
}

#[test]
fn a_paused_engine_and_a_killed_one_leave_an_arm_at_rest() {
    let options = ["--world", "door2", "--start", "0.2", "--seed", "2"];
    let mut emulator = Emulator::start(&options);
    let running = start(&emulator, &LONG_WAY);
    emulator.wait_for_motion();
    emulator.tell(&json!({ "do": "reset_peaks" }));
    running.signal(libc::SIGSTOP);
    assert!(emulator.wait(1.0, rests), "moves on without an engine");
    thread::sleep(Duration::from_secs(1));
    running.signal(libc::SIGCONT);
    let answer = running.end();
    assert!(
        [1, 4].contains(&answer.code),
        "code {}: a pause of a second is a safety stop\n{}\n{}",
        answer.code,
        answer.stdout,
        answer.stderr
    );
    let state = emulator.state();
    assert!(rests(&state), "{state}");
    assert_gentle(&state, "paused");

    let mut emulator = Emulator::start(&options);
    let running = start(&emulator, &LONG_WAY);
    emulator.wait_for_motion();
    emulator.tell(&json!({ "do": "reset_peaks" }));
    running.signal(libc::SIGKILL);
    assert!(emulator.wait(1.0, rests), "moves on without an engine");
    assert_gentle(&emulator.state(), "killed");
}

#[test]
fn ctrl_c_ends_in_a_ramped_stop() {
    let mut emulator = Emulator::start(&["--world", "door2", "--start", "0.2", "--seed", "3"]);
    let running = start(&emulator, &LONG_WAY);
    emulator.wait_for_motion();
    emulator.tell(&json!({ "do": "reset_peaks" }));
    running.signal(libc::SIGINT);
    running.end().assert_code(4);
    let state = emulator.state();
    assert!(rests(&state), "{state}");
    assert_gentle(&state, "interrupted");
}
