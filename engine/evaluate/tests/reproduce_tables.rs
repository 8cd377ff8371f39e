//! The tables of a reproduction against sums by hand.

#![allow(clippy::unwrap_used)]

mod common;

use std::path::Path;

use common::{arm, arm_trial, solved, solver, store, trained, training, under_shield, varied};
use pubs_evaluate::reproduce::brief::Lead;
use pubs_evaluate::reproduce::cell::{
    CellResult, EntropyInput, GoalName, Method, Outcome, SolverMethod,
};
use pubs_evaluate::reproduce::matrix::{Matrix, Ours};
use pubs_evaluate::reproduce::paper::GOALS;
use pubs_evaluate::reproduce::{CELLS, Results, frequency, tables, transfer, violations};
use tempfile::TempDir;

/// What we found, whether it is bold, and the difference from the paper.
fn entry<'m>(matrix: &'m Matrix, row: &str, column: &str) -> (&'m Ours, bool, Option<f64>) {
    let row = matrix.rows.iter().find(|found| found.label == row).unwrap();
    let mut columns = matrix.columns.iter();
    let column = columns.position(|found| found.title == column).unwrap();
    let entry = &row.entries[column];
    (&entry.ours, entry.ours_bold, entry.difference())
}

#[test]
fn best_seed_is_chosen_on_the_selection_and_shown_fresh() {
    let folder = TempDir::new().unwrap();
    for (seed, selection, fresh) in [(1, 0.90, 0.80), (2, 0.95, 0.85), (3, 0.91, 0.89)] {
        let unit = training("door2", GoalName::Middle, Method::Pubs, seed);
        let result = trained(selection, fresh, 0.002, 3, true);
        store(folder.path(), under_shield(unit.clone()), result.clone());
        store(folder.path(), unit, result);
    }
    // On either side of 0.85 - 1.96 · 0.002 = 0.84608.
    for (method, fresh) in [(Method::Ppo, 0.8462), (Method::Lstm1, 0.8460)] {
        let unit = training("door2", GoalName::Middle, method, 1);
        store(folder.path(), unit, trained(0.5, fresh, 0.02, 5, false));
    }
    let results = Results::read(folder.path()).unwrap();
    assert_eq!(results.notices(), []);
    let table = tables::table_i(&results, GoalName::Middle);

    let (found, bold, difference) = entry(&table, "PuBS", "Door 2");
    let Ours::Found {
        value,
        seeds: Some(spread),
    } = found
    else {
        panic!("{found:?}");
    };
    let shown = (value.mean, value.se);
    assert_eq!(shown, (0.85, 0.002), "seed 3 leads on fresh trials alone");
    let spread = (spread.best, spread.count, spread.range);
    assert_eq!(spread, (2, 3, [0.80, 0.89]));
    assert!(bold, "the best is within its own interval");
    let difference = difference.unwrap();
    assert!(
        (difference - 0.133).abs() < 1e-12,
        "0.85 - 0.717: {difference}"
    );

    let (found, bold, difference) = entry(&table, tables::SHIELDED, "Door 2");
    assert_eq!(found.value().unwrap().mean, 0.85 + 0.01, "{found:?}");
    let beside = (bold, difference);
    assert_eq!(
        beside,
        (false, None),
        "the shield is no method of the paper"
    );

    let bold = ["PPO", "LSTM1"].map(|row| entry(&table, row, "Door 2").1);
    assert_eq!(bold, [true, false]);
    for (row, column) in [("LSTM2", "Door 2"), ("PuBS", "Drawer 1")] {
        let found = entry(&table, row, column);
        assert_eq!(found, (&Ours::NotRun, false, None), "{row}, {column}");
    }
}

#[test]
fn bold_in_the_paper_follows_from_its_numbers() {
    let results = Results::read(Path::new("no such folder")).unwrap();
    let table = |goal| tables::table_i(&results, goal);
    let bold = |matrix: &Matrix, row: usize| -> Vec<bool> {
        let entries = matrix.rows[row].entries.iter();
        entries.map(|entry| entry.paper_bold).collect()
    };
    let middle = table(GoalName::Middle);
    assert_eq!(bold(&middle, 0), [true; 4], "PuBS is decisively best");
    for row in 1..5 {
        assert_eq!(bold(&middle, row), [false; 4], "row {row}");
    }
    let open = table(GoalName::Open);
    let pubs = bold(&open, 0);
    assert_eq!(
        pubs, [true; 4],
        "0.805 is within 1.96 · 0.002 of LSTM1's 0.807"
    );
    assert_eq!(bold(&open, 2), [false, false, true, false], "PPO at Door 1");
    let closed = bold(&table(GoalName::Closed), 0);
    assert_eq!(closed, [true, false, true, true], "the text names Drawer 2");

    let mut lead = Lead::default();
    for goal in GOALS {
        lead.count(&table(goal), |entry| entry.paper, |entry| entry.paper_bold);
    }
    let counted = (lead.whole, lead.first, lead.bold);
    assert_eq!(counted, (12, 9, 11), "of the paper's twelve cells");
}

#[test]
fn violations_are_summed_over_objects() {
    let folder = TempDir::new().unwrap();
    let cells = [
        ("drawer1", 1, 0.9, 2),
        ("drawer1", 2, 0.8, 40),
        ("door1", 1, 0.7, 5),
    ];
    for (object, seed, selection, count) in cells {
        let unit = training(object, GoalName::Open, Method::Pubs, seed);
        let result = trained(selection, 0.5, 0.001, count, true);
        store(folder.path(), under_shield(unit.clone()), result.clone());
        store(folder.path(), unit, result);
    }
    let results = Results::read(folder.path()).unwrap();
    let rows = violations::violations(&results, GoalName::Open);
    let labels: Vec<_> = rows.iter().map(|row| row.label.as_str()).collect();
    assert_eq!(labels, ["PuBS", tables::SHIELDED, "PPO", "LSTM1", "LSTM2"]);
    // Best seeds 2 + 5; means (2 + 40)/2 + 5.
    let sums = |row: usize| (rows[row].best(), rows[row].mean(), rows[row].run());
    assert_eq!(sums(0), (Some(7), Some(26.0), 2), "PuBS");
    assert_eq!(sums(1), (Some(0), Some(0.0), 2), "with shield");
    assert_eq!(sums(2), (None, None, 0), "PPO was not run");
}

#[test]
fn light_dark_has_undiscounted_rewards_and_level_lines_of_solvers() {
    let folder = TempDir::new().unwrap();
    let belief = EntropyInput::Belief;
    let own = GoalName::Own;
    for (frequency, fresh) in [(None, 0.92), (Some(1), 0.81)] {
        let unit = varied("light_dark", own, Method::Pubs, belief, frequency, 1);
        store(folder.path(), unit, trained(0.9, fresh, 0.001, 0, false));
    }
    let sarsop = solver("light_dark", SolverMethod::Sarsop);
    store(folder.path(), sarsop, solved(0.88));
    let results = Results::read(folder.path()).unwrap();

    let table = tables::table_ii(&results, &["light_dark", "sim_object"]);
    let (found, bold, difference) = entry(&table, "PuBS", "Light-Dark");
    assert_eq!((found.value().unwrap().mean, bold), (92.0, true));
    let difference = difference.unwrap();
    assert!((difference - 3.3).abs() < 1e-9, "92 - 88.7: {difference}");
    let (found, bold, _) = entry(&table, "SARSOP", "Light-Dark");
    assert_eq!((found.value().unwrap().mean, bold), (88.0, false));
    assert_eq!(entry(&table, "QMDP", "Light-Dark").0, &Ours::NotRun);
    let shielded = entry(&table, tables::SHIELDED, "Light-Dark").0;
    assert_eq!(shielded, &Ours::Inapplicable, "no high-force action");

    let lines = frequency::lines(&results);
    let rewards = |line: usize| {
        let points = lines[line].points;
        points.map(|point| point.map(|point| point.reward.mean))
    };
    let pubs = [Some(81.0), None, None, Some(92.0)];
    assert_eq!(rewards(0), pubs, "the object file has 10");
    assert_eq!(rewards(1), [Some(88.0); 4], "SARSOP");
    assert_eq!(rewards(2), [None; 4], "QMDP was not run");
}

#[test]
fn ablations_are_columns_of_one_table() {
    let folder = TempDir::new().unwrap();
    let cells = [
        (EntropyInput::Belief, 0.7),
        (EntropyInput::Random, 0.6),
        (EntropyInput::None, 0.6995),
    ];
    for (entropy, fresh) in cells {
        let unit = varied("door1", GoalName::Middle, Method::Pubs, entropy, None, 1);
        store(folder.path(), unit, trained(fresh, fresh, 0.001, 0, true));
    }
    let results = Results::read(folder.path()).unwrap();
    let table = tables::table_iii(&results);
    let rows = ["PuBS", "Random H", "No H"].map(|row| {
        let (found, bold, _) = entry(&table, row, "Door 1");
        (found.value().map(|value| value.mean), bold)
    });
    let expected = [(Some(0.7), true), (Some(0.6), false), (Some(0.6995), true)];
    assert_eq!(rows, expected);
    assert_eq!(entry(&table, "PuBS", "Light-Dark").0, &Ours::NotRun);
}

#[test]
fn transfer_counts_successful_trials() {
    let folder = TempDir::new().unwrap();
    let trials = vec![
        arm_trial(Outcome::Reached, 0.4, 0.01, 20.0),
        arm_trial(Outcome::Reached, 0.3, 0.03, 20.0),
        arm_trial(Outcome::SafetyStop, 0.1, 0.4, 1.0),
        arm_trial(Outcome::Reached, 0.5, 0.02, 1.0),
    ];
    let unit = arm("drawer1", false);
    store(
        folder.path(),
        unit,
        CellResult::Arm {
            policy_sha256: String::new(),
            trials,
        },
    );
    let results = Results::read(folder.path()).unwrap();
    let row = transfer::transfer(&results, "drawer1", false).unwrap();
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-9;
    let counts = (row.trials, row.success_rate, row.safety_violations);
    assert_eq!(counts, (4, 0.75, 1));
    let error = row.goal_error.unwrap();
    let by_hand = near(error.mean, 2.0) && near(error.se, 1.0 / 3f64.sqrt());
    assert!(by_hand, "1, 3 and 2 cm: {error:?}");
    let time = row.time_per_unit.unwrap();
    let by_hand = near(time.mean, 1.5) && near(time.se, 0.5);
    assert!(
        by_hand,
        "20 s over 10 and over 20 cm, no distance: {time:?}"
    );
    assert_eq!(transfer::transfer(&results, "drawer1", true), None);
}

#[test]
fn damaged_and_foreign_files_are_named_and_passed_over() {
    let folder = TempDir::new().unwrap();
    let unit = training("door1", GoalName::Open, Method::Ppo, 1);
    store(
        folder.path(),
        unit.clone(),
        trained(0.5, 0.5, 0.01, 0, false),
    );
    store(folder.path(), arm("door1", false), solved(0.1));
    let cells = folder.path().join(CELLS);
    let good = cells.join(format!("{}.json", unit.id()));
    std::fs::copy(&good, cells.join("renamed.json")).unwrap();
    let text = std::fs::read(&good).unwrap();
    std::fs::write(cells.join("cut.json"), &text[..50]).unwrap();
    std::fs::write(cells.join("notes.txt"), "not looked at").unwrap();
    let results = Results::read(folder.path()).unwrap();
    assert_eq!(results.cells().count(), 1);
    assert!(results.cell(&unit).is_some());
    let notices: Vec<_> = results
        .notices()
        .iter()
        .map(|notice| notice.file.file_name().unwrap().to_str().unwrap())
        .collect();
    assert_eq!(notices, ["arm-door1.json", "cut.json", "renamed.json"]);
}
