//! The figures of the MELFA driver over the emulator, in real time:
//! `cargo bench -p pubs-tests --bench melfa -- table4 20`, `… -- pacing`, `… -- faults 5`.
#![allow(clippy::unwrap_used, missing_docs, reason = "a bench may fail")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/emulator.rs"]
mod emulator;

use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use common::{Answer, command, path_text, root, shipped_plugins};
use emulator::Emulator;
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

/// A run of the shipped policy for the middle, and for the every-goal one with `goals`.
fn run(object: &str, goals: &[&str], policy: &str, settings: &[String]) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    let file = path_text(&root().join(format!("objects/{object}.toml")));
    let policy = path_text(&root().join("policies").join(policy));
    let plugins = path_text(shipped_plugins());
    let mut words = vec![
        "run",
        &file,
        "--policy",
        &policy,
        "--json",
        "--plugin-dir",
        &plugins,
    ];
    for goal in goals {
        words.extend(["--goal", goal]);
    }
    words.extend(settings.iter().map(String::as_str));
    Answer::of(&mut command(folder.path(), &words))
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
        let (mut over, mut direct, mut stopped) = (0, 0, 0);
        let mut times_s = [0.0; 2];
        for seed in 1..=trials {
            let (start, friction, catch) = (
                draws.next(),
                0.8 + 0.4 * draws.next(),
                0.8 + 0.4 * draws.next(),
            );
            let [seed, start, friction, catch] = [
                seed.to_string(),
                start.to_string(),
                friction.to_string(),
                catch.to_string(),
            ];
            let mut emulator = Emulator::start(&[
                "--world",
                object,
                "--start",
                &start,
                "--seed",
                &seed,
                "--friction-scale",
                &friction,
                "--catch-scale",
                &catch,
            ]);
            let report = run(object, &["0.5"], &policy, &emulator.settings());
            // A run that could not begin prints nothing; it is counted as stopped.
            if report.stdout.is_empty() {
                eprintln!("{object}, seed {seed}: {}", report.stderr.trim());
                stopped += 1;
                continue;
            }
            let told = report.json();
            let joint = emulator.state()["object"]["joint_state"].as_f64().unwrap();
            over += u32::from(reached(object, joint, &told) && report.code == 0);
            stopped += u32::from(![0, 3].contains(&report.code));
            times_s[0] += told["time_s"].as_f64().unwrap_or(0.0);
            drop(emulator);
            let set = |key: &str, value: &str| {
                ["--set".to_owned(), format!("driver.params.{key}={value}")]
            };
            let settings: Vec<String> = [
                set("start", &start),
                set("friction_scale", &friction),
                set("catch_scale", &catch),
                ["--seed".to_owned(), seed],
            ]
            .into_iter()
            .flatten()
            .collect();
            let told = run(object, &["0.5"], &policy, &settings).json();
            direct += u32::from(told["outcome"] == "reached");
            times_s[1] += told["time_s"].as_f64().unwrap_or(0.0);
        }
        let [emulator_s, direct_s] = times_s.map(|sum| sum / f64::from(trials));
        println!(
            "| {object} | {trials} | {over} | {stopped} | {direct} | {emulator_s:.1} s / {direct_s:.1} s |"
        );
    }
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
        let answer = run("door2", &goals, "door2.onnx", &emulator.settings());
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

/// Each fault while the arm moves: how often it came to rest, how hard and how soon.
fn faults(trials: u32) {
    let faults = [
        (
            "1 packet in 100 lost",
            json!({"do": "drop", "probability": 0.01}),
        ),
        (
            "1 packet in 5 lost",
            json!({"do": "drop", "probability": 0.2}),
        ),
        (
            "bursts of 40 lost",
            json!({"do": "drop", "probability": 0.01, "burst": 40}),
        ),
        (
            "delayed by 20 ± 10 ms",
            json!({"do": "delay", "ms": 20, "jitter_ms": 10}),
        ),
        (
            "1 in 5 twice",
            json!({"do": "duplicate", "probability": 0.2}),
        ),
        (
            "1 in 5 out of order",
            json!({"do": "reorder", "probability": 0.2}),
        ),
        (
            "1 in 5 cut short",
            json!({"do": "short", "probability": 0.2}),
        ),
        (
            "50 from a stranger",
            json!({"do": "stranger", "count": 50, "service": "mxt"}),
        ),
        (
            "monitor silent",
            json!({"do": "silent", "service": "monitor"}),
        ),
        ("MXT silent", json!({"do": "silent", "service": "mxt"})),
        ("alarm", json!({"do": "alarm", "number": 2800})),
        ("emergency stop", json!({"do": "emergency_stop"})),
        ("contact stop", json!({"do": "contact_stop"})),
        ("R3 closed", json!({"do": "r3", "state": "close"})),
        (
            "R3 closed and refused",
            json!({"do": "r3", "state": "refuse"}),
        ),
    ];
    println!(
        "| fault | trials | at rest after | exit codes | largest acceleration (20 ms), m/s² | fault to rest, s |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, fault) in faults {
        let (mut rested, mut codes) = (0, Vec::new());
        let (mut hardest, mut longest) = (0.0_f64, None::<f64>);
        for seed in 1..=trials {
            let seed = seed.to_string();
            let mut emulator =
                Emulator::start(&["--world", "door2", "--start", "0.2", "--seed", &seed]);
            let settings = emulator.settings();
            let under_way =
                thread::spawn(move || run("door2", &["0.8", "0.3"], "door2.onnx", &settings));
            emulator.wait_for_motion();
            emulator.tell(&json!({ "do": "reset_peaks" }));
            emulator.tell(&fault);
            let answer = under_way.join().unwrap();
            codes.push(answer.code);
            rested += u32::from(emulator.wait(2.0, |state| state["at_rest"] == true));
            let state = emulator.state();
            let peak = state["peaks"]["tool_smooth_acceleration_m_s2"].as_f64();
            hardest = hardest.max(peak.unwrap_or(f64::NAN));
            if let Some(rest_s) = state["rest_after_fault_s"].as_f64() {
                longest = Some(longest.unwrap_or(0.0).max(rest_s));
            }
        }
        codes.sort_unstable();
        // A fault that the run survives ends with its goals, not with the fault.
        let longest = match longest {
            Some(rest_s) if codes.iter().any(|code| [1, 4].contains(code)) => {
                format!("{rest_s:.2}")
            }
            _ => "goes on".to_owned(),
        };
        println!("| {name} | {trials} | {rested} | {codes:?} | {hardest:.1} | {longest} |");
    }
    paused(trials);
}

/// The engine's process stopped for a second, and killed.
fn paused(trials: u32) {
    for (name, signal) in [
        ("engine paused 1 s", libc::SIGSTOP),
        ("engine killed", libc::SIGKILL),
    ] {
        let (mut rested, mut hardest, mut longest) = (0, 0.0_f64, 0.0_f64);
        for seed in 1..=trials {
            let seed = seed.to_string();
            let mut emulator =
                Emulator::start(&["--world", "door2", "--start", "0.2", "--seed", &seed]);
            let folder = tempfile::tempdir().unwrap();
            let file = path_text(&root().join("objects/door2.toml"));
            let policy = path_text(&root().join("policies/door2.onnx"));
            let plugins = path_text(shipped_plugins());
            let mut words = vec![
                "run",
                &file,
                "--policy",
                &policy,
                "--goal",
                "0.8",
                "--plugin-dir",
                &plugins,
            ];
            let settings = emulator.settings();
            words.extend(settings.iter().map(String::as_str));
            let mut process = command(folder.path(), &words)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            emulator.wait_for_motion();
            emulator.tell(&json!({ "do": "reset_peaks" }));
            // SAFETY: a plain system call, to a process that this bench started.
            let send = |signal| unsafe { libc::kill(process.id() as i32, signal) };
            let begun = Instant::now();
            send(signal);
            rested += u32::from(emulator.wait(2.0, |state| state["at_rest"] == true));
            longest = longest.max(begun.elapsed().as_secs_f64());
            thread::sleep(Duration::from_secs(1));
            send(libc::SIGCONT);
            let _ = process.wait();
            let peak = emulator.state()["peaks"]["tool_smooth_acceleration_m_s2"].as_f64();
            hardest = hardest.max(peak.unwrap_or(f64::NAN));
        }
        println!("| {name} | {trials} | {rested} | – | {hardest:.1} | {longest:.2} |");
    }
}
