//! Calibration as a user meets it: record, fit, look, compare, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::{Answer, assert_fields, command, path_text, pubs, root};
use serde_json::Value;

/// A folder with `objects/` as shipped.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let objects = folder.path().join("objects");
    fs::create_dir(&objects).unwrap();
    for name in ["drawer1", "drawer2", "door1", "door2"] {
        let file = format!("{name}.toml");
        fs::copy(root().join("objects").join(&file), objects.join(&file)).unwrap();
    }
    folder
}

fn calibrate(folder: &Path, object: &str, more: &[&str]) -> Answer {
    let object = format!("objects/{object}.toml");
    let mut arguments = vec!["calibrate", object.as_str()];
    arguments.extend(more);
    pubs(folder, &arguments)
}

fn text(folder: &Path, object: &str) -> String {
    fs::read_to_string(folder.join(format!("objects/{object}.toml"))).unwrap()
}

fn recording(folder: &Path, object: &str) -> PathBuf {
    folder.join(format!("recordings/{object}-calibration.mcap"))
}

/// A table of drawer1's recording, with these lines changed.
fn table(folder: &Path, name: &str, change: impl Fn(usize, &str) -> Option<String>) -> String {
    let csv = folder.join("tables/drawer1-calibration.csv");
    let lines = fs::read_to_string(csv).unwrap();
    let changed: Vec<String> = lines
        .lines()
        .enumerate()
        .filter_map(|(index, line)| change(index + 1, line))
        .collect();
    let path = folder.join(name);
    fs::write(&path, changed.join("\n") + "\n").unwrap();
    path_text(&path)
}

/// Which column of a table has this name.
fn column(folder: &Path, name: &str) -> usize {
    let lines = fs::read_to_string(folder.join("tables/drawer1-calibration.csv")).unwrap();
    let head = lines.lines().find(|line| !line.starts_with('#')).unwrap();
    head.split(',').position(|found| found == name).unwrap()
}

fn with_cell(line: &str, column: usize, change: impl Fn(&str) -> String) -> String {
    let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
    cells[column] = change(&cells[column]);
    cells.join(",")
}

#[test]
fn the_shipped_objects_come_out_byte_for_byte_and_the_verbs_follow() {
    let folder = place();
    let folder = folder.path();
    for object in ["drawer1", "drawer2", "door1", "door2"] {
        let before = text(folder, object);
        let answer = calibrate(folder, object, &["--lockstep", "--seed", "1", "--json"]);
        let report = answer.assert_code(0).json();
        assert_fields(
            &report,
            &[
                "segments",
                "channels",
                "spread",
                "spread_independent",
                "proposal",
                "warnings",
                "fit_s",
            ],
        );
        assert_eq!(
            text(folder, object),
            before,
            "{object}: other bytes than those that are shipped"
        );
        let coverage = report["spread"]["coverage"].as_f64().unwrap();
        assert!(
            (0.85..=0.97).contains(&coverage),
            "{object}: coverage {coverage}"
        );
    }
    calibrate(folder, "door1", &["--lockstep"])
        .assert_code(2)
        .assert_says(&["door1-calibration.mcap is there already", "--resume"]);

    let answer = pubs(
        folder,
        &["plot", "objects/door1.toml", "--out", "pictures", "--json"],
    );
    let report = answer.assert_code(0).json();
    assert!(report["readings"].as_u64().unwrap() > 10_000, "{report}");
    let svg = fs::read_to_string(folder.join("pictures/door1.svg")).unwrap();
    assert!(svg.contains("safe_open") && svg.contains("door1-calibration.mcap"));
    assert!(
        fs::read(folder.join("pictures/door1.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );

    calibrate(folder, "door1", &["--check", "--lockstep", "--seed", "5"])
        .assert_code(0)
        .assert_says(&["the stored model holds", "high_close"]);
    let stiff = "driver.params={world=\"door1\",friction_scale=1.8}";
    let answer = calibrate(
        folder,
        "door1",
        &["--check", "--lockstep", "--set", stiff, "--json"],
    );
    let report = answer.assert_code(3).json();
    assert_eq!(report["holds"], Value::Bool(false));
    let off: Vec<&Value> = report["channels"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|channel| channel["holds"] == Value::Bool(false))
        .collect();
    assert!(
        off.iter().any(|channel| channel["channel"] == "f_d"),
        "{off:?}"
    );
    assert!(
        off.iter().all(|channel| channel["channel"] != "f_n"),
        "{off:?}"
    );
}

#[test]
fn a_new_object_is_fitted_in_place_with_its_comments_kept() {
    let folder = place();
    let folder = folder.path();
    let shipped = text(folder, "drawer2");
    let (head, _) = shipped.split_once("# Calibration segments").unwrap();
    let own = format!("{}\n# my own last words\n", head.trim_end());
    fs::write(folder.join("objects/drawer2.toml"), &own).unwrap();
    pubs(folder, &["check", "objects/drawer2.toml"])
        .assert_code(0)
        .assert_says(&[
            "not calibrated yet",
            "pubs-engine calibrate objects/drawer2.toml",
        ]);
    pubs(folder, &["train", "objects/drawer2.toml"])
        .assert_code(2)
        .assert_says(&["the object is not calibrated", "pubs-engine calibrate"]);
    let more = ["--lockstep", "--dry-run"];
    let answer = calibrate(folder, "drawer2", &more);
    answer
        .assert_code(0)
        .assert_says(&["+[[observation.segment]]", "+++ as it would be"]);
    assert_eq!(text(folder, "drawer2"), own, "--dry-run has written");
    let file = path_text(&recording(folder, "drawer2"));
    calibrate(folder, "drawer2", &["--from", &file]).assert_code(0);
    let written = text(folder, "drawer2");
    for line in own.lines() {
        assert!(written.contains(line), "`{line}` is gone");
    }
    pubs(folder, &["check", "objects/drawer2.toml"]).assert_code(0);
}

#[test]
fn tables_say_the_same_and_bad_ones_are_refused_with_line_and_column() {
    let folder = place();
    let folder = folder.path();
    calibrate(folder, "drawer1", &["--lockstep"]).assert_code(0);
    let before = text(folder, "drawer1");
    let file = path_text(&recording(folder, "drawer1"));
    calibrate(folder, "drawer1", &["--from", &file, "--export", "tables"]).assert_code(0);
    let csv = "tables/drawer1-calibration.csv";
    calibrate(folder, "drawer1", &["--from", csv]).assert_code(0);
    assert_eq!(
        text(folder, "drawer1"),
        before,
        "the table gives other segments"
    );

    let (fx, fz) = (column(folder, "force_x_n"), column(folder, "force_z_n"));
    let is_row = |line: &str| line.starts_with(|first: char| first.is_ascii_digit());
    let same = |line: &str| Some(line.to_owned());
    let cases: Vec<(&str, String, Vec<&str>)> = vec![
        (
            "not a number",
            table(folder, "nan.csv", |number, line| match number {
                500 => Some(with_cell(line, fx, |_| "NaN".to_owned())),
                _ => same(line),
            }),
            vec!["nan.csv", "line 500", "force_x_n", "NaN"],
        ),
        (
            "a gap in the poses",
            table(folder, "gap.csv", |number, line| {
                (!(3000..3100).contains(&number)).then(|| line.to_owned())
            }),
            vec!["gap.csv", "line 3000"],
        ),
        (
            "swapped columns",
            table(folder, "swapped.csv", |_, line| {
                if !is_row(line) {
                    return same(line);
                }
                let cells: Vec<&str> = line.split(',').collect();
                let (a, b) = (cells[fx].to_owned(), cells[fz].to_owned());
                Some(with_cell(&with_cell(line, fx, |_| b.clone()), fz, |_| {
                    a.clone()
                }))
            }),
            vec!["swapped.csv", "force_x_n"],
        ),
        (
            "saturated",
            table(folder, "saturated.csv", |_, line| {
                if !is_row(line) {
                    return same(line);
                }
                Some(with_cell(line, fz, |cell| {
                    let value: f64 = cell.parse().unwrap();
                    value.clamp(-8.0, 8.0).to_string()
                }))
            }),
            vec!["saturated.csv", "force_z_n", "8"],
        ),
        (
            "another sensor",
            table(folder, "sensor.csv", |_, line| {
                Some(line.replace("# sensor = virtual-arm", "# sensor = ft300"))
            }),
            vec!["sensor.csv", "ft300", "virtual-arm"],
        ),
        (
            "another kind of joint",
            table(folder, "joint.csv", |_, line| {
                Some(line.replace("# joint = prismatic", "# joint = revolute"))
            }),
            vec!["joint.csv", "revolute"],
        ),
        (
            "shorter than the limits",
            table(folder, "short.csv", |number, line| {
                (number < 250).then(|| line.to_owned())
            }),
            vec!["short.csv"],
        ),
    ];
    for (name, file, words) in cases {
        let answer = calibrate(folder, "drawer1", &["--from", &file]);
        assert_eq!(answer.code, 2, "{name}: {}{}", answer.stdout, answer.stderr);
        answer.assert_says(&words);
        assert_eq!(
            text(folder, "drawer1"),
            before,
            "{name}: the object file was touched"
        );
    }
    calibrate(folder, "drawer1", &["--from", csv, "--demonstrations", "9"])
        .assert_code(2)
        .assert_says(&["too few demonstrations", "safe_open has 5"]);
    assert_eq!(text(folder, "drawer1"), before);
}

#[test]
fn a_cut_recording_gives_what_it_holds_and_says_what_is_lost() {
    let folder = place();
    let folder = folder.path();
    calibrate(folder, "drawer1", &["--lockstep"]).assert_code(0);
    let bytes = fs::read(recording(folder, "drawer1")).unwrap();
    let cut = folder.join("cut.mcap");
    fs::write(&cut, &bytes[..bytes.len() * 9 / 10]).unwrap();
    let cut = path_text(&cut);
    calibrate(
        folder,
        "drawer1",
        &["--from", &cut, "--demonstrations", "4", "--dry-run"],
    )
    .assert_code(3)
    .assert_says(&["cut.mcap", "lost"]);
    fs::write(folder.join("none.mcap"), &bytes[..30]).unwrap();
    calibrate(folder, "drawer1", &["--from", "none.mcap"])
        .assert_code(2)
        .assert_says(&["none.mcap"]);
}

#[test]
fn an_interrupted_recording_comes_to_rest_is_kept_and_resumed() {
    let folder = place();
    let folder = folder.path();
    let mut child = command(
        folder,
        &["calibrate", "objects/drawer1.toml", "--demonstrations", "1"],
    )
    .stdout(std::process::Stdio::piped())
    .stderr(std::process::Stdio::piped())
    .spawn()
    .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(9));
    common::signal(&child, libc::SIGINT);
    let _ = child.wait().unwrap();
    let answer = Answer::from_output("interrupted".to_owned(), child.wait_with_output().unwrap());
    answer
        .assert_code(4)
        // On a machine too busy for real time the guard may be the one who stops first; what follows is
        // the same. That an interruption is told as one is tested on the virtual clock.
        .assert_says(&["stopped: ", "what was recorded is kept", "--resume"]);
    assert!(recording(folder, "drawer1").exists());
    calibrate(
        folder,
        "drawer1",
        &["--resume", "--demonstrations", "1", "--lockstep"],
    )
    .assert_code(0)
    .assert_says(&["drawer1-calibration-2.mcap", "high_open 1"]);
}

#[test]
fn a_sensor_that_is_off_is_refused_before_anything_moves_and_nothing_is_left_behind() {
    let folder = place();
    let folder = folder.path();
    calibrate(
        folder,
        "door1",
        &["--lockstep", "--baseline-noise-n", "0.01"],
    )
    .assert_code(4)
    .assert_says(&["noisy at rest", "allowed are 0.01 N"]);
    assert!(!recording(folder, "door1").exists());
}

#[test]
fn measured_doors_are_surveyed() {
    let data = root().join("../shared/data");
    let table = data.join("door_forces.csv");
    if !table.exists() {
        println!("skipped: no data");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let log = path_text(&data.join("pr2_lab_cabinet_log.csv"));
    let answer = pubs(
        folder.path(),
        &["survey", &path_text(&table), &log, "--json"],
    );
    let report = answer.assert_code(0).json();
    assert_eq!(report["doors"].as_array().unwrap().len(), 19);
    let coverage = |index: usize| report["overall"][index]["coverage"].as_f64().unwrap();
    assert!(
        coverage(0) < 0.65,
        "independent readings cover {}",
        coverage(0)
    );
    assert!(
        (0.85..=0.97).contains(&coverage(1)),
        "the defaults cover {}",
        coverage(1)
    );
}
