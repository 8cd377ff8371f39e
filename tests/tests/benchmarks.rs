//! The paper's two benchmarks as a user has them: object files with models that are loaded.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{Answer, command_of, door2, path_text, program, pubs, root, shipped_plugins, words};

/// Object, the plugin that it names, and the library that holds it.
const BENCHMARKS: [(&str, &str, &str); 2] = [
    ("light_dark", "light-dark", "light_dark"),
    ("sim_object", "limit-sensor", "limit_sensor"),
];

fn object(name: &str) -> String {
    path_text(&root().join(format!("objects/{name}.toml")))
}

/// The program with the libraries of the repository.
fn with_plugins(folder: &Path, line: &str, object: &str) -> Answer {
    let plugins = path_text(shipped_plugins());
    let mut arguments = words(line);
    arguments.extend([object, "--plugin-dir", &plugins]);
    pubs(folder, &arguments)
}

#[test]
fn the_shipped_libraries_keep_the_contract() {
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    for (name, _, library) in BENCHMARKS {
        let library = path_text(&shipped_plugins().join(format!("{prefix}{library}{suffix}")));
        let object = object(name);
        for own in [&[][..], &["--object", &object]] {
            let mut arguments = vec!["plugins", "check", &library];
            arguments.extend(own);
            let answer = pubs(shipped_plugins(), &arguments);
            answer.assert_code(0).assert_says(&["keeps the contract"]);
        }
    }
}

#[test]
fn a_benchmark_is_checked_trained_for_its_own_goal_and_evaluated() {
    // 0 and 50 as fractions of -60 to 60 and 1 to 100.
    for ((name, _, _), goal) in BENCHMARKS.into_iter().zip(["0.5", "0.4949"]) {
        let folder = tempfile::tempdir().unwrap();
        let object = object(name);
        with_plugins(folder.path(), "check", &object).assert_code(0);

        let line = "train --steps 20000 --seeds 1 --trials 100 -o policy.onnx --json";
        let trained = with_plugins(folder.path(), line, &object);
        let report = trained.assert_code(0).json();
        assert_eq!(report["object"], name);
        assert_eq!(report["goal"], goal, "{name}: {report}");
        assert_eq!(report["recipe"], "benchmark", "{name}: {report}");

        let line = "evaluate policy.onnx --trials 200 --json --object";
        let evaluated = with_plugins(folder.path(), line, &object);
        let report = evaluated.assert_code(0).json();
        let reached = (report["success_rate"].as_f64().unwrap() * 200.0).round() as u64;
        let others = ["failed_stops", "time_outs", "safety_violations"];
        let others = others.map(|field| report[field].as_u64().unwrap());
        assert_eq!(
            reached + others.iter().sum::<u64>(),
            200,
            "{name}: {report}"
        );
        assert_eq!(others[2], 0, "{name}: nothing can violate: {report}");
    }
}

#[test]
fn a_benchmark_is_not_run_on_an_arm_and_nothing_is_trained_for_that() {
    let folder = tempfile::tempdir().unwrap();
    let object = object("light_dark");
    let line = "run --goal 0.5 --lockstep --policies new";
    let refused = with_plugins(folder.path(), line, &object);
    refused
        .assert_code(2)
        .assert_says(&["abstract joint", "evaluate"]);
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[test]
fn a_missing_library_is_answered_with_the_command_that_builds_it() {
    let folder = tempfile::tempdir().unwrap();
    // Alone in its folder the program has no library beside it.
    let alone = folder.path().join(program().file_name().unwrap());
    fs::copy(program(), &alone).unwrap();
    let check =
        |object: &str| Answer::of(&mut command_of(&alone, folder.path(), &["check", object]));
    for (name, plugin, _) in BENCHMARKS {
        let missing = format!("no plugin `{plugin}`");
        let expected = ["observation", &missing, "cargo build", "--workspace"];
        check(&object(name)).assert_code(2).assert_says(&expected);
    }
    check(&door2()).assert_code(0);
}
