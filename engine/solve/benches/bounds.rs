//! SARSOP's bounds as time goes by, on the problems that its C++ ancestor was measured on. The time
//! is that of the processor, which a busy machine does not change.
//!
//! `cargo bench -p pubs-solve --bench bounds -- hallway 10`: one problem, or all; seconds by the
//! clock on the wall. A path that ends in `.pomdp` is a problem too.

#[path = "../tests/problems/mod.rs"]
mod problems;

use std::ops::ControlFlow;
use std::time::Duration;

use pubs_solve::{Pomdp, SolveOptions, TrialOptions, parse, simulate, solve};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut words = arguments.iter().filter(|word| !word.starts_with('-'));
    let only = words.next().map(String::as_str);
    let seconds = words.next().and_then(|word| word.parse().ok());
    if let Some(path) = only.filter(|name| name.ends_with(".pomdp")) {
        let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        match parse(&text) {
            Ok(pomdp) => run(path, &pomdp, seconds.unwrap_or(10)),
            Err(faults) => faults.iter().for_each(|fault| println!("{fault}")),
        }
        return;
    }
    type Case = (&'static str, fn() -> Pomdp, u64);
    let cases: [Case; 7] = [
        ("tag", problems::tag, 10),
        ("tiger", || problems::file("tiger"), 1),
        ("hallway", || problems::file("hallway"), 10),
        ("light_dark", problems::light_dark, 28),
        ("sim_object", || problems::sim_object(25), 5),
        (
            "rock_sample",
            || problems::rock_sample(4, &[(0, 0), (1, 3), (2, 1), (3, 2)]),
            5,
        ),
        (
            "rock_sample_7_8",
            || {
                problems::rock_sample(
                    7,
                    &[
                        (2, 0),
                        (0, 1),
                        (3, 1),
                        (6, 3),
                        (2, 4),
                        (3, 4),
                        (5, 5),
                        (1, 6),
                    ],
                )
            },
            30,
        ),
    ];
    for (name, make, limit) in cases {
        if only.is_none_or(|only| only == name) {
            run(name, &make(), seconds.unwrap_or(limit));
        }
    }
}

fn run(name: &str, pomdp: &Pomdp, seconds: u64) {
    println!("{name}: {} states", pomdp.states().len());
    let begun = processor_s();
    let options = SolveOptions {
        timeout: Some(Duration::from_secs(seconds)),
        report_interval: Duration::from_secs(1),
        ..SolveOptions::default()
    };
    let solution = solve(pomdp, &options, |progress| {
        println!(
            "{:7.2} s (processor {:6.2} s)  lower {:9.4}  upper {:9.4}  {:5} vectors  {:6} beliefs  {:5} trials",
            progress.time_s,
            processor_s() - begun,
            progress.lower,
            progress.upper,
            progress.alpha_vectors,
            progress.beliefs,
            progress.trials,
        );
        ControlFlow::Continue(())
    });
    let trials = TrialOptions {
        trials: 10_000,
        max_steps: 250,
        seed: 1,
    };
    let summary = simulate(pomdp, &solution.policy, &trials);
    println!(
        "simulated: {:.4} ± {:.4} discounted, {:.4} ± {:.4}, {:.2} steps, {} of {} ended",
        summary.discounted.mean,
        summary.discounted.standard_error,
        summary.reward.mean,
        summary.reward.standard_error,
        summary.steps.mean,
        summary.ended,
        summary.trials,
    );
}

/// Seconds that this thread has run, where the system says.
fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let first = text.split_whitespace().next();
    first
        .and_then(|word| word.parse::<f64>().ok())
        .unwrap_or(f64::NAN)
        / 1e9
}
