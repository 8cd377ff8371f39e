//! The belief at another frequency than the object file's.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::door;
use pubs_core::object::{Overrides, load_text};
use pubs_core::task::compile;
use pubs_core::{Action, Task};

/// Moves of 1, 4 and 10 on whole states.
fn benchmark() -> Task {
    let text = r#"
schema = 1
name = "line"
[joint]
type = "abstract"
limits = [0.0, 100.0]
integer = true
goal = 50.0
[[action]]
name = "stop"
stop = true
[[action]]
name = "right_1"
move = 1.0
[[action]]
name = "left_4"
move = -4.0
[[action]]
name = "right_10"
move = 10.0
observations = 10
[belief]
filter = "sis"
particles = 100
tempering = 1.0
[policy]
layers = [8]
[reward]
shape = "flat"
goal_tolerance = 1.0
goal = 1.0
failed_stop = -1.0
safety_violation = -1.0
time = -0.001
discount = 0.99
[observation]
model = "light-dark"
"#;
    let loaded = load_text("line.toml", text.to_owned(), &Overrides::none()).unwrap();
    compile(&loaded.file).unwrap()
}

fn observations(task: &Task) -> Vec<u32> {
    task.actions.iter().map(Action::observations).collect()
}

#[test]
fn an_arm_observes_every_movement_so_often() {
    let task = door(10).with_belief_frequency(5).unwrap();
    assert_eq!(task.belief.rate_hz, 50.0);
    assert_eq!(observations(&task), [0, 5, 5, 5, 5]);
    let before = door(10).policy_ingredients();
    assert_ne!(
        before,
        task.policy_ingredients(),
        "a policy of one frequency is not one of another"
    );
}

#[test]
fn a_benchmark_observes_large_moves_that_divide_so_often() {
    let cases = [
        (1, [0, 1, 1, 1]),
        (2, [0, 1, 2, 2]),
        (4, [0, 1, 4, 1]),
        (5, [0, 1, 1, 5]),
        (10, [0, 1, 1, 10]),
    ];
    for (times, expected) in cases {
        let task = benchmark().with_belief_frequency(times).unwrap();
        assert_eq!(observations(&task), expected, "{times} times");
    }
}

#[test]
fn impossible_frequencies_say_why() {
    let slow = |mut task: Task| {
        task.control.as_mut().unwrap().safe_speed_m_s = 0.02;
        task
    };
    let cases = [
        (door(10), 0, "at least once"),
        (door(10), 20, "above the controller's 100 Hz"),
        (slow(door(10)), 5, "counts as standing still"),
        (benchmark(), 3, "no action of `line`"),
    ];
    for (task, times, expected) in cases {
        let name = task.name.clone();
        let fault = task.with_belief_frequency(times).unwrap_err().to_string();
        assert!(fault.contains(expected), "{name}, {times} times: {fault}");
    }
}
