//! How late the loops of a run are with and without a recording, in turn:
//! `cargo bench -p pubs-tests --bench recording`.
#![allow(clippy::unwrap_used, missing_docs, reason = "a bench may fail")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{door2, door2_policy, pubs, words};

const ROUNDS: u32 = 4;

fn main() {
    let folder = tempfile::tempdir().unwrap();
    let (object, policy) = (door2(), door2_policy());
    for round in 1..=ROUNDS {
        let recorded = format!("--record {round}.mcap");
        for (name, option) in [
            ("recorded", recorded.as_str()),
            ("not recorded", "--no-record"),
        ] {
            let line = format!("--goal 0.5 --goal 0.2 {option}");
            let mut arguments = vec!["run", &object, "--policy", &policy, "--json"];
            arguments.extend(words(&line));
            let answer = pubs(folder.path(), &arguments);
            assert!([0, 3].contains(&answer.code), "{}", answer.stderr);
            let report = answer.json();
            let late = |name: &str| {
                let late = &report["lateness"][name];
                format!(
                    "{name} p50 {} p99 {} max {} µs, missed {}",
                    late["p50_us"], late["p99_us"], late["max_us"], late["missed"]
                )
            };
            println!(
                "{name:<13} {}; {}; {}; {} entries dropped",
                late("controller"),
                late("filter"),
                late("policy"),
                report["recording_dropped"]
            );
        }
    }
}
