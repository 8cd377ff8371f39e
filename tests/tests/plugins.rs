//! Observation models of a user's own, in C and in Rust, and the ways in which they are refused.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use common::{door2_policy, door2_with_observation, path_text, pubs, ramp_in_rust, root, words};

/// Says aloud why a test has nothing to do where there is no C compiler.
fn no_c_compiler() -> bool {
    let version = Command::new("cc")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let absent = version.is_err();
    if absent {
        eprintln!("skipped: no C compiler (`cc`)");
    }
    absent
}

/// Compiles `plugins/ramp.c` into `folder`.
fn ramp_in_c(folder: &Path, macros: &[&str]) -> PathBuf {
    compiled(
        folder,
        &root().join("tests/plugins/ramp.c"),
        "libramp.so",
        macros,
    )
}

/// Compiles a plugin in C into `folder`.
fn compiled(folder: &Path, source: &Path, name: &str, macros: &[&str]) -> PathBuf {
    let library = folder.join(name);
    let output = Command::new("cc")
        .args(["-std=c99", "-O1", "-Wall", "-Wextra", "-shared", "-fPIC"])
        .args(macros.iter().map(|name| format!("-D{name}")))
        .arg("-I")
        .arg(root().join("plugins/abi/include"))
        .arg("-o")
        .arg(&library)
        .arg(source)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "cc {macros:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    library
}

fn write_object(folder: &Path, model: &str, params: &str) -> String {
    let observation = format!("model = \"{model}\"\nparams = {{ {params} }}");
    let object = folder.join("door.toml");
    fs::write(&object, door2_with_observation(&observation)).unwrap();
    path_text(&object)
}

/// Checks, lists, trains and runs with the only library of `folder`.
fn assert_serves(folder: &Path, library: &Path, model: &str) {
    let work = tempfile::tempdir().unwrap();
    let object = write_object(work.path(), model, "slope_n_per_rad = 4.0");
    let plugins = path_text(folder);

    let kit = pubs(
        work.path(),
        &["plugins", "check", &path_text(library), "--object", &object],
    );
    kit.assert_code(0);
    assert!(kit.stdout.contains("keeps the contract"), "{}", kit.stdout);

    let list = pubs(work.path(), &["plugins", "list", "--plugin-dir", &plugins]);
    assert!(
        list.assert_code(0).stdout.contains(model),
        "{}",
        list.stdout
    );
    pubs(work.path(), &["check", &object, "--plugin-dir", &plugins]).assert_code(0);

    let line = "--steps 20000 --seeds 1 --trials 100 -o policy.onnx --json";
    let mut arguments = vec!["train", &object, "--plugin-dir", &plugins];
    arguments.extend(words(line));
    pubs(work.path(), &arguments).assert_code(0).json();

    let line = "--policy policy.onnx --goal 0.5 --lockstep --json --no-record";
    let mut arguments = vec!["run", &object, "--plugin-dir", &plugins];
    arguments.extend(words(line));
    let answer = pubs(work.path(), &arguments);
    // What the model says is not true of this door, so the run may end anyhow, also by a stop for
    // safety; but neither in a fault nor by refusing the plugin.
    assert!(
        matches!(answer.code, 0 | 3 | 4),
        "code {}: {}",
        answer.code,
        answer.stderr
    );
    let belief = &answer.json()["belief"];
    assert!(
        belief["mean"].is_f64() && belief["entropy"].is_f64(),
        "{belief}"
    );
}

#[test]
fn a_model_in_c_is_checked_trained_with_and_run() {
    if no_c_compiler() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let library = ramp_in_c(folder.path(), &[]);
    assert_serves(folder.path(), &library, "ramp");
}

/// What stands between the fences of the page for plugin authors.
fn code_of_the_page(language: &str) -> String {
    let page = fs::read_to_string(root().join("plugins/abi/README.md")).unwrap();
    let (_, rest) = page.split_once(&format!("```{language}\n")).unwrap();
    rest.split_once("```").unwrap().0.to_owned()
}

#[test]
fn the_plugins_of_the_authors_page_work() {
    let ours = fs::read_to_string(root().join("tests/plugins/ramp.rs")).unwrap();
    assert_eq!(
        code_of_the_page("rust"),
        ours,
        "the page differs from tests/plugins/ramp.rs"
    );
    if no_c_compiler() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("heavy_start.c");
    fs::write(&source, code_of_the_page("c")).unwrap();
    let library = compiled(folder.path(), &source, "libheavy_start.so", &[]);
    pubs(folder.path(), &["plugins", "check", &path_text(&library)])
        .assert_code(0)
        .assert_says(&["keeps the contract"]);
    pubs(folder.path(), &["plugins", "list", "--plugin-dir", "."])
        .assert_code(0)
        .assert_says(&["heavy-start"]);
    let object = folder.path().join("door.toml");
    fs::write(&object, door2_with_observation("model = \"heavy-start\"")).unwrap();
    pubs(
        folder.path(),
        &["check", &path_text(&object), "--plugin-dir", "."],
    )
    .assert_code(0);
}

#[test]
fn a_model_in_rust_is_checked_trained_with_and_run() {
    let folder = tempfile::tempdir().unwrap();
    let library = ramp_in_rust(folder.path());
    assert_serves(folder.path(), &library, "ramp-in-rust");
}

/// Both verbs that meet a broken library: the kit, and a run that needs it.
fn assert_refused(folder: &Path, name: &str, code_of_run: i32, expected: &[&str]) {
    let object = write_object(folder, "ramp", "slope_n_per_rad = 4.0");
    let library = path_text(&folder.join("libramp.so"));
    let kit = pubs(folder, &["plugins", "check", &library, "--object", &object]);
    let run = pubs(
        folder,
        &[
            "run",
            &object,
            "--plugin-dir",
            ".",
            "--goal",
            "0.5",
            "--lockstep",
            "--policy",
            &door2_policy(),
        ],
    );
    for (answer, code) in [(kit, 5), (run, code_of_run)] {
        answer.assert_code(code);
        let told = format!("{}{}", answer.stdout, answer.stderr);
        for words in expected {
            assert!(
                told.contains(words),
                "{name}: `{words}` is missing in: {told}"
            );
        }
    }
}

#[test]
fn a_broken_model_is_refused_in_words() {
    if no_c_compiler() {
        return;
    }
    // A library that cannot be loaded leaves an object file that names an unknown plugin: 2.
    let cases: [(&str, i32, &[&str]); 3] = [
        ("FAULT_ABI", 2, &["libramp.so", "ABI 1", "ABI 7"]),
        ("FAULT_NAN", 5, &["ramp", "moments", "NaN", "f_d"]),
        (
            "FAULT_CREATE",
            5,
            &["ramp", "create", "the licence of this ramp has run out"],
        ),
    ];
    for (fault, code, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        ramp_in_c(folder.path(), &[fault]);
        assert_refused(folder.path(), fault, code, expected);
    }
}

/// Offset and friction can only be estimated from what a model expects to be read.
#[test]
fn a_model_without_moments_serves_the_plain_filter_only() {
    if no_c_compiler() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    ramp_in_c(folder.path(), &["LIKELIHOODS"]);
    let object = write_object(folder.path(), "ramp", "slope_n_per_rad = 4.0");
    let text = fs::read_to_string(&object).unwrap();
    let filter = text.lines().position(|line| line.starts_with("filter = "));
    let place = format!("door.toml:{}:10", 1 + filter.unwrap());
    let verbs = [
        "check",
        "train --steps 20000 --seeds 1 --trials 100 -o policy.onnx",
        "run --goal 0.5 --lockstep",
    ];
    for verb in verbs {
        let mut arguments = words(verb);
        arguments.extend([object.as_str(), "--plugin-dir", "."]);
        pubs(folder.path(), &arguments)
            .assert_code(2)
            .assert_says(&[
                &place,
                "observation model `ramp` gives likelihoods only",
                "filter = \"sis\"",
            ]);
    }
    let plain = [
        "check",
        &object,
        "--plugin-dir",
        ".",
        "--set",
        "belief.filter=sis",
    ];
    pubs(folder.path(), &plain).assert_code(0);
}

#[test]
fn a_file_that_is_no_library_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let library = folder.path().join("libramp.so");
    fs::write(&library, "This is a letter.\n").unwrap();
    assert_refused(
        folder.path(),
        "a text file",
        2,
        &["libramp.so", "not a shared library"],
    );
    fs::write(&library, "").unwrap();
    assert_refused(folder.path(), "an empty file", 2, &["libramp.so"]);
    if no_c_compiler() {
        return;
    }
    ramp_in_c(folder.path(), &[]);
    let whole = fs::read(&library).unwrap();
    for length in [40, 700, whole.len() / 2, whole.len() - 1] {
        fs::remove_file(&library).unwrap();
        fs::write(&library, &whole[..length]).unwrap();
        assert_refused(
            folder.path(),
            &format!("{length} bytes"),
            2,
            &["libramp.so"],
        );
    }
}

#[test]
fn parameters_are_checked_at_their_line() {
    let folder = tempfile::tempdir().unwrap();
    ramp_in_rust(folder.path());
    let cases = [
        ("slope_n_per_rat = 4.0", "did you mean `slope_n_per_rad`?"),
        ("slope_n_per_rad = -1.0", "slope_n_per_rad"),
        ("slope_n_per_rad = \"steep\"", "slope_n_per_rad"),
        ("", "slope_n_per_rad"),
    ];
    for (params, words) in cases {
        let object = write_object(folder.path(), "ramp-in-rust", params);
        let text = fs::read_to_string(&object).unwrap();
        let line = 1 + text
            .lines()
            .position(|line| line == format!("params = {{ {params} }}"))
            .unwrap();
        let answer = pubs(folder.path(), &["check", &object, "--plugin-dir", "."]);
        answer
            .assert_code(2)
            .assert_says(&[words, &format!("door.toml:{line}:")]);
    }
}

#[test]
fn an_unknown_plugin_is_answered_with_the_nearest_name() {
    let folder = tempfile::tempdir().unwrap();
    ramp_in_rust(folder.path());
    let object = write_object(folder.path(), "ramp-in-rusty", "slope_n_per_rad = 4.0");
    let answer = pubs(folder.path(), &["check", &object, "--plugin-dir", "."]);
    answer.assert_code(2).assert_says(&[
        "ramp-in-rusty",
        "did you mean `ramp-in-rust`?",
        "--plugin-dir",
    ]);
}
