//! Tests of the whole way from a text to an object or its faults.
#![allow(clippy::unwrap_used)]

mod faults;
mod files;
mod json_schema;
mod layers;
mod page;
mod rules;

use super::load::load_text;
use super::{Fault, Faults, LoadedObject, Overrides};

/// A revolute object that states only what has no default. Line 1 is `schema`.
const DOOR: &str = r#"schema = 1
name = "door"
[source]
kind = "assumed"
[joint]
type = "revolute"
limits_deg = [0.0, 90.0]
radius_m = 0.3
opening_direction = [0.0, 0.0, -1.0]
hinge_direction = [1.0, 0.0, 0.0]
up_direction = [0.0, 1.0, 0.0]
[reward]
goal_tolerance_deg = 5.0
"#;

/// A prismatic object of the same kind.
const DRAWER: &str = r#"schema = 1
name = "drawer"
[source]
kind = "assumed"
[joint]
type = "prismatic"
limits_m = [0.0, 0.3]
opening_direction = [0.0, 0.0, -1.0]
up_direction = [0.0, 1.0, 0.0]
[reward]
goal_tolerance_m = 0.02
"#;

/// An abstract object with everything that it must state.
const LIGHT_DARK: &str = r#"schema = 1
name = "light_dark"
[joint]
type = "abstract"
limits = [-60.0, 60.0]
start = [-30.0, 30.0]
integer = true
goal = 0.0
[[action]]
name = "stop"
stop = true
[[action]]
name = "right_10"
move = 10.0
observations = 10
[[action]]
name = "left_1"
move = -1.0
high_force = true
[belief]
filter = "sis"
particles = 300
tempering = 1.0
[reward]
shape = "flat"
goal_tolerance = 0.5
goal = 100.0
failed_stop = -100.0
safety_violation = 0.0
time = -1.0
discount = 0.95
[observation]
model = "light-dark"
params = { light = 10.0 }
"#;

fn load(text: &str) -> Result<LoadedObject, Faults> {
    load_with(text, &Overrides::none())
}

fn load_with(text: &str, overrides: &Overrides) -> Result<LoadedObject, Faults> {
    load_text("object.toml", text.to_owned(), overrides)
}

fn set(items: &[&str]) -> Overrides {
    Overrides::new([], items.iter().map(|item| (*item).to_owned()))
}

fn faults_of(text: &str) -> Vec<Fault> {
    match load(text) {
        Ok(_) => panic!("no fault was found in:\n{text}"),
        Err(faults) => faults.0,
    }
}

/// One way to break a file, and what must be said of it.
struct Case {
    /// The file before.
    base: &'static str,
    /// What is replaced in it (once), and by what.
    change: (&'static str, &'static str),
    /// Line and key of the fault.
    at: (usize, &'static str),
    /// Words in the message.
    message: &'static [&'static str],
    /// Words in the help.
    help: &'static [&'static str],
}

/// Breaks each file in its one way and expects exactly one fault, as described.
fn check_cases(cases: &[Case]) {
    for case in cases {
        let (from, to) = case.change;
        assert_eq!(
            case.base.matches(from).count(),
            1,
            "{from:?} must stand once in the base"
        );
        let text = case.base.replacen(from, to, 1);
        let faults = faults_of(&text);
        let shown = super::render(&Faults(faults.clone()), false);
        assert_eq!(
            faults.len(),
            1,
            "expected one fault of {to:?}, got:\n{shown}"
        );
        let fault = &faults[0];
        assert_eq!(
            (fault.line, fault.key.as_str()),
            (Some(case.at.0), case.at.1),
            "{shown}"
        );
        for word in case.message {
            assert!(
                fault.message.contains(word),
                "message lacks {word:?}:\n{shown}"
            );
        }
        for word in case.help {
            assert!(fault.help.contains(word), "help lacks {word:?}:\n{shown}");
        }
    }
}

#[test]
fn the_smallest_files_load() {
    for text in [DOOR, DRAWER, LIGHT_DARK] {
        if let Err(faults) = load(text) {
            panic!("{}", super::render(&faults, false));
        }
    }
}
