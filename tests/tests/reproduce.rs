//! The paper's evaluation in the small: one tiny cell of each kind (§IV).
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{Answer, path_text, pubs, root, shipped_plugins, words};
use serde_json::Value;

/// One seed, hardly any steps and trials; what is learnt does not matter here.
const SMALL: &str = "--seeds 1 --recurrent-seeds 1 --steps 2048 --trials 2 --timeout 1 \
                     --output results --json";

fn reproduce(folder: &Path, cells: &str, extra: &str) -> Answer {
    let objects = path_text(&root().join("objects"));
    let plugins = path_text(shipped_plugins());
    let mut arguments = vec!["reproduce", "--objects", &objects, "--plugin-dir", &plugins];
    arguments.extend(words(SMALL));
    if !cells.is_empty() {
        arguments.extend(["--cells", cells]);
    }
    if !extra.contains("--evaluation-trials") {
        arguments.extend(["--evaluation-trials", "40"]);
    }
    arguments.extend(words(extra));
    pubs(folder, &arguments)
}

fn counts(report: &Value) -> [u64; 4] {
    let count = |field: &str| report[field].as_u64().unwrap();
    let failed = report["failed"].as_array().unwrap().len() as u64;
    [count("made"), count("kept"), failed, count("not_run")]
}

#[test]
fn one_small_cell_of_each_kind_and_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let cells = "drawer1-middle-pubs-belief,drawer1-middle-ppo,drawer1-middle-lstm1,\
                 drawer1-middle-pubs-none,light_dark-own-pubs-belief-k2,solver-sim_object-qmdp,arm-drawer1";
    // PuBS without and with the shield, and the arm without and with drift.
    let made = reproduce(folder.path(), cells, "");
    let report = made.assert_code(0).json();
    assert_eq!(counts(&report), [9, 0, 0, 0], "{report}");

    let results = folder.path().join("results");
    let id = "training-drawer1-middle-lstm1-none-seed1";
    let cell: Value = serde_json::from_str(
        &fs::read_to_string(results.join(format!("cells/{id}.json"))).unwrap(),
    )
    .unwrap();
    assert_eq!(cell["unit"]["seed"], 1);
    assert_eq!(cell["result"]["fresh"]["plain"]["trials"], 40);
    assert!(cell["time_s"].as_f64().unwrap() > 0.0);
    assert!(results.join(format!("policies/{id}.onnx")).exists());
    let arm = fs::read_to_string(results.join("cells/arm-drawer1.json")).unwrap();
    let arm: Value = serde_json::from_str(&arm).unwrap();
    let trials = arm["result"]["trials"].as_array().unwrap();
    assert_eq!(trials.len(), 2);
    assert_ne!(trials[0]["start"], trials[1]["start"], "starts vary");
    assert_ne!(
        trials[0]["world"], trials[1]["world"],
        "friction and catch vary"
    );

    let text = fs::read_to_string(results.join("report.md")).unwrap();
    for part in [
        "Table I",
        "Table II",
        "Table III",
        "Table IV",
        "Fig. 4",
        "Fig. 5",
        "not run",
    ] {
        assert!(text.contains(part), "the report lacks {part:?}");
    }
    let page = fs::read_to_string(results.join("report.html")).unwrap();
    // The name space of SVG is a name, not an address that anything is fetched from.
    let fetches = page
        .replace("http://www.w3.org/2000/svg", "")
        .contains("http");
    assert!(
        page.contains("<svg") && !fetches,
        "not one page with its figures"
    );

    // Nothing is done twice; what is damaged, or asked for otherwise, is done again.
    let kept = reproduce(folder.path(), cells, "").assert_code(0).json();
    assert_eq!(counts(&kept), [0, 9, 0, 0], "{kept}");
    fs::write(results.join(format!("cells/{id}.json")), "{").unwrap();
    let again = reproduce(folder.path(), cells, "");
    assert_eq!(counts(&again.assert_code(0).json()), [1, 8, 0, 0]);
    // So is a cell whose policy is gone, and trials on the arm that took another policy.
    fs::remove_file(results.join(format!("policies/{id}.onnx"))).unwrap();
    let path = results.join("cells/arm-drawer1.json");
    let mut arm: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    arm["result"]["policy_sha256"] = "another".into();
    fs::write(&path, arm.to_string()).unwrap();
    let again = reproduce(folder.path(), cells, "");
    assert_eq!(counts(&again.assert_code(0).json()), [2, 7, 0, 0]);
    let more = reproduce(
        folder.path(),
        "drawer1-middle-ppo",
        "--evaluation-trials 50",
    );
    assert_eq!(counts(&more.assert_code(0).json()), [1, 0, 0, 0]);
}

#[test]
fn a_kept_report_is_drawn_again_and_its_cells_are_not_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let cells = "drawer2-middle-pubs-belief-shield,arm-drawer2,solver-sim_object-qmdp";
    let counted =
        |extra: &str| counts(&reproduce(folder.path(), cells, extra).assert_code(0).json());
    assert_eq!(counted("--keep kept"), [4, 0, 0, 0]);
    let kept = folder.path().join("kept/cells.jsonl");
    let text = fs::read_to_string(&kept).unwrap();
    assert_eq!(text.lines().count(), 4, "a line a cell: {text}");
    let tables = |report: &str| {
        let report = fs::read_to_string(folder.path().join(report)).unwrap();
        let (_, tables) = report.split_once("## In brief").unwrap();
        tables.to_owned()
    };
    let before = tables("results/report.md");

    fs::remove_dir_all(folder.path().join("results")).unwrap();
    let from = "--from kept/cells.jsonl";
    assert_eq!(counted(&format!("{from} --report-only")), [0, 4, 0, 0]);
    assert_eq!(tables("results/report.md"), before);

    fs::remove_dir_all(folder.path().join("results")).unwrap();
    assert_eq!(counted(from), [0, 4, 0, 0], "none is made again");
    assert_eq!(tables("results/report.md"), before);
    // What needs a policy that was not kept says which, and how to have it.
    let arm = reproduce(folder.path(), "arm-drawer2", "--again");
    let reason = arm.assert_code(1).json()["failed"][0]["reason"].to_string();
    let unit = "training-drawer2-middle-pubs-belief-shield-seed1";
    assert!(
        reason.contains(&format!("--cells {unit} --again")),
        "{reason}"
    );

    let sound = text.lines().next().unwrap();
    let far = sound.replace("\"task\":\"drawer2\"", "\"task\":\"../../drawer2\"");
    assert_ne!(far, sound);
    for (second, said) in [("{\"cell\":", "EOF"), (far.as_str(), "names no file")] {
        fs::write(&kept, format!("{sound}\n{second}\n")).unwrap();
        _ = fs::remove_dir_all(folder.path().join("results"));
        reproduce(folder.path(), cells, &format!("{from} --report-only"))
            .assert_code(2)
            .assert_says(&["kept/cells.jsonl:2: not a cell of a reproduction", said]);
        assert!(!folder.path().join("results").exists(), "nothing is laid");
    }
}

#[test]
fn a_report_on_nothing_says_not_run() {
    let folder = tempfile::tempdir().unwrap();
    let told = reproduce(folder.path(), "", "--report-only")
        .assert_code(0)
        .json();
    let [made, kept, failed, not_run] = counts(&told);
    assert_eq!((made, kept, failed), (0, 0, 0));
    assert!(not_run > 50, "{told}");
    let text = fs::read_to_string(folder.path().join("results/report.md")).unwrap();
    assert!(text.contains("not run"));
}

#[test]
fn a_cell_that_needs_another_first_says_so_and_unknown_words_list_the_known() {
    let folder = tempfile::tempdir().unwrap();
    let alone = reproduce(folder.path(), "arm-drawer1-drift", "");
    let report = alone.assert_code(1).json();
    let reason = report["failed"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("no policy of drawer1"), "{reason}");
    let unknown = reproduce(folder.path(), "", "--only table5");
    unknown.assert_code(2).assert_says(&["table5", "table4"]);
    let none = reproduce(folder.path(), "door9", "");
    none.assert_code(2).assert_says(&["door9"]);
}
