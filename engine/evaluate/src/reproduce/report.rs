//! The report: `report.md` with its figures beside it, and `report.html` with them inside.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use pubs_draw::DrawError;

use super::brief::brief;
use super::cell::{Cell, CellResult, Unit};
use super::heatmap::{PICTURES, heatmap_id};
use super::markdown::markdown;
use super::numbers::{NOT_RUN, NOTHING, duration};
use super::results::Results;
use super::{figures, frequency, paper, sections, tables, violations};
use pubs_draw::document::{Block, Figure, Table};
use pubs_draw::html;

/// What the report says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportContext {
    /// The command that made it.
    pub command: String,
    /// Version of the engine that writes it.
    pub engine_version: String,
    /// The vector unit of this machine.
    pub vector_unit: String,
    /// When: RFC 3339, UTC.
    pub made_at: String,
    /// Every unit of the whole reproduction, run or not.
    pub planned: Vec<Unit>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A file cannot be written.
    #[error("cannot write {}: {source}", file.display())]
    Write {
        /// The file or folder.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Writes the report into a folder, which is made where it is not there, and says which files.
///
/// # Errors
/// [`ReportError`].
pub fn write(
    results: &Results,
    folder: &Path,
    context: &ReportContext,
) -> Result<Vec<PathBuf>, ReportError> {
    let blocks = blocks(results, context)?;
    let refused = |file: &Path| {
        let file = file.to_owned();
        |source| ReportError::Write { file, source }
    };
    std::fs::create_dir_all(folder).map_err(refused(folder))?;
    let mut texts = vec![
        ("report.md", markdown(&blocks)),
        ("report.html", html(&blocks)),
    ];
    for block in &blocks {
        if let Block::Figure(Figure { file, svg, .. }) = block {
            texts.push((file, svg.clone()));
        }
    }
    let mut files = Vec::new();
    for (name, text) in texts {
        let file = folder.join(name);
        std::fs::write(&file, text).map_err(refused(&file))?;
        files.push(file);
    }
    Ok(files)
}

fn blocks(results: &Results, context: &ReportContext) -> Result<Vec<Block>, DrawError> {
    let mut blocks = head(results, context);
    blocks.push(heading("In brief"));
    blocks.push(Block::List(brief(results)));
    blocks.extend(table_i(results));
    blocks.extend(figure_4(results)?);
    blocks.extend(table_ii(results));
    blocks.extend(table_iii(results));
    blocks.extend(figure_5(results)?);
    blocks.extend(table_iv(results));
    blocks.push(heading("What the paper leaves open"));
    blocks.push(sections::choices());
    blocks.extend(provenance(results, context));
    Ok(blocks)
}

fn heading(text: &str) -> Block {
    Block::Heading(text.to_owned())
}

fn paragraph(text: &str) -> Block {
    Block::Paragraph(text.to_owned())
}

fn head(results: &Results, context: &ReportContext) -> Vec<Block> {
    let planned: BTreeSet<_> = context.planned.iter().map(Unit::id).collect();
    let run: BTreeSet<_> = results.cells().map(|(id, _)| id.to_owned()).collect();
    let missing = planned.difference(&run).count();
    let time: f64 = results.cells().map(|(_, cell)| cell.time_s).sum();
    let mut items = vec![
        format!(
            "Written by pubs-engine {}, {}",
            context.engine_version, context.made_at
        ),
        format!(
            "Vector unit, on which the last bits depend: {}",
            context.vector_unit
        ),
        format!("Cells run: {}; not run: {missing}", run.len()),
        format!("Time of the cells that are run, summed: {}", duration(time)),
    ];
    let made_with = |of: fn(&Cell) -> &str| {
        let found: BTreeSet<_> = results.cells().map(|(_, cell)| of(cell)).collect();
        found.into_iter().collect::<Vec<_>>().join(", ")
    };
    if !run.is_empty() {
        let versions = made_with(|cell| &cell.engine_version);
        let units = made_with(|cell| &cell.vector_unit);
        items.push(format!("Cells made by version {versions} on {units}"));
    }
    let passed_over = results.notices().iter().map(|notice| {
        let file = notice.file.file_name().unwrap_or_default();
        format!("Passed over: {}: {}", file.to_string_lossy(), notice.reason)
    });
    items.extend(passed_over);
    items.extend(mixtures(results));
    vec![
        Block::Title("The paper's evaluation, reproduced".to_owned()),
        paragraph(
            "Section IV of the paper (Planning using Belief Summaries, PuBS) on the objects of \
             this project, which are simulated: each table has our numbers, the paper's, and ours \
             less the paper's. Real objects of the paper's kind differ from ours, so the order of \
             the methods says more than the numbers themselves.",
        ),
        Block::Command(context.command.clone()),
        Block::List(items),
        paragraph(
            "The best seed is the one with the greatest mean reward on a first set of trials; what \
             is shown is what it reaches on a fresh set, \u{b1} the standard error. Beside it: how \
             many seeds, and the least and the greatest that they reach there. Bold is what lies \
             within the 95 % confidence interval of the best method, as in the paper; the row with \
             the shield stands outside that comparison.",
        ),
    ]
}

fn table_i(results: &Results) -> Vec<Block> {
    let mut blocks = vec![
        heading("Table I: against reinforcement learning on raw observations"),
        paragraph("Mean discounted reward."),
    ];
    for goal in paper::GOALS {
        blocks.push(Block::Subheading(sections::goal_name(goal).to_owned()));
        blocks.push(sections::matrix(&tables::table_i(results, goal)));
    }
    blocks
}

fn figure_4(results: &Results) -> Result<Vec<Block>, DrawError> {
    let goals = paper::GOALS.map(|goal| {
        let rows = violations::violations(results, goal);
        (sections::goal_name(goal), rows)
    });
    let mut blocks = vec![
        heading("Fig. 4, top: safety violations"),
        Block::Figure(Figure {
            file: "fig4-violations.svg".to_owned(),
            svg: figures::bars(&goals)?,
            caption: "Safety violations per goal, summed over the tasks: the best seeds, and the \
                      mean over all seeds as a dot"
                .to_owned(),
        }),
    ];
    for (goal, (name, rows)) in paper::GOALS.into_iter().zip(&goals) {
        blocks.push(Block::Subheading((*name).to_owned()));
        blocks.push(sections::violations(rows, goal));
    }
    let lines = frequency::lines(results);
    blocks.extend([
        heading("Fig. 4, bottom: the frequency of the belief"),
        paragraph(
            "Light-Dark, with k updates of the filter during a large move. A solver that was not \
             run at a k stands with what it reaches on the object as it is.",
        ),
        Block::Figure(Figure {
            file: "fig4-frequency.svg".to_owned(),
            svg: figures::lines(&lines)?,
            caption: "Reward and success on Light-Dark against the filter's updates per large \
                      move, with 95 % intervals"
                .to_owned(),
        }),
        sections::frequencies(&lines),
    ]);
    Ok(blocks)
}

fn table_ii(results: &Results) -> Vec<Block> {
    let tasks = ["light_dark", "sim_object"];
    let mut blocks = vec![
        heading("Table II: against offline solvers"),
        paragraph("Mean reward, undiscounted for Light-Dark and discounted for Sim Object."),
        sections::matrix(&tables::table_ii(results, &tasks)),
        paragraph("The solvers; bounds are of the discounted value of the first belief."),
        sections::solvers(results, &tasks),
    ];
    let variants = tables::light_dark_variants(results);
    if !variants.is_empty() {
        blocks.extend([
            Block::Subheading("Variants of Light-Dark".to_owned()),
            sections::matrix(&tables::table_ii(results, &variants)),
            sections::solvers(results, &variants),
        ]);
    }
    blocks
}

/// Objects whose cells were not made from one object file, with one filter and under one shield:
/// their numbers do not compare.
fn mixtures(results: &Results) -> Vec<String> {
    let mut hashes: BTreeMap<(&str, Option<u32>, &str), BTreeSet<&str>> = BTreeMap::new();
    for (_, cell) in results.cells() {
        let (task, frequency) = (cell.unit.task(), cell.unit.belief_frequency());
        let mut found = |what, hash| {
            _ = hashes
                .entry((task, frequency, what))
                .or_default()
                .insert(hash);
        };
        found("object files", cell.task_hash.as_str());
        if let Some(filter) = &cell.filter_hash {
            found("filters", filter);
        }
        if let Some(shield) = &cell.shield_hash {
            found("shields", shield);
        }
    }
    let mixed = hashes.into_iter().filter(|(_, found)| found.len() > 1);
    mixed
        .map(|((task, _, what), found)| {
            format!(
                "Not comparable: the cells of {task} were made from {} different {what}; run \
                 the older ones again",
                found.len()
            )
        })
        .collect()
}

fn table_iii(results: &Results) -> Vec<Block> {
    vec![
        heading("Table III: without the entropy"),
        paragraph(
            "Mean discounted reward at the middle goals, undiscounted for Light-Dark. Rows and \
             columns are swapped against the paper.",
        ),
        sections::matrix(&tables::table_iii(results)),
    ]
}

fn figure_5(results: &Results) -> Result<Vec<Block>, DrawError> {
    let mut blocks = vec![
        heading("Fig. 5: what the policies do"),
        paragraph("The action that is chosen at each mean and entropy of the belief."),
    ];
    for (task, goal, title) in PICTURES {
        let id = heatmap_id(task, goal);
        let Some(heatmap) = results.heatmap(&id) else {
            blocks.push(Block::Paragraph(format!("{title}: {NOT_RUN}.")));
            continue;
        };
        blocks.push(Block::Figure(Figure {
            file: format!("fig5-{id}.svg"),
            svg: figures::heatmap(heatmap)?,
            caption: format!("{title}: the chosen action over mean and entropy"),
        }));
    }
    Ok(blocks)
}

fn table_iv(results: &Results) -> Vec<Block> {
    let mut blocks = vec![
        heading("Table IV: transfer"),
        paragraph(
            "Middle goals, through the whole run loop on the virtual arm, with starts, friction \
             and catch varied. The goal error and the time per start-to-goal distance are those of \
             the successful trials; beside the success stands its 95 % interval after Wilson.",
        ),
    ];
    for (drift, title) in [(false, "Without drift"), (true, "With sensor drift")] {
        blocks.extend([
            Block::Subheading(title.to_owned()),
            sections::transfer(results, drift),
            sections::outcomes(results, drift),
        ]);
    }
    blocks
}

fn provenance(results: &Results, context: &ReportContext) -> Vec<Block> {
    let mut table = Table::new(&[
        "Cell",
        "Seed",
        "Steps",
        "Time",
        "Made",
        "Version",
        "Vector unit",
        "Task",
        "Recipe",
    ]);
    for (id, cell) in results.cells() {
        let (seed, steps, recipe) = training_of(cell);
        table.push([
            id.to_owned(),
            seed,
            steps,
            duration(cell.time_s),
            cell.made_at.clone(),
            cell.engine_version.clone(),
            cell.vector_unit.clone(),
            cell.task_hash.chars().take(12).collect(),
            recipe,
        ]);
    }
    let missing = context
        .planned
        .iter()
        .filter(|unit| results.cell(unit).is_none());
    for unit in missing {
        let seed = match unit {
            Unit::Training { seed, .. } => seed.to_string(),
            Unit::Solver { .. } | Unit::Arm { .. } => NOTHING.to_owned(),
        };
        let rest = [
            NOT_RUN, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING,
        ];
        table.push([unit.id(), seed].into_iter().chain(rest.map(str::to_owned)));
    }
    vec![heading("Provenance"), Block::Table(table)]
}

/// Seed, steps and recipe of a training; of other cells there are none.
fn training_of(cell: &Cell) -> (String, String, String) {
    match (&cell.unit, &cell.result) {
        (Unit::Training { seed, .. }, CellResult::Training { steps, recipe, .. }) => {
            (seed.to_string(), steps.to_string(), recipe.clone())
        }
        _ => [NOTHING; 3].map(str::to_owned).into(),
    }
}
