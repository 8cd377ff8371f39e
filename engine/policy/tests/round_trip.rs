//! What is written reads back, and computes what the trainer computed.
#![allow(clippy::unwrap_used)]

mod common;

use common::{WIDTHS, contract, inputs, logits, network};
use pubs_policy::onnx::Model;
use pubs_policy::{
    Existing, ExportError, FeatureName, Policy, PolicyFile, Reference, RunError, Runtime, State,
    write,
};

#[test]
fn random_networks_compute_the_same_after_writing() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let shapes: [&[usize]; 6] = [
        &WIDTHS,
        &[2, 64, 64, 64, 5],
        &[1, 1],
        &[3, 7],
        &[2, 33, 2],
        &[3, 5, 1, 9, 4],
    ];
    for (seed, widths) in shapes.into_iter().enumerate() {
        let network = network(seed as u64 + 10, widths);
        let (file, _) = common::written(directory.path(), &network, &runtime);
        assert_eq!(
            file.contract(),
            Some(&contract(&network)),
            "contract of {widths:?}"
        );

        let mut policy = file.open(&runtime).unwrap();
        let mut found = Vec::new();
        for rows in [1, 1000, 2, 17, 1, 0] {
            let inputs = inputs(99, &network, rows);
            policy.logits(&inputs, rows, &mut found).unwrap();
            let wanted = logits(&network, &inputs);
            assert_eq!(found.len(), wanted.len(), "{widths:?}, {rows} rows");
            let worst = found
                .iter()
                .zip(&wanted)
                .fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()));
            assert!(
                worst < 2e-5,
                "{widths:?}, {rows} rows: logits differ by {worst}"
            );
        }
    }
}

#[test]
fn every_metadata_key_stands_in_the_file() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let network = network(3, &[2, 4, 5]);
    let (file, bytes) = common::written(directory.path(), &network, &runtime);
    let model = Model::read(&bytes).unwrap();
    assert_eq!((model.ir_version, model.opset), (8, 17));
    assert_eq!(
        model.inputs[0].shape,
        Some(vec![None, Some(2)]),
        "belief [batch, 2]"
    );
    assert_eq!(
        model.outputs[0].shape,
        Some(vec![None, Some(5)]),
        "logits [batch, 5]"
    );

    let expected = [
        (
            "actions",
            r#"["action0","action1","action2","action3","action4"]"#,
        ),
        ("discount", "0.99"),
        ("engine_version", r#""0.1.0""#),
        ("evaluation_reward", "0.875"),
        ("format_version", "1"),
        ("goal", r#"{"fixed":{"fraction":0.5,"value":1.125}}"#),
        (
            "inputs",
            concat!(
                r#"[{"lower":0,"name":"mean_state","offset":1.125,"scale":0.75,"unit":"rad","upper":2.25},"#,
                r#"{"lower":0,"name":"entropy","offset":0.5,"scale":2,"unit":"1","upper":1}]"#
            ),
        ),
        ("object", r#""door2""#),
        ("policy_rate_hz", "10"),
        ("recipe", r#""default""#),
        ("seed", "18446744073709551615"),
        ("shield", r#"{"flattening":0.3,"mass":0.001}"#),
        ("steps", "500000"),
        (
            "task",
            concat!(
                r#"{"actions":[{"name":"stop"},{"name":"safe_open"}],"belief":{"particles":300,"tempering":1},"#,
                r#""control":{"high_speed_m_s":0.15,"rate_hz":100,"safe_speed_m_s":0.05},"#,
                r#""joint":{"lower":0,"type":"revolute","upper":2.25}}"#
            ),
        ),
        ("tolerance", "0.125"),
    ];
    for (name, text) in expected {
        assert_eq!(model.metadata[&format!("pubs.{name}")], text, "pubs.{name}");
    }
    let contract = file.contract().unwrap();
    assert_eq!(
        model.metadata["pubs.task_hash"],
        format!("\"{}\"", contract.task_hash)
    );
    assert_eq!(
        model.metadata["pubs.observation_hash"],
        format!("\"{}\"", "0b5e".repeat(16))
    );
    assert_eq!(
        model.metadata["pubs.sha256"],
        format!("\"{}\"", file.sha256())
    );
    for sum in ["model_sha256", "contract_sha256"] {
        assert_eq!(
            model.metadata[&format!("pubs.{sum}")].len(),
            66,
            "pubs.{sum}"
        );
    }
    assert_eq!(
        model.metadata.len(),
        expected.len() + 5,
        "keys: {:?}",
        model.metadata.keys()
    );
}

#[test]
fn a_file_that_differs_is_kept_unless_told() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("door2.onnx");
    let write_seed = |seed, existing| {
        let network = network(seed, &[2, 4, 5]);
        let inputs = inputs(1, &network, 10);
        let logits = logits(&network, &inputs);
        let reference = Reference {
            inputs: &inputs,
            logits: &logits,
            steps: 1,
        };
        write(
            &path,
            &network,
            &contract(&network),
            reference,
            &runtime,
            existing,
        )
    };
    let first = write_seed(1, Existing::Keep).unwrap();
    let again = write_seed(1, Existing::Keep).unwrap();
    assert_eq!(
        first.sha256(),
        again.sha256(),
        "the same policy may be written twice"
    );
    let fault = write_seed(2, Existing::Keep).unwrap_err();
    assert!(matches!(fault, ExportError::Exists { .. }), "{fault}");
    assert_eq!(
        PolicyFile::read(&path).unwrap().sha256(),
        first.sha256(),
        "the old file must stay"
    );
    let second = write_seed(2, Existing::Replace).unwrap();
    assert_ne!(first.sha256(), second.sha256());
    let names: Vec<_> = std::fs::read_dir(directory.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(names, ["door2.onnx"], "temporary files are left behind");
}

#[test]
fn an_export_that_is_not_what_was_trained_leaves_nothing() {
    type Spoil = fn(&mut pubs_policy::Network, &mut pubs_policy::Contract, &mut Vec<f32>);
    let cases: [(Spoil, &str); 11] = [
        (
            |_, _, logits| logits[7] += 2e-4,
            "does not compute what was trained",
        ),
        (|_, _, logits| _ = logits.pop(), "not whole rows"),
        (
            |network, _, _| network.layers[0].weights[1] = f32::NAN,
            "training diverged",
        ),
        (
            |_, contract, _| _ = contract.actions.pop(),
            "names 4 actions, the network has 5 outputs",
        ),
        (
            |_, contract, _| contract.inputs[0].offset = 0.0,
            "other inputs",
        ),
        (
            |network, contract, _| {
                network.inputs[0].unit = "deg".into();
                contract.inputs.clone_from(&network.inputs);
            },
            "mean_state is in \"deg\", known are rad, m, N, 1",
        ),
        (
            |_, contract, _| contract.evaluation_reward = f64::NAN,
            "evaluation_reward is NaN",
        ),
        (
            |network, contract, _| {
                network.inputs[0].name = FeatureName::Reading("f,d".into());
                contract.inputs.clone_from(&network.inputs);
            },
            "\"reading.f,d\", which does not read back",
        ),
        (
            |_, contract, _| contract.format_version = 2,
            "has version 2, but is one without a state, which is version 1",
        ),
        (
            |_, contract, _| contract.state = Some(State { lstm: vec![4] }),
            "has version 1, but is one with a state, which is version 2",
        ),
        (
            |_, contract, _| {
                contract.format_version = 2;
                contract.state = Some(State { lstm: vec![4] });
            },
            "says another state than the network has",
        ),
    ];
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("door2.onnx");
    for (spoil, part) in cases {
        let mut network = network(1, &[2, 4, 5]);
        let mut contract = contract(&network);
        let inputs = inputs(1, &network, 10);
        let mut logits = logits(&network, &inputs);
        spoil(&mut network, &mut contract, &mut logits);
        let reference = Reference {
            inputs: &inputs,
            logits: &logits,
            steps: 1,
        };
        let fault = write(
            &path,
            &network,
            &contract,
            reference,
            &runtime,
            Existing::Keep,
        );
        let fault = fault.unwrap_err().to_string();
        assert!(fault.contains(part), "{fault:?} lacks {part:?}");
        assert_eq!(
            std::fs::read_dir(directory.path()).unwrap().count(),
            0,
            "{part}: something is left"
        );
    }
}

#[test]
fn numbers_that_are_none_are_refused_on_the_way_in() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = common::written(directory.path(), &network(1, &WIDTHS), &runtime);
    let mut policy = file.open(&runtime).unwrap();
    let mut out = vec![1.0];
    let fault = policy
        .logits(&[0.0, 0.5, 0.0, 0.0, f32::NAN, 0.0], 2, &mut out)
        .unwrap_err();
    assert!(
        matches!(
            fault,
            RunError::Input {
                row: 1,
                feature: 1,
                ..
            }
        ),
        "{fault}"
    );
    assert!(out.is_empty(), "old logits must not stay");
    let fault = policy.logits(&[0.0; 5], 2, &mut out).unwrap_err();
    assert_eq!(
        fault,
        RunError::Length {
            values: 5,
            batch: 2,
            features: 3
        }
    );
    let fault = policy
        .logits(&[f32::INFINITY, 0.0, 0.0], 1, &mut out)
        .unwrap_err();
    assert!(
        matches!(
            fault,
            RunError::Input {
                row: 0,
                feature: 0,
                ..
            }
        ),
        "{fault}"
    );
}

#[test]
fn overflow_in_the_network_is_refused_on_the_way_out() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let mut network = network(1, &[2, 3]);
    network.layers[0].weights.fill(1e30);
    // At the offsets the scaled inputs are zero and the logits the biases.
    let reference = Reference {
        inputs: &[1.125, 0.5],
        logits: &network.layers[0].bias,
        steps: 1,
    };
    let path = directory.path().join("door2.onnx");
    let file = write(
        &path,
        &network,
        &contract(&network),
        reference,
        &runtime,
        Existing::Keep,
    )
    .unwrap();
    let mut policy = file.open(&runtime).unwrap();
    let fault = policy.logits(&[3e10, 0.5], 1, &mut Vec::new()).unwrap_err();
    assert!(
        matches!(
            fault,
            RunError::Logit {
                row: 0,
                action: 0,
                ..
            }
        ),
        "{fault}"
    );
}

#[test]
fn sessions_of_one_file_run_side_by_side() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let network = network(5, &WIDTHS);
    let (file, _) = common::written(directory.path(), &network, &runtime);
    let inputs = inputs(7, &network, 200);
    let run = |mut policy: Policy| {
        let mut out = Vec::new();
        policy.logits(&inputs, 200, &mut out).unwrap();
        out
    };
    let results: Vec<Vec<f32>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| run(file.open(&runtime).unwrap())))
            .collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap())
            .collect()
    });
    assert!(
        results.iter().all(|result| *result == results[0]),
        "threads disagree"
    );
}
