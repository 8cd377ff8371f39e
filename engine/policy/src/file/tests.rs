#![allow(clippy::unwrap_used)]

use std::path::Path;

use super::*;
use crate::common::{contract, inputs, logits, network, recurrent};
use crate::onnx;
use crate::onnx::testing::{Foreign, foreign};

fn open(bytes: Vec<u8>) -> Result<PolicyFile, Fault> {
    PolicyFile::from_bytes(Path::new("a.onnx"), bytes)
}

fn open_foreign(
    bytes: &[u8],
    inputs: &[FeatureName],
    actions: usize,
) -> Result<PolicyFile, PolicyError> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("theirs.onnx");
    std::fs::write(&path, bytes).unwrap();
    PolicyFile::read_foreign(&path, inputs, actions)
}

const TWO: [FeatureName; 2] = [FeatureName::MeanState, FeatureName::Entropy];

#[test]
fn weights_that_are_no_numbers_are_refused_under_a_good_seal() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut network = network(1, &[2, 4, 5]);
        network.layers[1].weights[3] = value;
        let fault = open(seal::encode(&network, &contract(&network)).unwrap()).unwrap_err();
        assert!(matches!(fault, Fault::NotFinite(_)), "{value}: {fault}");
        assert!(
            fault
                .to_string()
                .contains("number 3 of its tensor \"weights1\""),
            "{fault}"
        );
    }
}

#[test]
fn a_graph_that_is_not_as_its_contract_says_is_refused() {
    let network = network(1, &[2, 4, 5]);
    let mut fewer_inputs = contract(&network);
    fewer_inputs.inputs.pop();
    let mut more_actions = contract(&network);
    more_actions.actions.push("sixth".into());
    let mut other_hash = contract(&network);
    other_hash.task_hash = "00".repeat(32);
    let mut no_task = contract(&network);
    no_task.task = "5".into();
    let cases = [
        (fewer_inputs, "shape [any, 2], not [batch, 1]"),
        (more_actions, "shape [any, 5], not [batch, 6]"),
        (other_hash, "says task hash 0000"),
        (no_task, "is no table"),
    ];
    for (contract, part) in cases {
        let fault = open(seal::encode(&network, &contract).unwrap())
            .unwrap_err()
            .to_string();
        assert!(fault.contains(part), "{fault:?} lacks {part:?}");
    }
}

#[test]
fn a_state_that_is_not_as_its_contract_says_is_refused() {
    let (perceptron, recurrent) = (network(1, &[3, 4, 5]), recurrent(1, &[4]));
    let of_widths = |lstm: &[usize]| {
        let mut changed = contract(&recurrent);
        changed.state = Some(State {
            lstm: lstm.to_vec(),
        });
        changed
    };
    let cases = [
        (
            &recurrent,
            of_widths(&[5]),
            "\"state_out\" of shape [any, 8], not [batch, 10]",
        ),
        (&recurrent, of_widths(&[]), "has a state of LSTM layers []"),
        (
            &recurrent,
            of_widths(&[4, 0]),
            "has a state of LSTM layers [4, 0]",
        ),
        (
            &recurrent,
            of_widths(&[usize::MAX, 2]),
            "at most 1048576 numbers",
        ),
        (&recurrent, contract(&perceptron), "has 2 inputs"),
        (
            &perceptron,
            contract(&recurrent),
            "has no output named \"state_out\"",
        ),
    ];
    for (network, contract, part) in cases {
        let fault = open(seal::encode(network, &contract).unwrap())
            .unwrap_err()
            .to_string();
        assert!(fault.contains(part), "{fault:?} lacks {part:?}");
    }
}

#[test]
fn a_foreign_policy_with_a_state_is_refused() {
    let bytes = onnx::write::model(&recurrent(1, &[4]));
    let fault = open_foreign(&bytes, &FeatureName::PLAIN[..3], 5).unwrap_err();
    let part = "carries a state is not supported";
    assert!(fault.to_string().contains(part), "{fault}");
}

#[test]
fn optional_parts_of_a_contract_read_back() {
    let network = network(1, &[3, 5]);
    let mut every = contract(&network);
    every.goal = crate::Goal::Every;
    every.shield = None;
    let file = open(seal::encode(&network, &every).unwrap()).unwrap();
    assert_eq!(file.contract(), Some(&every));
}

#[test]
fn a_file_without_a_contract_runs_only_as_a_foreign_one() {
    let network = network(1, &[2, 4, 5]);
    let bytes = onnx::write::model(&network);
    let fault = open(bytes.clone()).unwrap_err();
    assert!(
        matches!(fault, Fault::NoContract) && fault.to_string().contains("--inputs mean,entropy"),
        "{fault}"
    );

    let runtime = Runtime::tract().unwrap();
    let file = open_foreign(&bytes, &TWO, 5).unwrap();
    let inputs = inputs(1, &network, 9);
    let mut found = Vec::new();
    file.open(&runtime)
        .unwrap()
        .logits(&inputs, 9, &mut found)
        .unwrap();
    for (found, wanted) in found.iter().zip(logits(&network, &inputs)) {
        assert!((found - wanted).abs() < 1e-5, "{found} against {wanted}");
    }
}

#[test]
fn foreign_files_of_many_kinds() {
    let good = Foreign::default();
    let cases: [(&str, Foreign, Result<(), &str>); 14] = [
        ("as it should be", good, Ok(())),
        (
            "one row at a time",
            Foreign {
                batch: Some(1),
                ..good
            },
            Ok(()),
        ),
        (
            "values as numbered fields",
            Foreign {
                listed: true,
                ..good
            },
            Ok(()),
        ),
        ("operator set 13", Foreign { opset: 13, ..good }, Ok(())),
        (
            "operator set 8",
            Foreign { opset: 8, ..good },
            Err("operator set 8"),
        ),
        (
            "operator set 21",
            Foreign { opset: 21, ..good },
            Err("opset_version=17"),
        ),
        (
            "eight rows at a time",
            Foreign {
                batch: Some(8),
                ..good
            },
            Err("takes 8 rows at once"),
        ),
        (
            "another operator domain",
            Foreign {
                domain: "com.microsoft",
                ..good
            },
            Err("com.microsoft"),
        ),
        (
            "two outputs",
            Foreign { outputs: 2, ..good },
            Err("has 2 outputs"),
        ),
        (
            "double precision",
            Foreign {
                element: 11,
                ..good
            },
            Err("not float32"),
        ),
        (
            "half the weights",
            Foreign { missing: 4, ..good },
            Err("of shape [2, 3] has 20 bytes"),
        ),
        (
            "half precision weights",
            Foreign {
                weights: 10,
                ..good
            },
            Err("element type 10"),
        ),
        (
            "weights elsewhere",
            Foreign {
                elsewhere: true,
                ..good
            },
            Err("in another file"),
        ),
        (
            "NaN",
            Foreign {
                value: f32::NAN,
                ..good
            },
            Err("NaN"),
        ),
    ];
    let runtime = Runtime::tract().unwrap();
    for (name, kind, expected) in cases {
        let file = open_foreign(&foreign(kind), &TWO, 3);
        match (file, expected) {
            (Ok(file), Ok(())) => {
                let mut found = Vec::new();
                file.open(&runtime)
                    .unwrap()
                    .logits(&[1.0, 2.0, 0.5, 0.0], 2, &mut found)
                    .unwrap();
                // Each output is value * (x + y).
                assert_eq!(found, [0.75, 0.75, 0.75, 0.125, 0.125, 0.125], "{name}");
            }
            (Err(fault), Err(part)) => assert!(fault.to_string().contains(part), "{name}: {fault}"),
            (file, _) => panic!(
                "{name}: {:?}",
                file.map(|_| ()).map_err(|fault| fault.to_string())
            ),
        }
    }
    let bytes = foreign(good);
    let fault = open_foreign(&bytes, &FeatureName::PLAIN[..3], 3)
        .unwrap_err()
        .to_string();
    assert!(
        fault.contains("shape [any, 2], not [batch, 3]") && fault.contains("theirs.onnx"),
        "{fault}"
    );
    let fault = open_foreign(&bytes, &TWO, 5).unwrap_err().to_string();
    assert!(fault.contains("shape [any, 3], not [batch, 5]"), "{fault}");
}

#[test]
fn policies_written_before_keep_their_contract_byte_for_byte() {
    let folder = std::fs::read_dir("../../policies").unwrap();
    let paths: Vec<_> = folder
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "onnx")
        })
        .collect();
    assert!(!paths.is_empty(), "no policies to read");
    for path in paths {
        let bytes = std::fs::read(&path).unwrap();
        let model = Model::read(&bytes).unwrap();
        let file = PolicyFile::read(&path).unwrap();
        let mut entries = file.contract().unwrap().to_metadata().unwrap();
        let is_sum = |key: &String| key.ends_with("sha256");
        let sums = model.metadata.iter().filter(|(key, _)| is_sum(key));
        entries.extend(sums.map(|(key, sum)| (key.clone(), sum.clone())));
        let written = onnx::write::metadata(&entries);
        assert!(bytes.ends_with(&written), "{}: {entries:?}", path.display());
    }
}
