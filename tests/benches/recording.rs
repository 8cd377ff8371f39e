//! How late the loops of a run are without and with a recording, and with viewers at both live
//! views, in turn: `cargo bench -p pubs-tests --bench recording`. The browser is a real one where
//! Chromium is installed; else the dashboard's viewer only reads.
#![allow(clippy::unwrap_used, missing_docs, reason = "a bench may fail")]

#[path = "../tests/common/browser.rs"]
mod browser;
#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/watched.rs"]
mod watched;

use std::io::Read;
use std::path::Path;
use std::thread;

use browser::Browser;
use serde_json::Value;
use watched::{Foxglove, Watched, port, watch};

const ROUNDS: u32 = 5;
const GOALS: &str = "--goal 0.5 --goal 0.2 --goal 0.8";

/// A run and who watches it.
struct Way {
    name: &'static str,
    options: &'static str,
    viewers: fn(&mut Watched, Option<&Browser>),
}

const WAYS: [Way; 4] = [
    Way {
        name: "nothing",
        options: "--no-record",
        viewers: |_, _| {},
    },
    Way {
        name: "recorded",
        options: "",
        viewers: |_, _| {},
    },
    Way {
        name: "dashboard",
        options: "--dashboard 0 --wait-for-viewer",
        viewers: look,
    },
    Way {
        name: "foxglove",
        options: "--foxglove 0 --wait-for-viewer",
        viewers: |run, _| {
            let address = run.address("foxglove");
            thread::spawn(move || Foxglove::connect(&address).hear_all());
        },
    },
];

fn look(run: &mut Watched, browser: Option<&Browser>) {
    let address = run.address("dashboard");
    match browser {
        Some(browser) => browser.open(&address),
        None => {
            let mut viewer = watch(port(&address), "/events");
            thread::spawn(move || _ = viewer.read_to_end(&mut Vec::new()));
        }
    }
}

fn main() {
    let folder = tempfile::tempdir().unwrap();
    let browser = Browser::start();
    for round in 1..=ROUNDS {
        for way in &WAYS {
            let report = run(folder.path(), way, round, browser.as_ref());
            let late = |name: &str| {
                let late = &report["lateness"][name];
                format!(
                    "{name} p50 {} p99 {} max {} µs, missed {}",
                    late["p50_us"], late["p99_us"], late["max_us"], late["missed"]
                )
            };
            println!(
                "{:<10} {}; {}; {}; {} entries dropped",
                way.name,
                late("controller"),
                late("filter"),
                late("policy"),
                report["recording_dropped"]
            );
        }
    }
}

fn run(folder: &Path, way: &Way, round: u32, browser: Option<&Browser>) -> Value {
    let mut line = format!("{GOALS} {}", way.options);
    if !line.contains("--no-record") {
        line += &format!(" --record {}-{round}.mcap", way.name);
    }
    let mut run = Watched::start(folder, &line);
    (way.viewers)(&mut run, browser);
    let answer = run.end();
    assert!([0, 3].contains(&answer.code), "{}", answer.stderr);
    answer.json()
}
