//! The sections of the report.

use super::cell::GoalName;
use super::choices::CHOICES;
use super::frequency::{self, Point};
use super::matrix::{Entry, Format, Matrix, Ours, Row};
use super::numbers::{
    NOT_RUN, NOTHING, decimal, difference, duration, estimate, mean, percent, signed,
};
use super::paper::{self, Estimate, FREQUENCIES};
use super::results::Results;
use super::tables::{self, SOLVERS};
use super::transfer::{self, TransferRow};
use super::violations::{Count, Violations};
use pubs_draw::document::{Block, Field, Table};

/// A goal as the paper writes it.
pub(super) fn goal_name(goal: GoalName) -> &'static str {
    match goal {
        GoalName::Open => "Open",
        GoalName::Middle => "Middle",
        GoalName::Closed => "Close",
        GoalName::Own => "Own",
    }
}

/// Up to four lines for each row: ours, the paper's, the difference, the seeds.
pub(super) fn matrix(matrix: &Matrix) -> Block {
    let mut table = Table::new(&["Method", ""]);
    let titles = matrix.columns.iter().map(|column| column.title.clone());
    table.head.extend(titles);
    for row in &matrix.rows {
        let formats = || matrix.columns.iter().map(|column| column.format);
        let mut line = |name: &str, label: &str, field: &dyn Fn(&Entry, Format) -> Field| {
            let head = [name, label].map(Field::plain);
            let fields = row.entries.iter().zip(formats());
            let fields = fields.map(|(entry, format)| field(entry, format));
            table.rows.push(head.into_iter().chain(fields).collect());
        };
        line(&row.label, "ours", &ours);
        if row.entries.iter().any(|entry| entry.paper.is_some()) {
            line("", "paper", &|entry, format| {
                let text = or_nothing(entry.paper, |paper| estimate(paper, format));
                Field::bold_if(text, entry.paper_bold)
            });
            line("", "difference", &|entry, format| {
                let found = entry.difference();
                Field::plain(or_nothing(found, |found| difference(found, format)))
            });
        }
        if has_seeds(row) {
            line("", "seeds", &|entry, format| {
                Field::plain(seeds(entry, format))
            });
        }
    }
    Block::Table(table)
}

fn has_seeds(row: &Row) -> bool {
    let of_seeds = |entry: &Entry| matches!(entry.ours, Ours::Found { seeds: Some(_), .. });
    row.entries.iter().any(of_seeds)
}

fn ours(entry: &Entry, format: Format) -> Field {
    match &entry.ours {
        Ours::Found { value, .. } => Field::bold_if(estimate(*value, format), entry.ours_bold),
        Ours::NotRun => Field::plain(NOT_RUN),
        Ours::Inapplicable => Field::plain(NOTHING),
    }
}

fn seeds(entry: &Entry, format: Format) -> String {
    match &entry.ours {
        Ours::Found {
            seeds: Some(spread),
            ..
        } => {
            let [least, greatest] = spread.range.map(|end| mean(end, format));
            match spread.count {
                1 => "1 seed".to_owned(),
                count => format!("{count}: {least} to {greatest}"),
            }
        }
        _ => NOTHING.to_owned(),
    }
}

fn or_nothing<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| NOTHING.to_owned(), text)
}

/// A line for each method: violations per object, and their sum.
pub(super) fn violations(rows: &[Violations], goal: GoalName) -> Block {
    let mut table = Table::new(&["Method", ""]);
    table.head.extend(paper::OBJECTS.map(tables::name));
    table.head.push("Sum".to_owned());
    let count = |count: &Option<Count>, text: &dyn Fn(&Count) -> String| {
        count.as_ref().map_or_else(|| NOT_RUN.to_owned(), text)
    };
    for row in rows {
        let of =
            |text: &dyn Fn(&Count) -> String| row.objects.each_ref().map(|one| count(one, text));
        let sum = |sum: Option<f64>, decimals| {
            let part = match row.run() {
                4 => String::new(),
                run => format!(" ({run} of 4)"),
            };
            sum.map_or_else(|| NOT_RUN.to_owned(), |sum| decimal(sum, decimals) + &part)
        };
        let best = of(&|count| count.best.to_string());
        let head = [row.label.clone(), "best seed".to_owned()];
        let total = sum(row.best().map(|best| best as f64), 0);
        table.push(head.into_iter().chain(best).chain([total]));
        let said = paper::OBJECTS.map(|object| paper::violations(goal, object));
        if row.label == "PuBS" && said.iter().any(Option::is_some) {
            let said = said.map(|count| or_nothing(count, |count| count.to_string()));
            let head = ["", "paper, where it says"].map(str::to_owned);
            table.push(head.into_iter().chain(said).chain([NOTHING.to_owned()]));
        }
        if row.run() > 0 {
            let means =
                of(&|count| format!("{} ({})", decimal(count.mean(), 1), count.seeds.len()));
            let head = ["", "mean (seeds)"].map(str::to_owned);
            table.push(head.into_iter().chain(means).chain([sum(row.mean(), 1)]));
        }
    }
    Block::Table(table)
}

/// The points of Fig. 4 bottom.
pub(super) fn frequencies(lines: &[frequency::Line]) -> Block {
    let mut table = Table::new(&["Method", ""]);
    table
        .head
        .extend(FREQUENCIES.map(|frequency| format!("k = {frequency}")));
    for line in lines {
        let of = |text: &dyn Fn(&Point) -> String| {
            let point =
                |point: &Option<Point>| point.as_ref().map_or_else(|| NOT_RUN.to_owned(), text);
            line.points.each_ref().map(point)
        };
        let reward = of(&|point| estimate(point.reward, Format::Decimals(1, 2)));
        let head = [line.label.clone(), "reward".to_owned()];
        table.push(head.into_iter().chain(reward));
        let success = of(&|point| percent(point.success.mean));
        table.push(
            ["", "success"]
                .map(str::to_owned)
                .into_iter()
                .chain(success),
        );
        let trained = line
            .points
            .iter()
            .flatten()
            .any(|point| point.seeds.is_some());
        if trained {
            let seeds = of(&|point| or_nothing(point.seeds, |seeds| seeds.to_string()));
            table.push(["", "seeds"].map(str::to_owned).into_iter().chain(seeds));
        }
    }
    Block::Table(table)
}

/// Bounds, vectors and time of the solvers.
pub(super) fn solvers(results: &Results, tasks: &[&str]) -> Block {
    let mut table = Table::new(&[
        "Task",
        "Solver",
        "Lower bound",
        "Upper bound",
        "Gap",
        "\u{3b1}-vectors",
        "Time",
    ]);
    for &task in tasks {
        for method in SOLVERS {
            let head = [tables::name(task), method.to_string()];
            let found = match tables::solver(results, task, method, None) {
                None => [NOT_RUN; 5].map(str::to_owned),
                Some(found) => [
                    decimal(found.lower, 3),
                    decimal(found.upper, 3),
                    decimal(found.upper - found.lower, 3),
                    found.alpha_vectors.to_string(),
                    duration(found.solve_s),
                ],
            };
            table.push(head.into_iter().chain(found));
        }
    }
    Block::Table(table)
}

/// Table IV. The paper's numbers stand beside those without drift.
pub(super) fn transfer(results: &Results, drift: bool) -> Block {
    let mut table = Table::new(&["Object", "", "Success", "Goal error", "Time per unit"]);
    for object in paper::OBJECTS {
        let row = transfer::transfer(results, object, drift);
        let (unit, _) = transfer::unit(object);
        table.push(transfer_ours(object, row.as_ref(), unit));
        let Some(paper) = paper::table_iv(object).filter(|_| !drift) else {
            continue;
        };
        table.push([
            String::new(),
            "paper".to_owned(),
            percent(paper.success_rate),
            lengths(Some(paper.goal_error), unit, 2),
            times(Some(paper.time_per_unit), unit),
        ]);
        let Some(row) = row else { continue };
        let less = |ours: Option<Estimate>, paper: Estimate, decimals| {
            or_nothing(ours, |ours| signed(ours.mean - paper.mean, decimals))
        };
        table.push([
            String::new(),
            "difference".to_owned(),
            difference(row.success_rate - paper.success_rate, Format::Percent),
            less(row.goal_error, paper.goal_error, 2),
            less(row.time_per_unit, paper.time_per_unit, 3),
        ]);
    }
    Block::Table(table)
}

fn transfer_ours(object: &str, row: Option<&TransferRow>, unit: &str) -> [String; 5] {
    let head = [tables::name(object), "ours".to_owned()];
    let fields = match row {
        None => [NOT_RUN; 3].map(str::to_owned),
        Some(row) => {
            let [lower, upper] = row.success_interval.map(|end| decimal(100.0 * end, 1));
            let success = format!(
                "{} ({} of {}; {lower} to {upper})",
                percent(row.success_rate),
                row.outcomes.reached,
                row.trials
            );
            let error = lengths(row.goal_error, unit, 2);
            [success, error, times(row.time_per_unit, unit)]
        }
    };
    let [name, label] = head;
    let [success, error, time] = fields;
    [name, label, success, error, time]
}

fn lengths(value: Option<Estimate>, unit: &str, decimals: usize) -> String {
    let format = Format::Decimals(decimals, decimals);
    or_nothing(value, |value| format!("{} {unit}", estimate(value, format)))
}

fn times(value: Option<Estimate>, unit: &str) -> String {
    let format = Format::Decimals(3, 3);
    or_nothing(value, |value| {
        format!("{} s/{unit}", estimate(value, format))
    })
}

/// How the trials ended.
pub(super) fn outcomes(results: &Results, drift: bool) -> Block {
    let mut table = Table::new(&[
        "Object",
        "Trials",
        "Reached",
        "Missed",
        "Timed out",
        "Stopped for safety",
        "Faults",
        "Violations",
    ]);
    for object in paper::OBJECTS {
        let name = tables::name(object);
        let fields = match transfer::transfer(results, object, drift) {
            None => [NOT_RUN; 7].map(str::to_owned),
            Some(row) => [
                row.trials,
                row.outcomes.reached,
                row.outcomes.missed,
                row.outcomes.timed_out,
                row.outcomes.safety_stop,
                row.outcomes.fault,
                row.safety_violations,
            ]
            .map(|count| count.to_string()),
        };
        table.push([name].into_iter().chain(fields));
    }
    Block::Table(table)
}

/// What the paper leaves open.
pub(super) fn choices() -> Block {
    let item = |choice: &super::choices::Choice| format!("{}: {}", choice.open, choice.chosen);
    Block::List(CHOICES.iter().map(item).collect())
}
