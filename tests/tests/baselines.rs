//! Baselines and ablations, from training to the arm (§IV-B, §IV-D).
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::path::Path;

use common::{Answer, door2, door2_policy, pubs, words};
use serde_json::Value;

fn with_door(folder: &Path, verb: &str, extra: &str) -> Answer {
    let object = door2();
    let mut arguments = vec![verb, object.as_str()];
    arguments.extend(words(extra));
    pubs(folder, &arguments)
}

fn evaluate(folder: &Path, policies: &[&str], extra: &str) -> Answer {
    let object = door2();
    let mut arguments = vec!["evaluate", "--object", object.as_str()];
    arguments.extend(policies);
    arguments.extend(words(extra));
    pubs(folder, &arguments)
}

#[test]
fn baselines_are_trained_judged_and_run_on_the_arm() {
    // Two updates of each: what is learnt does not matter here. The LSTM takes most of the time.
    for (method, steps) in [("ppo", 4096), ("lstm1", 4096), ("lstm2", 2048)] {
        let folder = tempfile::tempdir().unwrap();
        let line =
            format!("--goal 0.5 --method {method} --steps {steps} --seeds 1 --trials 20 --json");
        let report = with_door(folder.path(), "train", &format!("{line} -o one.onnx"));
        let report = report.assert_code(0).json();
        assert_eq!(report["method"], method);
        assert_eq!(
            report["evaluation"]["coverage_90"],
            Value::Null,
            "{method} has no belief"
        );

        let judged = evaluate(folder.path(), &["one.onnx"], "--trials 40 --json");
        let judged = judged.assert_code(0).json();
        assert_eq!(judged["trials"], 40);
        assert_eq!(judged["coverage_90"], Value::Null);
        assert_eq!(
            judged["shield"], false,
            "{method}: a shield looks at a belief"
        );

        let line =
            "--goal 0.5 --policy one.onnx --lockstep --max-steps 30 --seed 3 --json --no-record";
        let run = || {
            let answer = with_door(folder.path(), "run", line);
            assert!(
                [0, 3, 4].contains(&answer.code),
                "{method}: {}",
                answer.stderr
            );
            answer.stdout
        };
        assert_eq!(
            run(),
            run(),
            "{method}: a lockstep run is the same each time"
        );
    }
}

#[test]
fn ablations_read_what_their_names_say() {
    for (entropy, inputs) in [("random", "random_entropy"), ("none", "mean_state")] {
        let folder = tempfile::tempdir().unwrap();
        let line = format!(
            "--goal 0.5 --entropy {entropy} --steps 4096 --seeds 1 --trials 20 -o one.onnx"
        );
        with_door(folder.path(), "train", &line).assert_code(0);
        let bytes = std::fs::read(folder.path().join("one.onnx")).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(
            text.contains(inputs),
            "{entropy}: the file names no {inputs}"
        );
        assert!(
            !text.contains("\"name\":\"entropy\""),
            "{entropy} reads the entropy"
        );

        let judge = || {
            let answer = evaluate(folder.path(), &["one.onnx"], "--trials 100 --json");
            let report = answer.assert_code(0).json();
            (report["mean_reward"].clone(), report["coverage_90"].clone())
        };
        let (first, second) = (judge(), judge());
        assert_eq!(
            first, second,
            "{entropy}: what is drawn follows from the seed"
        );
        assert!(first.1.is_number(), "the belief is there all the same");
    }
}

#[test]
fn several_policies_are_judged_on_the_same_trials() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = door2_policy();
    let line = "--goal 0.5 --trials 200 --json";
    let both = evaluate(folder.path(), &[&shipped, &shipped], line);
    let both = both.assert_code(0).json();
    let evaluations = both["evaluations"].as_array().unwrap();
    assert_eq!(evaluations.len(), 2);
    let alone = evaluate(folder.path(), &[&shipped], line)
        .assert_code(0)
        .json();
    for field in ["mean_reward", "mean_steps", "success_rate", "coverage_90"] {
        for one in evaluations {
            assert_eq!(one[field], alone[field], "{field}");
        }
    }
}

#[test]
fn the_belief_runs_at_the_asked_frequency() {
    let folder = tempfile::tempdir().unwrap();
    let line = "--goal 0.5 --belief-frequency 5 --steps 4096 --seeds 1 --trials 20 -o fast.onnx";
    with_door(folder.path(), "train", line).assert_code(0);
    // Trained for five updates per policy step, it is another task than the object file's three.
    let refused = evaluate(folder.path(), &["fast.onnx"], "--trials 20");
    refused
        .assert_code(5)
        .assert_says(&["another task", "rate_hz"]);
    let taken = evaluate(
        folder.path(),
        &["fast.onnx"],
        "--trials 20 --belief-frequency 5",
    );
    taken.assert_code(0);
    let line = "--goal 0.5 --belief-frequency 20 --lockstep";
    let refused = with_door(folder.path(), "run", line);
    refused
        .assert_code(2)
        .assert_says(&["above the controller's 100 Hz"]);
}

#[test]
fn unknown_words_list_the_known() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("--method lstm3", ["lstm3", "lstm2"]),
        ("--entropy some", ["some", "random"]),
        ("--recipe best", ["best", "standard"]),
        (
            "--method ppo --entropy none",
            ["--entropy none", "reads no belief"],
        ),
    ];
    for (line, expected) in cases {
        let answer = with_door(folder.path(), "train", line);
        answer.assert_code(2).assert_says(&expected);
    }
}
