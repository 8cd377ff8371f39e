//! Recurrent policies: what is written reads back, and computes what the trainer computed.
#![allow(clippy::unwrap_used)]

mod common;

use common::{contract, episode_logits, inputs, network, recurrent};
use pubs_policy::onnx::Model;
use pubs_policy::{
    Contract, Existing, ExportError, FeatureName, Method, Network, Reference, RunError, Runtime,
    State, write,
};

#[test]
fn random_networks_compute_the_same_after_writing() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    for lstm in [&[1][..], &[7], &[256], &[256, 256], &[5, 3, 9]] {
        let network = recurrent(4, lstm);
        let (file, _) = common::written(directory.path(), &network, &runtime);
        assert_eq!(
            file.contract(),
            Some(&contract(&network)),
            "contract of {lstm:?}"
        );
        let mut policy = file.open(&runtime).unwrap();
        let width = 2 * lstm.iter().sum::<usize>();
        assert_eq!((policy.state_width(), file.state_width()), (width, width));
        for episodes in [1, 6] {
            let (logits, state) = common::worst_over_steps(&mut policy, &network, episodes, 50);
            assert!(
                logits < 1e-4 && state < 1e-4,
                "{lstm:?}, {episodes} episodes: logits differ by {logits}, states by {state}"
            );
        }
    }
}

#[test]
fn the_file_says_what_its_state_is() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let network = recurrent(3, &[4, 6]);
    let (_, bytes) = common::written(directory.path(), &network, &runtime);
    let model = Model::read(&bytes).unwrap();
    assert_eq!((model.ir_version, model.opset), (8, 17));
    let shapes = |values: &[pubs_policy::onnx::ValueInfo]| -> Vec<(String, Option<u64>)> {
        values
            .iter()
            .map(|value| (value.name.clone(), value.shape.as_ref().unwrap()[1]))
            .collect()
    };
    let named = |pairs: [(&str, u64); 2]| pairs.map(|(name, width)| (name.to_owned(), Some(width)));
    assert_eq!(
        shapes(&model.inputs),
        named([("belief", 3), ("state_in", 20)])
    );
    assert_eq!(
        shapes(&model.outputs),
        named([("logits", 5), ("state_out", 20)])
    );
    assert_eq!(model.metadata["pubs.format_version"], "2");
    assert_eq!(model.metadata["pubs.state"], r#"{"lstm":[4,6]}"#);
}

#[test]
fn readings_and_method_read_back() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let mut network = recurrent(3, &[4]);
    network.inputs[0].name = FeatureName::Reading("f_d".into());
    network.inputs[0].unit = "N".into();
    network.inputs[1].name = FeatureName::RandomEntropy;
    network.inputs[2].name = FeatureName::Goal;
    let mut contract = contract(&network);
    contract.method = Method::Lstm1;
    let inputs = inputs(1, &network, 20);
    let reference = Reference {
        inputs: &inputs,
        logits: &episode_logits(&network, &inputs, 10),
        steps: 10,
    };
    let path = directory.path().join("door2.onnx");
    let file = write(
        &path,
        &network,
        &contract,
        reference,
        &runtime,
        Existing::Keep,
    )
    .unwrap();
    assert_eq!(file.contract(), Some(&contract));
    let model = Model::read(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(model.metadata["pubs.method"], "\"lstm1\"");
    let inputs = &model.metadata["pubs.inputs"];
    for word in ["\"reading.f_d\"", "\"N\"", "\"random_entropy\"", "\"goal\""] {
        assert!(inputs.contains(word), "{inputs} lacks {word}");
    }
}

#[test]
fn an_export_that_is_not_what_was_trained_leaves_nothing() {
    type Spoil = fn(&mut Network, &mut Contract, &mut Vec<f32>, &mut usize);
    let cases: [(Spoil, &str); 8] = [
        (
            // The last step of the first episode.
            |_, _, logits, _| logits[9 * 5] += 2e-4,
            "does not compute what was trained: at step 9",
        ),
        (
            |_, _, _, steps| *steps = 20,
            "does not compute what was trained: at step 10",
        ),
        (|_, _, _, steps| *steps = 1, "episodes of two steps or more"),
        (
            |_, _, _, steps| *steps = 7,
            "not whole rows of both, 7 to an episode",
        ),
        (
            |_, _, _, steps| *steps = 0,
            "not whole rows of both, 0 to an episode",
        ),
        (
            |network, _, _, _| network.lstm[0].weights_hidden[1] = f32::NAN,
            "training diverged",
        ),
        (
            |_, contract, _, _| contract.state = Some(State { lstm: vec![6, 4] }),
            "says another state than the network has",
        ),
        (
            |_, contract, _, _| contract.format_version = 1,
            "has version 1, but is one with a state, which is version 2",
        ),
    ];
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("door2.onnx");
    for (spoil, part) in cases {
        let mut network = recurrent(1, &[4, 6]);
        let mut contract = contract(&network);
        let inputs = inputs(1, &network, 20);
        let mut steps = 10;
        let mut logits = episode_logits(&network, &inputs, steps);
        spoil(&mut network, &mut contract, &mut logits, &mut steps);
        let reference = Reference {
            inputs: &inputs,
            logits: &logits,
            steps,
        };
        let fault: ExportError = write(
            &path,
            &network,
            &contract,
            reference,
            &runtime,
            Existing::Keep,
        )
        .unwrap_err();
        let fault = fault.to_string();
        assert!(fault.contains(part), "{fault:?} lacks {part:?}");
        let left = std::fs::read_dir(directory.path()).unwrap().count();
        assert_eq!(left, 0, "{part}: something is left");
    }
}

#[test]
fn a_state_that_does_not_fit_is_refused_and_kept() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let network = recurrent(1, &[2]);
    let (file, _) = common::written(directory.path(), &network, &runtime);
    let mut policy = file.open(&runtime).unwrap();
    let mut out = vec![1.0];
    let fault = policy.logits(&[0.0; 3], 1, &mut out).unwrap_err();
    assert_eq!(fault, RunError::Recurrent { width: 4 });
    assert!(out.is_empty(), "old logits must not stay");

    let cases: [(&mut [f32], &str); 4] = [
        (&mut [], "a state of 0 numbers is not 2 rows of 4"),
        (&mut [0.0; 4], "a state of 4 numbers is not 2 rows of 4"),
        (
            &mut [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0],
            "number 2 of the state of row 1 is NaN",
        ),
        (
            &mut [0.5, f32::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            "number 1 of the state of row 0 is inf",
        ),
    ];
    for (state, part) in cases {
        let before = state.to_vec();
        out.push(1.0);
        let fault = policy
            .logits_with_state(&[0.0; 6], 2, state, &mut out)
            .unwrap_err();
        assert_eq!(fault.to_string(), part);
        assert!(out.is_empty(), "{part}: old logits must not stay");
        let same = state
            .iter()
            .zip(&before)
            .all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{part}: the state has changed");
    }
    let mut state = [0.25; 4];
    let fault = policy.logits_with_state(&[0.0, f32::NAN, 0.0], 1, &mut state, &mut out);
    assert!(matches!(
        fault,
        Err(RunError::Input {
            row: 0,
            feature: 1,
            ..
        })
    ));
    assert_eq!(state, [0.25; 4], "a step that failed must not be taken");
}

#[test]
fn a_perceptron_runs_with_an_empty_state() {
    let runtime = Runtime::tract().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let network = network(1, &[3, 4, 5]);
    let (file, _) = common::written(directory.path(), &network, &runtime);
    let mut policy = file.open(&runtime).unwrap();
    assert_eq!(policy.state_width(), 0);
    let inputs = inputs(2, &network, 7);
    let (mut plain, mut stateful) = (Vec::new(), Vec::new());
    policy.logits(&inputs, 7, &mut plain).unwrap();
    policy
        .logits_with_state(&inputs, 7, &mut [], &mut stateful)
        .unwrap();
    assert_eq!(plain, stateful);
    let fault = policy
        .logits_with_state(&inputs, 7, &mut [0.0], &mut stateful)
        .unwrap_err();
    assert_eq!(fault.to_string(), "a state of 1 numbers is not 7 rows of 0");
}
