//! The report on a reproduction, as files.

#![allow(clippy::unwrap_used)]

mod common;

use std::path::Path;

use common::{arm, arm_trial, solved, solver, store, trained, training, under_shield, varied};
use pubs_evaluate::reproduce::cell::{
    Cell, CellResult, EntropyInput, GoalName, Method, Outcome, Unit,
};
use pubs_evaluate::reproduce::heatmap::{PICTURES, heatmap_id};
use pubs_evaluate::reproduce::paper::{ABLATED, ENTROPIES, FREQUENCIES, GOALS, METHODS, OBJECTS};
use pubs_evaluate::reproduce::report::{self, ReportContext};
use pubs_evaluate::reproduce::{CELLS, HEATMAPS, Heatmap, Results, tables};
use tempfile::TempDir;

/// Writes the report beside the results and gives one of its files.
fn written(folder: &Path, planned: Vec<Unit>, file: &str) -> String {
    let results = Results::read(folder).unwrap();
    let context = ReportContext {
        command: "pubs-engine reproduce".to_owned(),
        engine_version: "0.1.0".to_owned(),
        vector_unit: "avx2".to_owned(),
        made_at: "2026-01-02T03:04:05Z".to_owned(),
        planned,
    };
    let files = report::write(&results, folder, &context).unwrap();
    for file in &files {
        assert!(file.exists(), "{} was not written", file.display());
    }
    std::fs::read_to_string(folder.join(file)).unwrap()
}

/// Something in every place of the report but for two cells of the plan.
fn whole(folder: &Path) -> Vec<Unit> {
    let mut planned = units();
    for (index, unit) in planned.iter().enumerate() {
        let level = (index as u64 * 37 + 11) % 101;
        let mean = 0.4 + 0.005 * level as f64;
        let result = match unit {
            Unit::Training { task, method, .. } => {
                let shield = *method == Method::Pubs && !task.contains("dark");
                let violations = if shield { level / 30 } else { level * level };
                trained(mean, mean, 0.001, violations, shield)
            }
            Unit::Solver { .. } => solved(mean),
            Unit::Arm { .. } => CellResult::Arm {
                policy_sha256: String::new(),
                trials: (0..20).map(arm_trial_of).collect(),
            },
        };
        store(folder, unit.clone(), result);
    }
    planned.extend(OBJECTS[..2].iter().map(|object| arm(object, true)));
    std::fs::create_dir_all(folder.join(HEATMAPS)).unwrap();
    for (task, goal, title) in PICTURES {
        let id = heatmap_id(task, goal);
        let file = folder.join(HEATMAPS).join(format!("{id}.json"));
        std::fs::write(file, serde_json::to_string(&heatmap(title)).unwrap()).unwrap();
    }
    planned
}

fn arm_trial_of(index: u8) -> pubs_evaluate::reproduce::cell::ArmTrial {
    let index = f64::from(index);
    let outcome = if index % 10.0 == 9.0 {
        Outcome::Missed
    } else {
        Outcome::Reached
    };
    arm_trial(outcome, 0.05 * (index % 5.0), 0.01 + 0.001 * index, 12.0)
}

fn units() -> Vec<Unit> {
    let mut units = Vec::new();
    for goal in GOALS {
        for method in METHODS {
            let seeds = if method == Method::Lstm2 { 1 } else { 5 };
            let of = |object| (1..=seeds).map(move |seed| training(object, goal, method, seed));
            let trained: Vec<Unit> = OBJECTS.into_iter().flat_map(of).collect();
            if method == Method::Pubs {
                units.extend(trained.iter().cloned().map(under_shield));
            }
            units.extend(trained);
        }
    }
    let own = GoalName::Own;
    for task in ["sim_object", "light_dark", "light_dark_wide"] {
        units.push(training(task, own, Method::Pubs, 1));
        units.extend(tables::SOLVERS.map(|method| solver(task, method)));
    }
    for task in ABLATED {
        let goal = if task.contains('_') {
            own
        } else {
            GoalName::Middle
        };
        for entropy in ENTROPIES {
            units.push(varied(task, goal, Method::Pubs, entropy, None, 1));
        }
    }
    let belief = EntropyInput::Belief;
    for frequency in FREQUENCIES.map(Some) {
        units.push(varied(
            "light_dark",
            own,
            Method::Pubs,
            belief,
            frequency,
            1,
        ));
    }
    units.extend(OBJECTS.map(|object| arm(object, false)));
    units
}

fn heatmap(title: &str) -> Heatmap {
    let mean: Vec<_> = (0..=125).map(f64::from).collect();
    let entropy: Vec<_> = (0..=50).map(|row| f64::from(row) / 50.0).collect();
    let chosen = |mean: f64, entropy: f64| match (entropy < 0.3, mean < 62.5) {
        (true, _) if (mean - 62.5).abs() < 8.0 => 0,
        (true, true) => 3,
        (true, false) => 4,
        (false, true) => 1,
        (false, false) => 2,
    };
    let row = |entropy: &f64| mean.iter().map(|mean| chosen(*mean, *entropy)).collect();
    Heatmap {
        task: "door2".to_owned(),
        title: title.to_owned(),
        unit: "deg".to_owned(),
        action: entropy.iter().map(row).collect(),
        mean,
        entropy,
        actions: ["stop", "safe_open", "safe_close", "high_open", "high_close"]
            .map(str::to_owned)
            .into(),
        goal: 62.5,
    }
}

#[test]
fn markdown_has_even_tables_and_its_figures() {
    let folder = TempDir::new().unwrap();
    let planned = whole(folder.path());
    let text = written(folder.path(), planned, "report.md");
    let columns = |line: &str| line.replace("\\|", "").matches('|').count();
    let lines: Vec<_> = text.lines().collect();
    let mut tables = 0;
    for pair in lines.windows(2).filter(|pair| pair[1].starts_with('|')) {
        let [above, line] = [pair[0], pair[1]];
        if above.starts_with('|') {
            assert_eq!(columns(above), columns(line), "{above}\n{line}");
        } else {
            assert_eq!(above, "", "no empty line above the table {line}");
            tables += 1;
        }
    }
    // I and violations by goal; frequency; II, variants and their solvers; III; IV; provenance.
    assert_eq!(tables, 3 + 3 + 1 + 4 + 1 + 4 + 1);
    for figure in lines.iter().filter(|line| line.starts_with("![")) {
        let file = figure.split("](").nth(1).unwrap().trim_end_matches(')');
        let svg = std::fs::read_to_string(folder.path().join(file)).unwrap();
        pubs_draw::png(&svg, 0.5).unwrap();
    }
    assert!(text.contains("not run: 2\n"), "two arm cells are missing");
    let missing = "| arm-drawer1-drift | \u{2013} | not run |";
    assert!(text.contains(missing), "no cell \"{missing}\"");
}

#[test]
fn html_stands_alone() {
    let folder = TempDir::new().unwrap();
    let planned = whole(folder.path());
    let text = written(folder.path(), planned, "report.html");
    let outside = [
        "src=", "href=", "url(", "@import", "<script", "<link", "<img",
    ];
    for outside in outside {
        assert!(
            !text.contains(outside),
            "needs something beside it: {outside}"
        );
    }
    let names = text.matches("xmlns=\"http://www.w3.org/2000/svg\"").count();
    assert_eq!(text.matches("://").count(), names, "addresses");
    for tag in ["table", "figure", "svg", "h2", "ul", "li", "tr", "td"] {
        let opened = [format!("<{tag}>"), format!("<{tag} ")];
        let opened: usize = opened
            .iter()
            .map(|tag| text.matches(tag.as_str()).count())
            .sum();
        let closed = text.matches(&format!("</{tag}>")).count();
        assert_eq!(opened, closed, "{tag}");
    }
    assert_eq!(
        text.matches("<svg").count(),
        5,
        "Fig. 4 twice, Fig. 5 three times"
    );
    // To look at it.
    if let Some(kept) = std::env::var_os("PUBS_KEEP_REPORT") {
        let files = folder.keep();
        for entry in std::fs::read_dir(&files).unwrap() {
            let file = entry.unwrap().path();
            if file.extension().is_some_and(|end| end == "svg") {
                let svg = std::fs::read_to_string(&file).unwrap();
                let png = pubs_draw::png(&svg, 1.0).unwrap();
                std::fs::write(file.with_extension("png"), png).unwrap();
            }
        }
        std::fs::rename(files, kept).unwrap();
    }
}

#[test]
fn what_is_not_run_is_said_and_never_zero() {
    let folder = TempDir::new().unwrap();
    let door1 = training("door1", GoalName::Open, Method::Pubs, 1);
    let planned = vec![arm("door2", false), door1];
    let text = written(folder.path(), planned, "report.md");
    assert!(text.contains("Cells run: 0; not run: 2"), "{text}");
    for line in text.lines().filter(|line| line.contains("| ours |")) {
        let fields = line.trim_matches('|').split(" | ").skip(2);
        for field in fields {
            assert_eq!(field.trim(), "not run", "{line}");
        }
    }
    for (_, _, title) in PICTURES {
        assert!(text.contains(&format!("{title}: not run.")), "{title}");
    }
    let svg = std::fs::read_to_string(folder.path().join("fig4-violations.svg")).unwrap();
    let bars = svg.matches("not run").count();
    assert_eq!(bars, 15, "five methods at three goals");
}

#[test]
fn files_that_were_passed_over_are_named() {
    let folder = TempDir::new().unwrap();
    let cells = folder.path().join(CELLS);
    std::fs::create_dir_all(&cells).unwrap();
    std::fs::write(cells.join("cut.json"), "{").unwrap();
    let text = written(folder.path(), Vec::new(), "report.md");
    assert!(text.contains("Passed over: cut.json: EOF"), "{text}");
}

#[test]
fn cells_of_another_object_file_filter_or_shield_are_said_not_to_compare() {
    let unit = |seed| training("door2", GoalName::Middle, Method::Pubs, seed);
    let (plain, shielded) = (
        ("file", Some("filter"), None),
        ("file", Some("filter"), Some("shield")),
    );
    let cases = [
        ([plain, shielded], None),
        ([("file", None, None), shielded], None),
        (
            [shielded, ("other", Some("filter"), Some("shield"))],
            Some("2 different object files"),
        ),
        (
            [plain, ("other", None, None)],
            Some("2 different object files"),
        ),
        (
            [shielded, ("file", Some("other"), Some("shield"))],
            Some("2 different filters"),
        ),
        (
            [shielded, ("file", Some("filter"), Some("other"))],
            Some("2 different shields"),
        ),
    ];
    for (hashes, said) in cases {
        let folder = TempDir::new().unwrap();
        for (seed, (file, filter, shield)) in (1..).zip(hashes) {
            let unit = unit(seed);
            let result = trained(0.5, 0.5, 0.001, 0, true);
            store(folder.path(), unit.clone(), result);
            let path = folder.path().join(format!("{CELLS}/{}.json", unit.id()));
            let text = std::fs::read_to_string(&path).unwrap();
            let mut cell: Cell = serde_json::from_str(&text).unwrap();
            cell.task_hash = file.to_owned();
            cell.filter_hash = filter.map(str::to_owned);
            cell.shield_hash = shield.map(str::to_owned);
            std::fs::write(&path, serde_json::to_string(&cell).unwrap()).unwrap();
        }
        let report = written(folder.path(), Vec::new(), "report.md");
        let found = report.lines().find(|line| line.contains("Not comparable"));
        match said {
            None => assert_eq!(found, None, "{hashes:?}"),
            Some(said) => assert!(
                found.is_some_and(|line| line.contains(said)),
                "{hashes:?}: {found:?}"
            ),
        }
    }
}
