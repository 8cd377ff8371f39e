//! Solving discrete POMDPs and objects on a grid (§IV-C).
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{Answer, assert_fields, path_text, pubs, root, shipped_plugins, words};
use serde_json::Value;

fn problem(name: &str) -> String {
    path_text(&root().join(format!("engine/solve/problems/{name}.pomdp")))
}

fn solve(folder: &Path, what: &str, extra: &str) -> Answer {
    let plugins = path_text(shipped_plugins());
    let mut arguments = vec!["solve", what];
    arguments.extend(words(extra));
    if what.ends_with(".toml") {
        arguments.extend(["--plugin-dir", plugins.as_str()]);
    }
    pubs(folder, &arguments)
}

fn number(report: &Value, field: &str) -> f64 {
    report[field].as_f64().unwrap()
}

#[test]
fn tiger_is_solved_and_its_policy_earns_what_it_promises() {
    let folder = tempfile::tempdir().unwrap();
    let line = "--method sarsop --timeout 30 --precision 0.01 -o tiger.json --json";
    let solved = solve(folder.path(), &problem("tiger"), line);
    let report = solved.assert_code(0).json();
    let fields = ["lower", "upper", "gap", "alpha_vectors", "time_s", "policy"];
    assert_fields(&report, &fields);
    // Another solver's bounds: 19.3711 to 19.3721.
    let (lower, upper) = (number(&report, "lower"), number(&report, "upper"));
    assert!(lower > 19.36 && upper < 19.39 && lower <= upper, "{report}");
    assert!(
        solved.stderr.contains("alpha vectors"),
        "no progress: {}",
        solved.stderr
    );

    let tiger = problem("tiger");
    let line = [
        "evaluate",
        "tiger.json",
        "--object",
        &tiger,
        "--trials",
        "4000",
        "--json",
    ];
    let judged = pubs(folder.path(), &line);
    let judged = judged.assert_code(0).json();
    let (mean, error) = (
        number(&judged, "mean_discounted_reward"),
        number(&judged, "mean_discounted_reward_se"),
    );
    assert!(
        (mean - lower).abs() < 4.0 * error,
        "{mean} ± {error}, promised {lower}"
    );
}

#[test]
fn an_object_is_solved_and_its_vectors_are_judged_on_the_object() {
    let folder = tempfile::tempdir().unwrap();
    let object = path_text(&root().join("objects/sim_object.toml"));
    let plugins = path_text(shipped_plugins());
    let line = "--timeout 60 --precision 0.05 -o sim.json --json -q";
    let report = solve(folder.path(), &object, line).assert_code(0).json();
    let lower = number(&report, "lower");
    assert!(lower > 0.5, "{report}");

    let line = [
        "evaluate",
        "sim.json",
        "--object",
        &object,
        "--plugin-dir",
        &plugins,
    ];
    let line = [&line[..], &["--trials", "1000", "--json"]].concat();
    let judged = pubs(folder.path(), &line).assert_code(0).json();
    let (mean, error) = (
        number(&judged, "mean_discounted_reward"),
        number(&judged, "mean_discounted_reward_se"),
    );
    assert!(
        mean > lower - 4.0 * error,
        "{mean} ± {error}, promised {lower}"
    );
    assert_eq!(judged["success_rate"], 1.0);

    // The vectors are for the goal that was solved.
    let other = [&line[..], &["--goal", "0.9"]].concat();
    let refused = pubs(folder.path(), &other);
    refused
        .assert_code(2)
        .assert_says(&["solved for the goal 50"]);

    // Another goal's grid is another problem; and a door needs a goal.
    let qmdp = "--method qmdp --goal @20 -o other.json --json";
    solve(folder.path(), &object, qmdp).assert_code(0);
    let door = path_text(&root().join("objects/door2.toml"));
    let refused = solve(folder.path(), &door, "--timeout 1");
    refused.assert_code(2).assert_says(&["--goal"]);
    let coarse = solve(
        folder.path(),
        &door,
        "--goal 0.5 --bins 16 --timeout 1 -o door.json --json",
    );
    assert_eq!(coarse.assert_code(0).json()["states"], 17);
}

#[test]
fn faults_of_a_problem_stand_at_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let text = "discount: 0.95\nstates: left right\nactions: go\nobservations: see\n\
                T: go\n0.5 0.4\nidentty\nO: go\nuniform\nR: go : * : * : * x\n";
    let path = folder.path().join("faulty.pomdp");
    fs::write(&path, text).unwrap();
    let answer = solve(folder.path(), "faulty.pomdp", "");
    answer
        .assert_code(2)
        .assert_says(&["faulty.pomdp:7", "identty", "help"]);
    assert_eq!(answer.stdout, "");

    let huge = "discount: 0.9\nstates: 2000000000\nactions: go\nobservations: see\n";
    fs::write(folder.path().join("huge.pomdp"), huge).unwrap();
    let cases = [
        ("missing.pomdp", "", "missing.pomdp"),
        ("faulty.pomdp", "--bins 5", "--bins is for object files"),
        ("faulty.pomdp", "--timeout 0", "seconds above 0"),
        ("huge.pomdp", "--timeout 1", "a solver serves at most"),
        ("faulty.pomdp", "--method best", "qmdp or sarsop"),
    ];
    for (file, line, expected) in cases {
        solve(folder.path(), file, line)
            .assert_code(2)
            .assert_says(&[expected]);
    }
}

#[test]
fn a_policy_of_another_problem_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    solve(folder.path(), &problem("tiger"), "-o tiger.json -q").assert_code(0);
    let other = problem("two_state");
    let cases = [
        (
            vec!["evaluate", "tiger.json", "--object", &other],
            5,
            "solve this problem again",
        ),
        (
            vec!["evaluate", "tiger.json"],
            2,
            "add --object tiger.pomdp",
        ),
    ];
    for (line, code, expected) in cases {
        pubs(folder.path(), &line)
            .assert_code(code)
            .assert_says(&[expected]);
    }
    let tiger = problem("tiger");
    let line = [
        "evaluate",
        "tiger.json",
        "--object",
        &tiger,
        "--goal",
        "0.5",
    ];
    pubs(folder.path(), &line)
        .assert_code(2)
        .assert_says(&["--goal is for objects"]);
    let door = path_text(&root().join("objects/door2.toml"));
    let line = [
        "run",
        &door,
        "--goal",
        "0.5",
        "--lockstep",
        "--policy",
        "tiger.json",
    ];
    pubs(folder.path(), &line)
        .assert_code(5)
        .assert_says(&["alpha vectors", "evaluate"]);
    fs::write(folder.path().join("broken.json"), "{").unwrap();
    let line = ["evaluate", "broken.json", "--object", other.as_str()];
    pubs(folder.path(), &line)
        .assert_code(5)
        .assert_says(&["broken.json"]);
}
