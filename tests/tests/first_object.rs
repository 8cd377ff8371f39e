//! An object that the repository does not have, from `new` to a replay, without editing its file.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::fs;
use std::path::Path;

use common::{Answer, pubs, root, words};
use serde_json::json;

const FRIDGE: &str = "--joint revolute --limits 0deg,100deg --radius 42cm --opening -z --up +y --hinge -x --world fridge";

fn new(folder: &Path, file: &str, flags: &str) -> Answer {
    let mut arguments = vec!["new", file];
    arguments.extend(words(flags));
    pubs(folder, &arguments)
}

fn on(folder: &Path, line: &str) -> Answer {
    pubs(folder, &words(line))
}

#[test]
fn a_first_object_reaches_its_goal() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let report = new(folder, "objects/fridge.toml", &format!("{FRIDGE} --json"));
    let report = report.assert_code(0).json();
    assert_eq!(report["object"], "objects/fridge.toml");
    assert_eq!(
        report["next"][0],
        "pubs-engine calibrate objects/fridge.toml"
    );
    let schema = fs::read(folder.join("objects/object.schema.json")).unwrap();
    let shipped = fs::read(root().join("objects/object.schema.json")).unwrap();
    assert!(schema == shipped, "another schema than the shipped one");
    let written = fs::read_to_string(folder.join("objects/fridge.toml")).unwrap();
    assert!(written.starts_with("#:schema ./object.schema.json\n"));

    let check = on(folder, "check objects --json").assert_code(0).json();
    assert_eq!(check["uncalibrated"], json!(["objects/fridge.toml"]));
    on(folder, "run objects/fridge.toml --goal 0.5 --lockstep")
        .assert_code(2)
        .assert_says(&[
            "not calibrated",
            "pubs-engine calibrate objects/fridge.toml",
        ]);
    on(folder, "calibrate objects/fridge.toml --lockstep").assert_code(0);
    let calibrated = fs::read_to_string(folder.join("objects/fridge.toml")).unwrap();
    for line in written.lines().filter(|line| !line.starts_with("kind = ")) {
        assert!(calibrated.contains(line), "`{line}` is gone");
    }
    let check = on(folder, "check objects --json").assert_code(0).json();
    assert_eq!(check["uncalibrated"], json!([]));
    on(folder, "plot objects/fridge.toml --out pictures").assert_code(0);
    on(folder, "train objects/fridge.toml --seeds 1").assert_code(0);
    let run = "run objects/fridge.toml --goal 0.5 --lockstep --record recordings/first.mcap --json";
    let run = on(folder, run).assert_code(0).json();
    assert_eq!(run["outcome"], "reached", "{run}");
    assert_eq!(run["judged_by"], "truth", "{run}");
    let error_rad = run["goal_error"].as_f64().unwrap();
    assert!(error_rad.abs() < 8f64.to_radians(), "{run}");
    on(folder, "replay recordings/first.mcap").assert_code(0);
}

#[test]
fn nothing_is_overwritten_and_what_is_wrong_is_named_by_its_flag() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("mine.toml"), "my own words").unwrap();
    fs::write(folder.join("a_file"), "").unwrap();
    let changed = |flag: &str, value: &str| {
        let mut flags = words(FRIDGE);
        let place = flags.iter().position(|word| *word == flag).unwrap();
        flags[place + 1] = value;
        flags.join(" ")
    };
    let slide = FRIDGE
        .replace("revolute", "prismatic")
        .replace("0deg,100deg", "0cm,40cm");
    let cases: Vec<(&str, String, Vec<&str>)> = vec![
        (
            "mine.toml",
            FRIDGE.to_owned(),
            vec!["mine.toml is there already"],
        ),
        ("mine.txt", FRIDGE.to_owned(), vec!["end in .toml"]),
        (
            "my fridge.toml",
            FRIDGE.to_owned(),
            vec!["--name", "my fridge"],
        ),
        (
            "a_file/x.toml",
            FRIDGE.to_owned(),
            vec!["cannot make the folder a_file"],
        ),
        ("-", FRIDGE.to_owned(), vec!["--name"]),
        ("-", format!("{FRIDGE} --json"), vec!["leave out --json"]),
        (
            "x.toml",
            String::new(),
            vec![
                "--joint",
                "--limits",
                "--radius",
                "--opening",
                "--up",
                "--hinge",
                "--world",
            ],
        ),
        (
            "x.toml",
            changed("--joint", "door"),
            vec!["--joint: `door`"],
        ),
        (
            "x.toml",
            changed("--limits", "0,100"),
            vec!["--limits: `100`", "110deg"],
        ),
        (
            "x.toml",
            changed("--limits", "100deg,0deg"),
            vec!["--limits", "must be larger"],
        ),
        (
            "x.toml",
            changed("--radius", "0"),
            vec!["--radius: `--radius` is 0"],
        ),
        (
            "x.toml",
            changed("--up", "-z"),
            vec!["--up", "line of motion"],
        ),
        (
            "x.toml",
            changed("--hinge", "left"),
            vec!["--hinge: `left`"],
        ),
        ("x.toml", changed("--hinge", "+z"), vec!["--hinge", "90°"]),
        (
            "x.toml",
            changed("--world", "oven"),
            vec!["--world", "oven", "fridge"],
        ),
        (
            "x.toml",
            changed("--world", "drawer1"),
            vec!["--world", "has a slide"],
        ),
        (
            "x.toml",
            format!("{FRIDGE} --tolerance 60deg"),
            vec!["--tolerance", "half the range is 50"],
        ),
        (
            "x.toml",
            format!("{FRIDGE} --driver nobody"),
            vec!["--driver", "nobody"],
        ),
        (
            "x.toml",
            format!("{FRIDGE} --param start"),
            vec!["--param", "NAME=VALUE"],
        ),
        (
            "x.toml",
            format!("{FRIDGE} --param start=2"),
            vec!["start", "2"],
        ),
        ("x.toml", slide, vec!["--radius: a slide has no hinge"]),
    ];
    for (file, flags, says) in cases {
        new(folder, file, &flags).assert_code(2).assert_says(&says);
        assert!(
            !folder.join("x.toml").exists(),
            "{flags}: a file was written"
        );
    }
    let kept = fs::read_to_string(folder.join("mine.toml")).unwrap();
    assert_eq!(kept, "my own words");
}

#[test]
fn a_file_on_stdout_is_a_whole_one_and_a_slide_has_no_hinge() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let flags = "--name tray --joint prismatic --limits 0cm,25cm --opening -z --up +x --world drawer1 --param start=0.5";
    let answer = new(folder, "-", flags);
    answer.assert_code(0);
    fs::write(folder.join("tray.toml"), &answer.stdout).unwrap();
    on(folder, "check tray.toml").assert_code(0);
    let values: toml::Table = answer.stdout.parse().unwrap();
    assert_eq!(values["joint"]["limits_m"][1].as_float(), Some(0.25));
    assert_eq!(values["reward"]["goal_tolerance_m"].as_float(), Some(0.02));
    assert_eq!(values["driver"]["params"]["start"].as_float(), Some(0.5));
    assert!(values["joint"].get("hinge_direction").is_none());
}
