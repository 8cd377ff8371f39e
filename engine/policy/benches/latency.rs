//! Time of one decision and of large batches: `cargo bench -p pubs-policy`, with `ORT_DYLIB_PATH`
//! set for ONNX Runtime. Medians; the plain loops of `Network::forward` stand beside them.
#![allow(clippy::unwrap_used)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::path::PathBuf;
use std::time::Instant;

use common::{WIDTHS, inputs, network, recurrent};
use pubs_policy::{Network, Runtime};

fn main() {
    let library = std::env::var_os("ORT_DYLIB_PATH")
        .filter(|path| !path.is_empty())
        .map(PathBuf::from);
    let runtime = Runtime::from_library(library.as_deref()).unwrap();
    measure("perceptron", &network(1, &WIDTHS), &runtime);
    measure("lstm1", &recurrent(1, &[256]), &runtime);
    measure("lstm2", &recurrent(1, &[256, 256]), &runtime);
}

fn measure(kind: &str, network: &Network, runtime: &Runtime) {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = common::written(directory.path(), network, runtime);
    let opening = report("open the file", 50, 1, || drop(file.open(runtime).unwrap()));
    println!("{kind}, {runtime}: open a checked file, {opening:.0} us");

    let mut policy = file.open(runtime).unwrap();
    let mut out = Vec::new();
    // Recurrent rows take a hundred times as long.
    let share = if network.lstm.is_empty() { 1 } else { 20 };
    for (rows, runs) in [(1, 20_000 / share), (1024, 1_000 / share)] {
        let inputs = inputs(2, network, rows);
        let mut plain = vec![0.0; rows * network.actions()];
        let mut state = vec![0.0; rows * network.state_width()];
        let run = report("runtime", runs, rows, || {
            policy
                .logits_with_state(&inputs, rows, &mut state, &mut out)
                .unwrap()
        });
        let loops = report("plain loops", runs, rows, || {
            network.forward_with_state(&inputs, &mut state, &mut plain)
        });
        println!(
            "{kind}, {runtime}: batch {rows}, {run:.3} us per row; plain loops {loops:.3} us per row"
        );
    }
}

/// Median time per row, µs.
fn report(name: &str, runs: usize, rows: usize, mut run: impl FnMut()) -> f64 {
    for _ in 0..runs / 10 {
        run();
    }
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[(share * (runs - 1) as f64) as usize];
    println!(
        "{name}, {rows} rows: p50 {:.2} us, p99 {:.2} us",
        at(0.5),
        at(0.99)
    );
    at(0.5) / rows as f64
}
