//! Object files, overrides and goals as a user gets them wrong; what goes to which stream.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::io::Read;
use std::process::Stdio;

use common::{assert_fields, command, door2, path_text, pubs, words};

/// The 1-based line of the first line of door2.toml that begins with `start`, and the file with that line replaced.
fn broken(start: &str, replacement: &str) -> (u64, String) {
    let text = fs::read_to_string(door2()).unwrap();
    let index = text
        .lines()
        .position(|line| line.starts_with(start))
        .unwrap();
    let lines = text.lines().enumerate();
    let changed: Vec<&str> = lines
        .map(|(at, line)| if at == index { replacement } else { line })
        .collect();
    (index as u64 + 1, changed.join("\n"))
}

struct Fault {
    start: &'static str,
    replacement: &'static str,
    key: &'static str,
    words: &'static str,
}

const FAULTS: [Fault; 6] = [
    Fault {
        start: "radius_m",
        replacement: "radius_m = -0.32",
        key: "joint.radius_m",
        words: "-0.32",
    },
    Fault {
        start: "particles",
        replacement: "particles = \"many\"",
        key: "belief.particles",
        words: "\"many\"",
    },
    Fault {
        start: "force_limit_n",
        replacement: "force_limit_n = nan",
        key: "control.force_limit_n",
        words: "is NaN",
    },
    Fault {
        start: "tempering",
        replacement: "temperng = 1.0",
        key: "belief.temperng",
        words: "unknown key",
    },
    Fault {
        start: "model = ",
        replacement: "model = \"segmens\"",
        key: "observation.model",
        words: "did you mean `segments`?",
    },
    Fault {
        start: "name = ",
        replacement: "name = = 2",
        key: "",
        words: "not TOML",
    },
];

#[test]
fn check_shows_every_fault_of_every_file_at_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let objects = folder.path().join("objects");
    fs::create_dir(&objects).unwrap();
    fs::copy(door2(), objects.join("sound.toml")).unwrap();
    let mut expected = Vec::new();
    for (number, fault) in FAULTS.iter().enumerate() {
        let name = format!("object{number}.toml");
        let (line, text) = broken(fault.start, fault.replacement);
        fs::write(objects.join(&name), text).unwrap();
        expected.push((name, line, fault));
    }

    let told = pubs(folder.path(), &["check", "objects"]);
    told.assert_code(2);
    let everything = format!("{}{}", told.stdout, told.stderr);
    for (name, line, fault) in &expected {
        let place = format!("{name}:{line}:");
        assert!(
            everything.contains(&place),
            "`{place}` is missing in: {everything}"
        );
        assert!(
            everything.contains(fault.words),
            "`{}` is missing in: {everything}",
            fault.words
        );
    }

    let answer = pubs(folder.path(), &["check", "objects", "--json"]);
    let report = answer.assert_code(2).json();
    assert_eq!(report["ok"], false);
    let faults = report["faults"].as_array().unwrap();
    for (name, line, fault) in &expected {
        let found = faults.iter().find(|found| path_ends(&found["file"], name));
        let found = found.unwrap_or_else(|| panic!("no fault of {name} in {report}"));
        assert_fields(found, &["file", "line", "column", "key", "message", "help"]);
        assert_eq!(found["line"], *line, "{found}");
        assert_eq!(found["key"], fault.key, "{found}");
        assert!(
            found["message"].as_str().unwrap().contains(fault.words),
            "{found}"
        );
    }
    assert!(
        !faults
            .iter()
            .any(|found| path_ends(&found["file"], "sound.toml")),
        "{report}"
    );
}

fn path_ends(path: &serde_json::Value, name: &str) -> bool {
    path.as_str().unwrap().ends_with(name)
}

#[test]
fn the_shipped_objects_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    let objects = path_text(&common::root().join("objects"));
    // The models of the benchmarks are loaded.
    let plugins = path_text(common::shipped_plugins());
    let arguments = ["check", &objects, "--plugin-dir", &plugins, "--json"];
    let report = pubs(folder.path(), &arguments).assert_code(0).json();
    assert_eq!(report["ok"], true);
    assert_eq!(report["faults"].as_array().unwrap().len(), 0);
}

#[test]
fn wrong_requests_are_refused_before_anything_moves() {
    let cases: [(&str, &[&str]); 11] = [
        (
            "run OBJECT --goal 0.5 --set belief.particels=3",
            &["belief.particels", "did you mean `particles`?"],
        ),
        (
            "run OBJECT --goal 0.5 --set belief.particles=none",
            &["belief.particles", "none"],
        ),
        (
            "run OBJECT --goal 0.5 --set control.safe_speed_m_s=nan",
            &["control.safe_speed_m_s"],
        ),
        (
            "run OBJECT --goal 0.5 --set belief.particles",
            &["belief.particles"],
        ),
        ("run OBJECT --goal 1.5", &["1.5", "125"]),
        ("run OBJECT --goal 400deg", &["400deg", "125"]),
        ("run OBJECT --goal 12cm", &["12cm", "40deg"]),
        ("run OBJECT --goal ajar", &["ajar"]),
        (
            "run OBJECT --goal 0.5 --driver virtual-amr",
            &["virtual-amr", "did you mean `virtual-arm`?"],
        ),
        ("run absent.toml --goal 0.5", &["absent.toml"]),
        ("run OBJECT", &["--goal"]),
    ];
    let folder = tempfile::tempdir().unwrap();
    let object = door2();
    for (line, expected) in cases {
        let line = line.replace("OBJECT", &object);
        for extra in ["", " --json"] {
            let answer = pubs(folder.path(), &words(&format!("{line}{extra}")));
            answer.assert_code(2).assert_says(expected);
            assert_eq!(answer.stdout, "", "{line}: a refusal belongs on stderr");
        }
    }
}

#[test]
fn the_environment_overrides_the_file_and_the_command_line_overrides_both() {
    let folder = tempfile::tempdir().unwrap();
    let object = door2();
    let cases = [
        ("many", "", 2),
        ("400", "", 0),
        ("many", "--set belief.particles=400", 0),
    ];
    for (value, extra, code) in cases {
        let mut arguments = vec!["check", object.as_str()];
        arguments.extend(words(extra));
        let mut started = command(folder.path(), &arguments);
        let answer = common::Answer::of(started.env("PUBS_SET__BELIEF__PARTICLES", value));
        answer.assert_code(code);
    }
}

#[test]
fn config_prints_toml_and_a_json_schema() {
    let folder = tempfile::tempdir().unwrap();
    let defaults = pubs(folder.path(), &["config"]);
    let table: toml::Table = toml::from_str(&defaults.assert_code(0).stdout).unwrap();
    assert!(
        table.contains_key("control") && table.contains_key("belief"),
        "{table}"
    );
    let schema = pubs(folder.path(), &["config", "--schema"])
        .assert_code(0)
        .json();
    assert_fields(&schema, &["properties"]);
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    for line in ["config", "config --schema", "plugins list", "--help"] {
        let mut child = command(folder.path(), &words(line))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let mut stderr = String::new();
        child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut stderr)
            .unwrap();
        let status = child.wait().unwrap();
        assert_eq!(stderr, "", "{line}");
        assert!(status.success(), "{line}: {status}");
    }
}
