//! The figures of the MELFA driver over the emulator, in real time:
//! `cargo bench -p pubs-tests --bench melfa -- table4 20`, `… -- pacing`, `… -- faults 5`.
#![allow(clippy::unwrap_used, missing_docs, reason = "a bench may fail")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/emulator.rs"]
mod emulator;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use emulator::{Emulator, Running, run_words};
use serde_json::{Value, json};

const OBJECTS: [&str; 4] = ["drawer1", "drawer2", "door1", "door2"];

fn main() {
    let words: Vec<String> = std::env::args().filter(|word| word != "--bench").collect();
    let number = |default| {
        words
            .get(2)
            .and_then(|word| word.parse().ok())
            .unwrap_or(default)
    };
    match words.get(1).map(String::as_str) {
        Some("table4") => table4(number(20)),
        Some("pacing") => pacing(),
        Some("faults") => faults(number(5)),
        _ => println!("name one of: table4 [TRIALS], pacing, faults [TRIALS]"),
    }
}

/// Even numbers from a seed, the same each time: splitmix64.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Joint state and goal are compared as Table IV does.
fn reached(object: &str, joint_state: f64, report: &Value) -> bool {
    let tolerance = if object.starts_with("drawer") {
        0.02
    } else {
        10_f64.to_radians()
    };
    (joint_state - report["goal"].as_f64().unwrap_or(f64::NAN)).abs() <= tolerance
}

fn table4(trials: u32) {
    println!(
        "| object | trials | emulator: reached | stopped | virtual arm: reached | time, emulator / virtual arm |"
    );
    println!("|---|---|---|---|---|---|");
    for object in OBJECTS {
        let policy = format!("paper/{object}-0.5.onnx");
        let mut draws = Draws(2_024);
        let (mut over, mut stopped, mut direct) = (0, 0, 0);
        let mut times_s = [0.0; 2];
        for seed in 1..=trials {
            let world = World {
                start: draws.next(),
                friction: 0.8 + 0.4 * draws.next(),
                catch: 0.8 + 0.4 * draws.next(),
                seed,
            };
            match over_emulator(object, &policy, &world) {
                Some((reached, time_s)) => {
                    over += u32::from(reached);
                    times_s[0] += time_s;
                }
                None => stopped += 1,
            }
            let words = run_words(object, &policy, &["0.5"], &world.settings());
            let told = Running::start(&words).end().json();
            direct += u32::from(told["outcome"] == "reached");
            times_s[1] += told["time_s"].as_f64().unwrap_or(0.0);
        }
        let emulator_s = times_s[0] / f64::from(trials - stopped);
        let direct_s = times_s[1] / f64::from(trials);
        println!(
            "| {object} | {trials} | {over} | {stopped} | {direct} | {emulator_s:.1} s / {direct_s:.1} s |"
        );
    }
}

/// What is true in one trial.
struct World {
    start: f64,
    friction: f64,
    catch: f64,
    seed: u32,
}

impl World {
    /// For `run` with the virtual arm.
    fn settings(&self) -> Vec<String> {
        let set = |key: &str, value: f64| format!("driver.params.{key}={value}");
        let params = [
            set("start", self.start),
            set("friction_scale", self.friction),
            set("catch_scale", self.catch),
        ];
        let seed = ["--seed".to_owned(), self.seed.to_string()];
        let sets = params.into_iter().flat_map(|set| ["--set".to_owned(), set]);
        sets.chain(seed).collect()
    }

    /// For the emulator.
    fn options(&self, object: &str) -> Vec<String> {
        let options = [
            ("--world", object.to_owned()),
            ("--start", self.start.to_string()),
            ("--seed", self.seed.to_string()),
            ("--friction-scale", self.friction.to_string()),
            ("--catch-scale", self.catch.to_string()),
        ];
        let words = options
            .into_iter()
            .flat_map(|(name, value)| [name.to_owned(), value]);
        words.collect()
    }
}

/// Whether the goal was truly reached, and the time of the run, s; `None` where it was stopped, or
/// could not begin and so prints nothing.
fn over_emulator(object: &str, policy: &str, world: &World) -> Option<(bool, f64)> {
    let options = world.options(object);
    let options: Vec<&str> = options.iter().map(String::as_str).collect();
    let mut emulator = Emulator::start(&options);
    let words = run_words(object, policy, &["0.5"], &emulator.settings());
    let answer = Running::start(&words).end();
    if ![0, 3].contains(&answer.code) {
        eprintln!("{object}, seed {}: {}", world.seed, answer.stderr.trim());
        return None;
    }
    let told = answer.json();
    let joint = emulator.state()["object"]["joint_state"].as_f64().unwrap();
    let reached = answer.code == 0 && reached(object, joint, &told);
    Some((reached, told["time_s"].as_f64().unwrap_or(f64::NAN)))
}

/// A minute to and fro, with both cores idle and with both busy: the driver's own figures.
fn pacing() {
    let goals: Vec<&str> = ["0.8", "0.2"].into_iter().cycle().take(24).collect();
    for busy in [0, 2] {
        let end = Arc::new(AtomicBool::new(false));
        let burners: Vec<_> = (0..busy)
            .map(|_| {
                let end = Arc::clone(&end);
                thread::spawn(move || {
                    while !end.load(Ordering::Relaxed) {
                        std::hint::spin_loop()
                    }
                })
            })
            .collect();
        let mut emulator = Emulator::start(&["--world", "door2", "--start", "0.5", "--seed", "1"]);
        let begun = Instant::now();
        let words = run_words("door2", "door2.onnx", &goals, &emulator.settings());
        let answer = Running::start(&words).end();
        let time_s = begun.elapsed().as_secs_f64();
        end.store(true, Ordering::Relaxed);
        burners
            .into_iter()
            .for_each(|burner| burner.join().unwrap());
        println!("busy threads {busy}, {time_s:.0} s, code {}", answer.code);
        for line in answer
            .stderr
            .lines()
            .filter(|line| line.contains("per reply"))
        {
            println!("  {line}");
        }
        println!("  engine: {}", answer.json()["lateness"]);
        println!("  emulator: {}", emulator.state()["lateness"]);
    }
}

/// What goes wrong.
enum Fault {
    /// Said to the emulator.
    Told(Value),
    /// A signal to the engine's process, taken back after a second where that can be.
    Sent(i32),
}

fn all_faults() -> Vec<(&'static str, Fault)> {
    let told = |fault| Fault::Told(fault);
    vec![
        (
            "1 packet in 100 lost",
            told(json!({"do": "drop", "probability": 0.01})),
        ),
        (
            "1 packet in 5 lost",
            told(json!({"do": "drop", "probability": 0.2})),
        ),
        (
            "bursts of 40 lost",
            told(json!({"do": "drop", "probability": 0.01, "burst": 40})),
        ),
        (
            "delayed by 20 ± 10 ms",
            told(json!({"do": "delay", "ms": 20, "jitter_ms": 10})),
        ),
        (
            "1 in 5 twice",
            told(json!({"do": "duplicate", "probability": 0.2})),
        ),
        (
            "1 in 5 out of order",
            told(json!({"do": "reorder", "probability": 0.2})),
        ),
        (
            "1 in 5 cut short",
            told(json!({"do": "short", "probability": 0.2})),
        ),
        (
            "50 from a stranger",
            told(json!({"do": "stranger", "count": 50, "service": "mxt"})),
        ),
        (
            "monitor silent",
            told(json!({"do": "silent", "service": "monitor"})),
        ),
        (
            "MXT silent",
            told(json!({"do": "silent", "service": "mxt"})),
        ),
        ("alarm", told(json!({"do": "alarm", "number": 2800}))),
        ("emergency stop", told(json!({"do": "emergency_stop"}))),
        ("contact stop", told(json!({"do": "contact_stop"}))),
        ("R3 closed", told(json!({"do": "r3", "state": "close"}))),
        (
            "R3 closed and refused",
            told(json!({"do": "r3", "state": "refuse"})),
        ),
        ("engine paused 1 s", Fault::Sent(libc::SIGSTOP)),
        ("engine killed", Fault::Sent(libc::SIGKILL)),
    ]
}

/// How a run with a fault went.
struct Suffered {
    /// Exit code; `None` of a process that was killed.
    code: Option<i32>,
    rested: bool,
    acceleration_m_s2: f64,
    /// From the fault to rest, s; `None` where the run went on.
    rest_s: Option<f64>,
}

/// Each fault while the arm moves: how often it came to rest, how hard and how soon.
fn faults(trials: u32) {
    println!(
        "| fault | trials | at rest after | exit codes | largest acceleration (20 ms), m/s² | fault to rest, s |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, fault) in all_faults() {
        let suffered: Vec<_> = (1..=trials).map(|seed| suffer(&fault, seed)).collect();
        let rested = suffered.iter().filter(|trial| trial.rested).count();
        let mut codes: Vec<_> = suffered.iter().filter_map(|trial| trial.code).collect();
        codes.sort_unstable();
        let hardest = suffered.iter().map(|trial| trial.acceleration_m_s2);
        let hardest = hardest.fold(0.0, f64::max);
        let longest = suffered.iter().filter_map(|trial| trial.rest_s);
        let longest = longest.reduce(f64::max);
        let longest = longest.map_or_else(|| "goes on".to_owned(), |rest_s| format!("{rest_s:.2}"));
        println!("| {name} | {trials} | {rested} | {codes:?} | {hardest:.1} | {longest} |");
    }
}

fn suffer(fault: &Fault, seed: u32) -> Suffered {
    let seed = seed.to_string();
    let mut emulator = Emulator::start(&["--world", "door2", "--start", "0.2", "--seed", &seed]);
    let words = run_words("door2", "door2.onnx", &["0.8", "0.3"], &emulator.settings());
    let running = Running::start(&words);
    emulator.wait_for_motion();
    emulator.tell(&json!({ "do": "reset_peaks" }));
    let begun = Instant::now();
    let rests = |state: &Value| state["at_rest"] == true;
    let (code, rested, rest_s) = match fault {
        Fault::Told(fault) => {
            emulator.tell(fault);
            let code = running.end().code;
            let rested = emulator.wait(2.0, rests);
            let rest_s = emulator.state()["rest_after_fault_s"].as_f64();
            // A run that survives the fault ends with its goals, not with the fault.
            (
                Some(code),
                rested,
                rest_s.filter(|_| [1, 4].contains(&code)),
            )
        }
        Fault::Sent(signal) => {
            running.signal(*signal);
            let rested = emulator.wait(2.0, rests);
            let rest_s = begun.elapsed().as_secs_f64();
            thread::sleep(Duration::from_secs(1));
            if *signal == libc::SIGSTOP {
                running.signal(libc::SIGCONT);
                (Some(running.end().code), rested, Some(rest_s))
            } else {
                (None, rested, Some(rest_s))
            }
        }
    };
    let peaks = &emulator.state()["peaks"];
    let acceleration = peaks["tool_smooth_acceleration_m_s2"].as_f64();
    Suffered {
        code,
        rested,
        acceleration_m_s2: acceleration.unwrap_or(f64::NAN),
        rest_s,
    }
}
