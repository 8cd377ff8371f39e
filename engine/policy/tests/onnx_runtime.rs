//! The same files in a real ONNX Runtime; its library is named by `ORT_DYLIB_PATH`. Alone in its process.
#![allow(clippy::unwrap_used)]

mod common;

use std::path::PathBuf;

use common::{WIDTHS, inputs, logits, network, recurrent};
use pubs_policy::{PolicyFile, Runtime, RuntimeError};

#[test]
fn onnx_runtime_computes_the_same() {
    let Some(library) = std::env::var_os("ORT_DYLIB_PATH")
        .filter(|path| !path.is_empty())
        .map(PathBuf::from)
    else {
        eprintln!("skipped: ORT_DYLIB_PATH names no ONNX Runtime library");
        return;
    };
    let runtime = Runtime::onnx_runtime(&library).unwrap();
    assert!(runtime.to_string().contains("ONNX Runtime"), "{runtime}");
    let fault = Runtime::tract().unwrap_err();
    assert!(
        matches!(fault, RuntimeError::AlreadyChosen { .. }),
        "{fault}"
    );

    let directory = tempfile::tempdir().unwrap();
    let network = network(12, &WIDTHS);
    let (file, bytes) = common::written(directory.path(), &network, &runtime);
    let mut policy = file.open(&runtime).unwrap();
    let mut found = Vec::new();
    for rows in [1, 1000, 3] {
        let inputs = inputs(5, &network, rows);
        policy.logits(&inputs, rows, &mut found).unwrap();
        let wanted = logits(&network, &inputs);
        let worst = found
            .iter()
            .zip(&wanted)
            .fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()));
        assert!(worst < 2e-5, "{rows} rows: logits differ by {worst}");
    }

    for lstm in [&[256][..], &[256, 256], &[5, 3]] {
        let network = recurrent(4, lstm);
        let (file, _) = common::written(directory.path(), &network, &runtime);
        let mut policy = file.open(&runtime).unwrap();
        let (logits, state) = common::worst_over_steps(&mut policy, &network, 3, 50);
        assert!(
            logits < 1e-4 && state < 1e-4,
            "{lstm:?}: logits differ by {logits}, states by {state}"
        );
    }

    // A runtime that loads files with flipped bits: the checks before it must not let one through.
    let mut random = common::Random(3);
    let path = directory.path().join("damaged.onnx");
    for _ in 0..300 {
        let (at, bit) = (random.below(bytes.len()), 1 << random.below(8));
        let mut damaged = bytes.clone();
        damaged[at] ^= bit;
        std::fs::write(&path, damaged).unwrap();
        assert!(
            PolicyFile::read(&path).is_err(),
            "flipping {bit:#04x} of byte {at} is not seen"
        );
    }
}
