//! The same batch in PyTorch, where that is installed.

use std::collections::HashMap;
use std::io::Write;
use std::process::{Command, Stdio};

use super::*;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pytorch/recurrent.py");

/// What the script exits with where it cannot import PyTorch.
const NOT_INSTALLED: i32 = 3;

#[test]
fn pytorch_finds_the_same() {
    for layers in [1, 2] {
        let lstm = Lstm { layers, width: 18 };
        let learner = with_gradients(VectorUnit::best(), lstm);
        let rollout = samples();
        let Some(answer) = ask(&question(&learner, &rollout, lstm)) else {
            println!("skipped: PyTorch is not installed");
            return;
        };
        for (name, trainee) in [("policy", &learner.policy), ("value", &learner.value)] {
            for (i, gradients) in gradients_of(trainee).into_iter().enumerate() {
                let expected = answer[&format!("{name}_gradient_{i}")].clone();
                assert!(
                    expected.iter().any(|g| *g != 0.0),
                    "{name} array {i}: all 0"
                );
                let what = format!("{lstm:?} {name}, gradients of array {i}");
                assert_close(&[gradients], &[expected], 2e-6, &what);
            }
        }
        let values = outputs(
            &rollout,
            lstm,
            &learner.value.first_states,
            &parameters_of(&learner.value),
        );
        assert_close(
            &[values.concat()],
            &[answer["values"].clone()],
            1e-9,
            "values",
        );
        let logits = logits_of(learner, &rollout).concat();
        assert_close(&[logits], &[answer["logits"].clone()], 2e-6, "logits");
    }
}

/// Lines of a name and numbers, for the script.
fn question(learner: &RecurrentLearner, rollout: &Rollout, lstm: Lstm) -> String {
    let mut text = String::new();
    let mut add = |name: &str, numbers: &[f64]| {
        let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
        text += &format!("{name} {}\n", numbers.join(" "));
    };
    let sizes = [COPIES, LENGTH, FEATURES, ACTIONS, lstm.layers, lstm.width];
    add("sizes", &sizes.map(|size| size as f64));
    let coefficients = [
        UPDATE.clip_range,
        UPDATE.entropy_coefficient,
        UPDATE.value_coefficient,
    ];
    add("coefficients", &in_f64(&coefficients));
    for (name, numbers) in [
        ("features", &rollout.features),
        ("allowed", &rollout.allowed),
        ("taken", &rollout.taken),
        ("log_probabilities", &rollout.log_probabilities),
        ("advantages", &rollout.advantages),
        ("returns", &rollout.returns),
        ("policy_states", &learner.policy.first_states),
        ("value_states", &learner.value.first_states),
    ] {
        add(name, &in_f64(numbers));
    }
    let starts = (0..COPIES * LENGTH).map(|sample| f64::from(u8::from(starts(rollout, sample))));
    add("starts", &starts.collect::<Vec<f64>>());
    for (name, trainee) in [("policy", &learner.policy), ("value", &learner.value)] {
        for (i, array) in parameters_of(trainee).iter().enumerate() {
            add(&format!("{name}_{i}"), array);
        }
    }
    text
}

/// The script's answer, in lines as the question's; `None` where PyTorch is not installed.
fn ask(question: &str) -> Option<HashMap<String, Vec<f64>>> {
    let python = Command::new("python3")
        .arg(SCRIPT)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let mut python = python.ok()?;
    // Where PyTorch is missing the script may end before it has read everything.
    let _ = python.stdin.take().unwrap().write_all(question.as_bytes());
    let output = python.wait_with_output().unwrap();
    if output.status.code() == Some(NOT_INSTALLED) {
        return None;
    }
    assert!(
        output.status.success(),
        "the script ended with {}",
        output.status
    );
    let text = String::from_utf8(output.stdout).unwrap();
    let line = |line: &str| {
        let (name, numbers) = line.split_once(' ').unwrap();
        let numbers = numbers.split(' ').map(|number| number.parse().unwrap());
        (name.to_owned(), numbers.collect())
    };
    Some(text.lines().map(line).collect())
}
