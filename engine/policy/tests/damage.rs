//! A file that is not as it was written is refused, never run.
#![allow(clippy::unwrap_used)]

mod common;

use std::path::Path;

use common::{Random, WIDTHS, network, recurrent};
use pubs_policy::{Fault, PolicyError, PolicyFile, Runtime};

fn read(directory: &Path, bytes: &[u8]) -> Result<PolicyFile, PolicyError> {
    let path = directory.join("damaged.onnx");
    std::fs::write(&path, bytes).unwrap();
    PolicyFile::read(&path)
}

/// A policy's bytes with one run of bytes replaced by another.
fn patched(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let at = bytes
        .windows(from.len())
        .position(|window| window == from)
        .expect("the pattern");
    [&bytes[..at], to, &bytes[at + from.len()..]].concat()
}

#[test]
fn every_truncation_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let (_, bytes) = common::written(
        directory.path(),
        &network(1, &WIDTHS),
        &Runtime::tract().unwrap(),
    );
    let faults: Vec<String> = (0..bytes.len())
        .step_by(97)
        .map(|length| {
            read(directory.path(), &bytes[..length])
                .unwrap_err()
                .to_string()
        })
        .collect();
    assert!(
        faults.iter().all(|fault| fault.contains("damaged.onnx")),
        "a fault without the file's name"
    );
    assert!(faults[0].contains("empty"), "{}", faults[0]);
}

#[test]
fn every_flipped_bit_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let (_, bytes) = common::written(
        directory.path(),
        &network(1, &WIDTHS),
        &Runtime::tract().unwrap(),
    );
    let mut random = Random(20);
    // The metadata is a tenth of the file, so it gets its own share of the flips.
    let metadata = bytes
        .windows(5)
        .position(|window| window == b"pubs.")
        .unwrap();
    let anywhere = (0..300)
        .map(|_| random.below(bytes.len()))
        .collect::<Vec<_>>();
    let in_metadata = (0..300).map(|_| metadata + random.below(bytes.len() - metadata));
    for at in anywhere.into_iter().chain(in_metadata.collect::<Vec<_>>()) {
        let bit = 1 << random.below(8);
        let mut damaged = bytes.clone();
        damaged[at] ^= bit;
        assert!(
            read(directory.path(), &damaged).is_err(),
            "flipping {bit:#04x} of byte {at} is not seen"
        );
    }
}

#[test]
fn faults_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    let (_, bytes) = common::written(
        directory.path(),
        &network(1, &WIDTHS),
        &Runtime::tract().unwrap(),
    );
    let graph = bytes
        .windows(4)
        .position(|window| window == b"Gemm")
        .unwrap();
    let mut flipped_weight = bytes.clone();
    let weights = bytes
        .windows(8)
        .rposition(|window| window == b"weights1")
        .unwrap();
    flipped_weight[weights + 40] ^= 1;
    let twice = [&bytes[..], &bytes].concat();
    let cases = [
        (
            "opset 99",
            patched(
                &bytes,
                b"\x42\x04\x0a\x00\x10\x11",
                b"\x42\x04\x0a\x00\x10\x63",
            ),
            "operator set 99",
        ),
        (
            "ir 99",
            patched(&bytes, b"\x08\x08", b"\x08\x63"),
            "file format 99",
        ),
        ("a weight", flipped_weight, "sha256 of its weights"),
        (
            "an operator",
            patched(&bytes, b"Tanh", b"Tank"),
            "sha256 of its network",
        ),
        (
            "a shield",
            patched(&bytes, b"0.001", b"0.901"),
            "sha256 of its contract",
        ),
        (
            "a contract of a state",
            patched(&bytes, b"version\x12\x011", b"version\x12\x012"),
            "sha256 of its contract",
        ),
        (
            "a newer contract",
            patched(&bytes, b"version\x12\x011", b"version\x12\x019"),
            "use a newer engine",
        ),
        (
            "an older contract",
            patched(&bytes, b"version\x12\x011", b"version\x12\x010"),
            "train it again with this engine",
        ),
        ("no graph", bytes[graph + 10..].to_vec(), "not an ONNX file"),
        ("the file twice", twice, "two file format versions"),
        (
            "text",
            b"[policy]\nrate_hz = 10\n".to_vec(),
            "not an ONNX file",
        ),
        ("empty", Vec::new(), "it is empty"),
    ];
    for (name, bytes, part) in cases {
        let fault = read(directory.path(), &bytes).unwrap_err().to_string();
        assert!(fault.contains(part), "{name}: {fault:?} lacks {part:?}");
    }
}

#[test]
fn damage_to_a_recurrent_policy_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let runtime = Runtime::tract().unwrap();
    let (_, bytes) = common::written(directory.path(), &recurrent(1, &[4, 6]), &runtime);
    let place = |name: &[u8]| {
        let found = bytes.windows(name.len()).rposition(|window| window == name);
        found.expect("the name")
    };
    let mut flipped_weight = bytes.clone();
    flipped_weight[place(b"weights_hidden1") + 40] ^= 1;
    // The widths of the state's parts, of 8 bytes each.
    let mut other_parts = bytes.clone();
    other_parts[place(b"state_parts") + 13] ^= 1;
    let cases = [
        (
            "the input's name",
            patched(&bytes, b"state_in", b"state_im"),
            "sha256 of its network",
        ),
        (
            "an operator",
            patched(&bytes, b"Sigmoid", b"Softmax"),
            "sha256 of its network",
        ),
        ("a weight", flipped_weight, "sha256 of its weights"),
        ("the parts", other_parts, "sha256 of its weights"),
        (
            "the widths",
            patched(&bytes, b"{\"lstm\":[4,6]}", b"{\"lstm\":[6,4]}"),
            "sha256 of its contract",
        ),
        (
            "a perceptron's contract",
            patched(&bytes, b"version\x12\x012", b"version\x12\x011"),
            "sha256 of its contract",
        ),
    ];
    for (name, bytes, part) in cases {
        let fault = read(directory.path(), &bytes).unwrap_err().to_string();
        assert!(fault.contains(part), "{name}: {fault:?} lacks {part:?}");
    }
    let mut random = Random(21);
    for _ in 0..300 {
        let (at, bit) = (random.below(bytes.len()), 1 << random.below(8));
        let mut damaged = bytes.clone();
        damaged[at] ^= bit;
        assert!(
            read(directory.path(), &damaged).is_err(),
            "flipping {bit:#04x} of byte {at} is not seen"
        );
    }
}

#[test]
fn what_is_no_file_is_said_so() {
    let directory = tempfile::tempdir().unwrap();
    let fault = PolicyFile::read(directory.path()).unwrap_err();
    assert!(matches!(fault.fault, Fault::NotAFile), "{fault}");
    let fault = PolicyFile::read(&directory.path().join("nobody.onnx")).unwrap_err();
    assert!(
        matches!(fault.fault, Fault::Read(_)) && fault.to_string().contains("nobody.onnx"),
        "{fault}"
    );
}
