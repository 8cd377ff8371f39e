//! Policy files: trained, judged, refused.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{Answer, assert_fields, command, door2, door2_policy, pubs, words};
use serde_json::Value;

const EVALUATION_FIELDS: [&str; 10] = [
    "trials",
    "mean_reward",
    "mean_reward_se",
    "mean_discounted_reward",
    "mean_discounted_reward_se",
    "success_rate",
    "safety_violations",
    "time_outs",
    "mean_goal_error",
    "coverage_90",
];

fn train(folder: &Path, extra: &str) -> Answer {
    let object = door2();
    let mut arguments = vec!["train", object.as_str()];
    arguments.extend(words("--steps 20000 --seeds 1 --trials 50 --json"));
    arguments.extend(words(extra));
    pubs(folder, &arguments)
}

/// `evaluate` of a file with door2; the shipped policy where none is named.
fn evaluate(folder: &Path, policy: Option<&str>, extra: &str) -> Answer {
    let (object, shipped) = (door2(), door2_policy());
    let policy = policy.unwrap_or(&shipped);
    let mut arguments = vec!["evaluate", policy, "--object", object.as_str(), "--json"];
    arguments.extend(words(extra));
    pubs(folder, &arguments)
}

#[test]
fn training_writes_a_policy_and_overwrites_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let report = train(folder.path(), "-o new.onnx").assert_code(0).json();
    assert_fields(
        &report,
        &["policy", "steps", "steps_per_s", "time_s", "seeds", "best"],
    );
    let path = folder.path().join("new.onnx");
    let first = fs::read(&path).unwrap();
    let curves = folder.path().join("new.training.json");
    let first_curves = fs::read(&curves).unwrap();

    // The same seed again gives the same file, which is no reason to refuse.
    train(folder.path(), "-o new.onnx").assert_code(0);
    assert_eq!(
        fs::read(&path).unwrap(),
        first,
        "one seed trained two policies"
    );
    assert_eq!(
        fs::read(&curves).unwrap(),
        first_curves,
        "one seed learned in two ways"
    );

    let refused = train(folder.path(), "-o new.onnx --seed 2");
    refused
        .assert_code(2)
        .assert_says(&["new.onnx", "--overwrite"]);
    assert_eq!(refused.stdout, "");
    assert_eq!(
        fs::read(&path).unwrap(),
        first,
        "a refused training changed the file"
    );
    assert_eq!(
        fs::read(&curves).unwrap(),
        first_curves,
        "a refused training changed the learning curves"
    );

    train(folder.path(), "-o new.onnx --seed 2 --overwrite").assert_code(0);
    assert_ne!(
        fs::read(&path).unwrap(),
        first,
        "--overwrite replaced nothing"
    );
    assert_ne!(
        fs::read(&curves).unwrap(),
        first_curves,
        "the learning curves are still those of the policy that was replaced"
    );
    let entries = folder.path().read_dir().unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    // The policy and its learning curves, and nothing else.
    assert_eq!(names, ["new.onnx", "new.training.json"]);

    let report = evaluate(folder.path(), Some("new.onnx"), "--trials 20")
        .assert_code(0)
        .json();
    assert_eq!(report["trials"], 20);
}

#[test]
fn the_shipped_policy_is_judged_with_every_field() {
    let folder = tempfile::tempdir().unwrap();
    let report = evaluate(folder.path(), None, "--trials 500")
        .assert_code(0)
        .json();
    assert_fields(&report, &EVALUATION_FIELDS);
    assert_eq!(report["trials"], 500);
    assert!(report["success_rate"].as_f64().unwrap() > 0.9, "{report}");
    assert_eq!(report["safety_violations"], 0, "{report}");
    for share in ["success_rate", "coverage_90"] {
        assert!(
            (0.0..=1.0).contains(&report[share].as_f64().unwrap()),
            "{share}: {report}"
        );
    }
}

/// The figures without those that tell how fast they came.
fn figures(answer: &Answer) -> Value {
    let mut report = answer.assert_code(0).json();
    let fields = report.as_object_mut().unwrap();
    for name in ["time_s", "trials_per_s", "runtime"] {
        fields.remove(name);
    }
    report
}

#[test]
fn threads_change_no_figure_and_seeds_do() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two, other] = ["--threads 1", "--threads 2", "--seed 2"].map(|extra| {
        figures(&evaluate(
            folder.path(),
            None,
            &format!("--trials 300 {extra}"),
        ))
    });
    assert_eq!(one, two);
    assert_ne!(
        one["mean_reward"], other["mean_reward"],
        "two seeds, the same trials"
    );
}

#[test]
fn a_damaged_policy_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole = fs::read(door2_policy()).unwrap();
    let mut cases: Vec<(String, Vec<u8>)> = [0, 1, 100, whole.len() / 2, whole.len() - 1]
        .map(|length| {
            (
                format!("the first {length} bytes"),
                whole[..length].to_vec(),
            )
        })
        .into();
    for at in (0..whole.len()).step_by(whole.len() / 12) {
        let mut flipped = whole.clone();
        flipped[at] ^= 0x10;
        cases.push((format!("a flipped bit in byte {at}"), flipped));
    }
    for (name, bytes) in cases {
        fs::write(folder.path().join("damaged.onnx"), bytes).unwrap();
        let answer = evaluate(folder.path(), Some("damaged.onnx"), "--trials 1");
        assert_eq!(
            answer.code, 5,
            "{name}: code {}: {}{}",
            answer.code, answer.stdout, answer.stderr
        );
        answer.assert_says(&["damaged.onnx"]);
    }
}

#[test]
fn a_policy_of_another_task_is_refused_with_both_values() {
    let folder = tempfile::tempdir().unwrap();
    let (object, policy) = (door2(), door2_policy());
    let changed = ["--set", "control.safe_speed_m_s=0.04"];
    let mut run = vec![
        "run",
        &object,
        "--policy",
        &policy,
        "--goal",
        "0.5",
        "--lockstep",
        "--json",
    ];
    run.extend(changed);
    let mut evaluate = vec![
        "evaluate", &policy, "--object", &object, "--trials", "1", "--json",
    ];
    evaluate.extend(changed);
    for arguments in [run, evaluate] {
        let answer = pubs(folder.path(), &arguments);
        answer
            .assert_code(5)
            .assert_says(&["control.safe_speed_m_s", "0.05", "0.04"]);
        assert_eq!(answer.stdout, "");
    }
}

#[test]
fn an_absent_runtime_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let answer = evaluate(
        folder.path(),
        None,
        "--trials 1 --onnxruntime /nonexistent.so",
    );
    answer.assert_code(5).assert_says(&["/nonexistent.so"]);
    assert_eq!(answer.stdout, "");
}

#[test]
fn a_real_onnx_runtime_agrees() {
    let Some(library) = std::env::var_os("ORT_DYLIB_PATH") else {
        eprintln!("skipped: ORT_DYLIB_PATH names no ONNX Runtime");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let built_in = evaluate(folder.path(), None, "--trials 300")
        .assert_code(0)
        .json();
    let (object, policy) = (door2(), door2_policy());
    let arguments = [
        "evaluate", &policy, "--object", &object, "--trials", "300", "--json",
    ];
    let real = Answer::of(command(folder.path(), &arguments).env("ORT_DYLIB_PATH", library));
    let real = real.assert_code(0).json();
    assert_ne!(
        built_in["runtime"], real["runtime"],
        "the library was not used"
    );
    // Logits that differ in the last bits may turn a single choice among 300 trials.
    let reward = |report: &Value| report["mean_reward"].as_f64().unwrap();
    let difference = (reward(&built_in) - reward(&real)).abs();
    assert!(
        difference < 0.01,
        "mean rewards differ by {difference}: {built_in} {real}"
    );
}
