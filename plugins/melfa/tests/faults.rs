//! Each fault, through the emulator: the arm comes to rest gently, nothing resumes by itself, and
//! the reason is told.
#![allow(clippy::unwrap_used, missing_docs)]

mod peer;

use std::sync::MutexGuard;
use std::time::{Duration, Instant};

use melfa::Melfa;
use melfa::motion::Phase;
use melfa::system::monotonic_ns;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use peer::steady::{note_stall, steadily};
use pubs_melfa_emulator::{Emulator, Options};
use pubs_plugin::{Driver, DriverStatus, PluginError, Twist};
use serde_json::{Value, json};

/// The filter of the uploaded program, s.
const FILTER_S: f64 = 0.010;

/// Acceleration and stop of the driver's parameters and the object, m/s².
const RAMP_M_S2: f64 = 5.0;

const CYCLE_S: f64 = 0.0035;

/// More of the driver's steps than this in one cycle of the emulator are a jump; two or three come
/// together where a lost packet is followed by the next, or the emulator, no real-time system, is late.
const MOST_STEPS: f64 = 3.0;

/// A cell with a drawer half open in the gripper.
struct Cell {
    // First, so that it is closed first.
    arm: Melfa,
    emulator: Emulator,
    opening: Vector3<f64>,
    _alone: MutexGuard<'static, ()>,
}

impl Cell {
    fn open(more: Value) -> Self {
        let alone = peer::alone();
        let words = "--world drawer1 --start 0.5 --r3-port 0 --mxt-port 0 --monitor-port 0 --control-port 0";
        let words: Vec<&str> = words.split_whitespace().collect();
        let emulator = Emulator::start(&Options::from_words(&words).unwrap()).unwrap();
        let ports = emulator.ports();
        let mut params = json!({
            "host": "127.0.0.1",
            "r3_port": ports.r3,
            "mxt_port": ports.mxt,
            "monitor_port": ports.monitor,
        });
        let map = params.as_object_mut().unwrap();
        map.extend(more.as_object().unwrap().clone());
        let mut arm = Melfa::open(&peer::setup(params)).unwrap_or_else(|error| {
            let state = emulator.command(r#"{"do":"state"}"#);
            let worst_s = state["lateness"]["worst_s"].as_f64().unwrap();
            note_stall(Duration::from_secs_f64(worst_s));
            panic!("open: {error}")
        });
        let [x, y, z, w] = arm.read().unwrap().orientation_xyzw;
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Self {
            arm,
            emulator,
            opening: turn * Vector3::new(0.0, 0.0, -1.0),
            _alone: alone,
        }
    }

    fn say(&self, command: Value) -> Value {
        let answer = self.emulator.command(&command.to_string());
        assert_eq!(answer["ok"], true, "{command}: {answer}");
        answer
    }

    fn state(&self) -> Value {
        self.say(json!({ "do": "state" }))
    }

    /// Measures anew from here.
    fn reset_peaks(&self) {
        self.note_stall();
        self.say(json!({ "do": "reset_peaks" }));
    }

    /// How late the emulator's cycle was: then it was the machine that interrupted the link.
    fn note_stall(&self) {
        let worst_s = self.state()["lateness"]["worst_s"].as_f64().unwrap();
        note_stall(Duration::from_secs_f64(worst_s));
    }

    /// Opens the drawer, as the engine would, until an error or the end of the time.
    fn drive(&mut self, speed: f64, seconds: f64) -> Result<(), PluginError> {
        let twist = Twist {
            linear_m_s: (self.opening * speed).into(),
            angular_rad_s: [0.0; 3],
        };
        let end = Instant::now() + Duration::from_secs_f64(seconds);
        while Instant::now() < end {
            self.arm.read()?;
            self.arm.command(twist, monotonic_ns() + 50_000_000)?;
            std::thread::sleep(Duration::from_millis(10));
        }
        Ok(())
    }

    fn tool_m(&self) -> Vector3<f64> {
        let state = self.state();
        Vector3::from_fn(|axis, _| state["tool_m"][axis].as_f64().unwrap())
    }
}

impl Drop for Cell {
    fn drop(&mut self) {
        self.note_stall();
    }
}

fn wait(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}

/// What the session does about a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    /// It goes on.
    GoesOn,
    /// It goes on, or comes to rest for a while.
    Either,
    /// The arm comes to rest; after the fault a new command moves it.
    Passes(&'static str),
    /// The arm comes to rest for good.
    Ends(&'static str),
}

fn cases() -> Vec<(&'static str, Value, Outcome)> {
    use Outcome::{Either, Ends, GoesOn, Passes};
    vec![
        (
            "1 in 100 lost",
            json!({ "do": "drop", "probability": 0.01 }),
            GoesOn,
        ),
        (
            "1 in 5 lost",
            json!({ "do": "drop", "probability": 0.2 }),
            Either,
        ),
        (
            "bursts lost",
            json!({ "do": "drop", "probability": 0.02, "burst": 8 }),
            Either,
        ),
        (
            "delayed",
            json!({ "do": "delay", "ms": 3.0, "jitter_ms": 5.0 }),
            GoesOn,
        ),
        (
            "duplicated",
            json!({ "do": "duplicate", "probability": 0.3 }),
            GoesOn,
        ),
        (
            "reordered",
            json!({ "do": "reorder", "probability": 0.1 }),
            GoesOn,
        ),
        (
            "short",
            json!({ "do": "short", "probability": 0.05 }),
            GoesOn,
        ),
        (
            "strangers",
            json!({ "do": "stranger", "count": 100, "service": "both" }),
            GoesOn,
        ),
        (
            "monitor silent",
            json!({ "do": "silent", "service": "monitor" }),
            Passes("force reading is"),
        ),
        (
            "MXT silent",
            json!({ "do": "silent", "service": "mxt" }),
            Passes("newest pose is"),
        ),
        (
            "all dropped",
            json!({ "do": "drop", "probability": 1.0 }),
            Passes("newest"),
        ),
        ("R3 closed", json!({ "do": "r3", "state": "close" }), GoesOn),
        (
            "R3 refused",
            json!({ "do": "r3", "state": "refuse" }),
            Passes("R3 does not answer"),
        ),
        (
            "alarm",
            json!({ "do": "alarm", "number": 2140, "text": "amplifier hot" }),
            Ends("alarm 2140 (amplifier hot)"),
        ),
        (
            "emergency stop",
            json!({ "do": "emergency_stop" }),
            Ends("emergency stop"),
        ),
        (
            "contact stop",
            json!({ "do": "contact_stop" }),
            Ends("safety stop: alarm"),
        ),
        (
            "mode",
            json!({ "do": "mode", "mode": "manual" }),
            Ends("safety stop"),
        ),
    ]
}

/// The end of a fault: the controller itself stays as it is.
fn clear(cell: &Cell) {
    cell.say(json!({ "do": "clear" }));
    cell.say(json!({ "do": "r3", "state": "accept" }));
}

/// Drives into the fault and looks what becomes of the arm.
fn meet(name: &str, fault: &Value, outcome: Outcome, speed: f64) {
    let mut cell = Cell::open(json!({ "r3_lost_ms": 300.0 }));
    cell.drive(speed, 0.25)
        .unwrap_or_else(|error| panic!("{name}, before: {error}"));
    cell.reset_peaks();
    cell.say(fault.clone());
    let met = cell.drive(speed, 0.5);
    cell.arm.stop().unwrap();
    let stopped_s = cell.state()["time_s"].as_f64().unwrap();
    // By the emulator's own clock, which a busy machine delays.
    let state = loop {
        wait(20);
        let state = cell.state();
        if state["time_s"].as_f64().unwrap() > stopped_s + 0.25 {
            break state;
        }
    };
    let peaks = &state["peaks"];
    println!(
        "{name} at {speed} m/s: {:?}; rest after {:?} s, acceleration {:.1} (smooth {:.1}) m/s², step {:.3} mm, {}",
        met.as_ref().err().map(ToString::to_string),
        state["rest_after_fault_s"],
        peaks["tool_acceleration_m_s2"].as_f64().unwrap(),
        peaks["tool_smooth_acceleration_m_s2"].as_f64().unwrap(),
        peaks["tool_step_m"].as_f64().unwrap() * 1e3,
        cell.arm.stats()
    );
    assert_eq!(
        state["at_rest"],
        true,
        "{name}: the arm still moves, {:?}, {state}",
        cell.arm.phase()
    );
    // The driver's ramp, or the controller holding the last target through its filter, or its own
    // stop; what a packet on the wrong side of a cycle adds is averaged out.
    let most = RAMP_M_S2.max(speed / FILTER_S) * 1.2;
    let smooth = peaks["tool_smooth_acceleration_m_s2"].as_f64().unwrap();
    assert!(
        smooth <= most,
        "{name}: {smooth} m/s² over 20 ms, {most} allowed"
    );
    let step = peaks["tool_step_m"].as_f64().unwrap();
    assert!(
        step <= MOST_STEPS * speed * CYCLE_S,
        "{name}: the tool went {step} m in one cycle"
    );

    match (outcome, &met) {
        (Outcome::GoesOn, Ok(())) | (Outcome::Either, _) => {}
        (Outcome::Passes(words) | Outcome::Ends(words), Err(error)) => {
            let told = error.to_string();
            let later = cell.arm.read().map_err(|error| error.to_string()).err();
            let told = later.unwrap_or(told);
            assert!(
                told.contains(words),
                "{name}: `{told}` should hold `{words}`"
            );
        }
        _ => panic!("{name}: {met:?}, but {outcome:?}"),
    }
    nothing_resumes(name, &mut cell, outcome, speed);
}

fn nothing_resumes(name: &str, cell: &mut Cell, outcome: Outcome, speed: f64) {
    let rested = cell.tool_m();
    clear(cell);
    wait(500);
    let moved = (cell.tool_m() - rested).norm();
    assert!(moved < 1e-5, "{name}: moved by itself by {moved} m");
    if let Outcome::Ends(_) = outcome {
        assert!(
            cell.drive(speed, 0.1).is_err(),
            "{name}: took a command after a safety stop"
        );
        assert_eq!(cell.arm.phase(), Phase::Ended);
        let moved = (cell.tool_m() - rested).norm();
        assert!(moved < 1e-5, "{name}: moved by {moved} m");
        return;
    }
    assert_eq!(
        cell.arm.read().unwrap().status,
        DriverStatus::Stopped,
        "{name}"
    );
    cell.reset_peaks();
    cell.drive(speed, 0.2)
        .unwrap_or_else(|error| panic!("{name}, afterwards: {error}"));
    wait(150);
    let state = cell.state();
    let went = (cell.tool_m() - rested).dot(&cell.opening);
    assert!(
        went > 0.5 * 0.2 * speed,
        "{name}: a new command moved it by {went} m"
    );
    let step = state["peaks"]["tool_step_m"].as_f64().unwrap();
    assert!(
        step <= MOST_STEPS * speed * CYCLE_S,
        "{name}: a jump of {step} m after the fault"
    );
}

#[test]
fn every_fault_at_the_safe_speed() {
    for (name, fault, outcome) in cases() {
        steadily(name, || meet(name, &fault, outcome, 0.05));
    }
}

#[test]
fn faults_of_the_link_at_the_high_speed() {
    for (name, fault, outcome) in cases() {
        let hard = [
            "1 in 5 lost",
            "bursts lost",
            "MXT silent",
            "all dropped",
            "alarm",
        ];
        if hard.contains(&name) {
            steadily(name, || meet(name, &fault, outcome, 0.15));
        }
    }
}
