//! `pubs-engine reproduce`: the paper's evaluation on our own objects.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use clap::Args;
use indicatif::ProgressBar;
use pubs_core::vector::VectorUnit;
use pubs_evaluate::reproduce::plan::{Part, PlanOptions, plan};
use pubs_evaluate::reproduce::report::{ReportContext, write};
use pubs_evaluate::reproduce::runner::{self, Event};
use pubs_evaluate::reproduce::workshop::Workshop;
use pubs_evaluate::reproduce::{
    Results,
    cell::Unit,
    kept::{self, KeptError},
};
use pubs_run::utc;
use serde::Serialize;

use crate::failure::Failure;
use crate::options::{PluginOptions, RuntimeOptions, parse_timeout, whole};
use crate::policies::{MAX_STEPS, TRIALS};
use crate::{Ended, exit, interrupt, show};

#[derive(Args)]
#[command(after_help = "Examples: pubs-engine reproduce
          pubs-engine reproduce --only table2,fig4 --seeds 5 --threads 2
          pubs-engine reproduce --report-only
          pubs-engine reproduce --from policies/paper/cells.jsonl --report-only
What is stored is not run again: break off with Ctrl-C and go on later with the same command.")]
pub struct Arguments {
    /// Folder of cells, policies, figures and the report
    #[arg(long, short, value_name = "DIR", default_value = "reproduction")]
    output: PathBuf,
    /// Folder of the object files
    #[arg(long, value_name = "DIR", default_value = "objects")]
    objects: PathBuf,
    /// Only these parts: table1 (with fig. 4 top), table2, table3, table4, fig4 (bottom), fig5
    #[arg(long, value_delimiter = ',', value_name = "PARTS")]
    only: Vec<Part>,
    /// Only cells whose names hold one of these, such as lstm1 or door2-middle
    #[arg(long, value_delimiter = ',', value_name = "WORDS")]
    cells: Vec<String>,
    /// Trainings of each kind, of which the best is shown
    #[arg(long, default_value_t = 5, value_parser = whole::<u64>(1, 1000))]
    seeds: u64,
    /// Trainings of each kind with an LSTM, which take minutes each
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>(0, 1000))]
    recurrent_seeds: u64,
    /// Trials on the virtual arm for each object of Table IV
    #[arg(long, default_value_t = 20, value_parser = whole::<u64>(1, u64::MAX))]
    trials: u64,
    /// Simulated trials of each policy
    #[arg(long, default_value_t = TRIALS, value_parser = whole::<u64>(1, u64::MAX))]
    evaluation_trials: u64,
    /// Steps of each training [default: the recipe's]
    #[arg(long, value_parser = whole::<u64>(1, u64::MAX))]
    steps: Option<u64>,
    /// Time limit of each solver, s
    #[arg(long, default_value = "120", value_name = "SECONDS", value_parser = parse_timeout)]
    timeout: Duration,
    /// Cells at once [default: one per core]
    #[arg(long, value_parser = whole::<u16>(1, u16::MAX.into()))]
    threads: Option<u16>,
    /// Run cells again that are stored already
    #[arg(long)]
    again: bool,
    /// Run nothing; write the report on what is stored
    #[arg(long, conflicts_with = "again")]
    report_only: bool,
    /// Keep the report here as well, with its cells and the best policies of the four objects and
    /// three goals
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Take these cells of a kept report as done, such as policies/paper/cells.jsonl
    #[arg(long, value_name = "FILE", conflicts_with = "again")]
    from: Option<PathBuf>,
    #[command(flatten)]
    plugins: PluginOptions,
    #[command(flatten)]
    runtime: RuntimeOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// What a reproduction comes to.
#[derive(Serialize)]
struct Summary {
    cells: usize,
    kept: usize,
    made: usize,
    failed: Vec<Failed>,
    not_run: usize,
    report: Vec<PathBuf>,
}

#[derive(Serialize)]
struct Failed {
    cell: String,
    reason: String,
}

pub fn run(arguments: &Arguments) -> Ended {
    if !arguments.objects.is_dir() {
        return Err(Failure::invalid(format!(
            "there is no folder {}: name that of the object files with --objects",
            arguments.objects.display()
        )));
    }
    let registry = arguments.plugins.registry();
    let runtime = arguments.runtime.runtime()?;
    let workshop = Workshop {
        objects: arguments.objects.clone(),
        results: arguments.output.clone(),
        registry: &registry,
        runtime: &runtime,
        trials: arguments.evaluation_trials,
        max_steps: MAX_STEPS,
        steps: arguments.steps.map(|steps| steps as usize),
    };
    let mut units = plan(&options(
        arguments,
        arguments.only.iter().copied().collect(),
    ));
    let names = units
        .iter()
        .step_by(units.len().div_ceil(4).max(1))
        .map(Unit::id);
    let names = names.collect::<Vec<_>>().join(", ");
    let named = |id: &str| {
        arguments
            .cells
            .iter()
            .any(|word| id.contains(word.as_str()))
    };
    units.retain(|unit| arguments.cells.is_empty() || named(&unit.id()));
    if units.is_empty() {
        return Err(Failure::invalid(format!(
            "no cell's name holds {}; names are such as {}",
            arguments.cells.join(" or "),
            names
        )));
    }
    if let Some(file) = &arguments.from {
        let laid = kept::unpack(file, &arguments.output).map_err(|error| match error {
            KeptError::Write { .. } => Failure::fault(&error),
            KeptError::Read { .. } | KeptError::Line { .. } => Failure::invalid(error.to_string()),
        })?;
        show::detail(|| format!("{laid} cells and heatmaps taken from {}", file.display()));
    }
    let mut summary = if arguments.report_only {
        stored(&arguments.output, &units)?
    } else {
        make(arguments, &workshop, &units)?
    };
    let trained = read(&arguments.output)?;
    runner::heatmaps(&workshop, &trained).map_err(|error| Failure::fault(&error))?;
    let results = read(&arguments.output)?;
    for notice in results.notices() {
        show::say(&format!(
            "warning: passed over {}: {}",
            notice.file.display(),
            notice.reason
        ));
    }
    summary.report = report(arguments, &results, &arguments.output)?;
    if let Some(folder) = &arguments.keep {
        runner::keep(&workshop, &results, folder).map_err(|error| Failure::fault(&error))?;
        kept::write(&results, folder).map_err(|error| Failure::fault(&error))?;
        report(arguments, &results, folder)?;
    }
    tell(arguments, &summary)?;
    Ok(match (summary.failed.is_empty(), summary.not_run) {
        (false, _) => exit::FAULT,
        (true, 0) => exit::DONE,
        (true, _) if arguments.report_only => exit::DONE,
        (true, _) => exit::MISSED,
    })
}

/// How much to run of which parts; of all where there are none.
fn options(arguments: &Arguments, parts: BTreeSet<Part>) -> PlanOptions {
    PlanOptions {
        parts,
        seeds: arguments.seeds,
        recurrent_seeds: arguments.recurrent_seeds,
        timeout_s: arguments.timeout.as_secs_f64(),
        arm_trials: arguments.trials,
    }
}

/// Runs the cells with a bar over all of them.
fn make(
    arguments: &Arguments,
    workshop: &Workshop<'_>,
    units: &[Unit],
) -> Result<Summary, Failure> {
    let interrupt = interrupt::flag()?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = arguments.threads.map_or(cores, usize::from);
    let progress = Overall::new(units);
    let ends = Mutex::new(vec![None; units.len()]);
    let watch = |index: usize, event: &Event| {
        progress.show(units, index, event);
        if !matches!(event, Event::Running(_)) {
            let mut ends = ends.lock().unwrap_or_else(PoisonError::into_inner);
            ends[index] = Some(event.clone());
        }
    };
    runner::run(
        workshop,
        units,
        threads,
        arguments.again,
        &interrupt,
        &watch,
    )
    .map_err(|error| Failure::fault(&error))?;
    progress.bar.finish_and_clear();
    let ends = ends.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(Summary::of(&ends, units))
}

/// What an earlier run has stored of these units.
fn stored(results: &Path, units: &[Unit]) -> Result<Summary, Failure> {
    let results = read(results)?;
    let kept = |unit| results.cell(unit).map(|_| Event::Kept);
    let ends: Vec<Option<Event>> = units.iter().map(kept).collect();
    Ok(Summary::of(&ends, units))
}

/// One bar over all cells, in estimated seconds of work.
struct Overall {
    bar: ProgressBar,
    done_ms: Vec<AtomicU64>,
}

impl Overall {
    fn new(units: &[Unit]) -> Self {
        let total_ms: f64 = units.iter().map(|unit| 1e3 * estimate_s(unit)).sum();
        let template = "cells {bar:30} {percent:>3} %  {msg}  ({eta} left)";
        Self {
            bar: show::bar(total_ms as u64, template),
            done_ms: units.iter().map(|_| AtomicU64::new(0)).collect(),
        }
    }

    fn show(&self, units: &[Unit], index: usize, event: &Event) {
        let unit = &units[index];
        let share = match event {
            Event::Running(share) => *share,
            _ => 1.0,
        };
        let done_ms = (1e3 * estimate_s(unit) * f64::from(share.min(1.0))) as u64;
        self.done_ms[index].store(done_ms, Ordering::Relaxed);
        let sum = self.done_ms.iter().map(|ms| ms.load(Ordering::Relaxed));
        self.bar.set_position(sum.sum());
        self.bar.set_message(unit.id());
        let line = match event {
            Event::Running(_) | Event::Kept | Event::Interrupted => return,
            Event::Made { time_s } => format!("{} in {time_s:.1} s", unit.id()),
            Event::Failed(reason) => {
                let line = format!("{} failed: {reason}", unit.id());
                return self.bar.suspend(|| show::say(&line));
            }
        };
        self.bar.suspend(|| show::note(&line));
    }
}

/// Roughly how long a unit takes on one core, for the bar alone.
fn estimate_s(unit: &Unit) -> f64 {
    match unit {
        Unit::Training { task, method, .. } => {
            let benchmark = if matches!(task.as_str(), "light_dark" | "sim_object") {
                2.0
            } else {
                1.0
            };
            benchmark
                * match method.lstm_layers() {
                    0 => 10.0,
                    1 => 200.0,
                    _ => 500.0,
                }
        }
        Unit::Solver { timeout_s, .. } => *timeout_s,
        Unit::Arm { trials, .. } => 0.1 * *trials as f64,
    }
}

impl Summary {
    fn of(ends: &[Option<Event>], units: &[Unit]) -> Self {
        let count = |is: fn(&Option<Event>) -> bool| ends.iter().filter(|end| is(end)).count();
        let failed = ends.iter().zip(units).filter_map(|(end, unit)| match end {
            Some(Event::Failed(reason)) => Some(Failed {
                cell: unit.id(),
                reason: reason.clone(),
            }),
            _ => None,
        });
        Self {
            cells: units.len(),
            kept: count(|end| matches!(end, Some(Event::Kept))),
            made: count(|end| matches!(end, Some(Event::Made { .. }))),
            failed: failed.collect(),
            not_run: count(|end| matches!(end, None | Some(Event::Interrupted))),
            report: Vec::new(),
        }
    }
}

fn read(folder: &Path) -> Result<Results, Failure> {
    Results::read(folder).map_err(|error| Failure::fault(&error))
}

/// Writes the report on what is stored to a folder.
fn report(
    arguments: &Arguments,
    results: &Results,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let command: Vec<String> = std::env::args().skip(1).collect();
    let context = ReportContext {
        command: format!("pubs-engine {}", command.join(" ")),
        engine_version: env!("CARGO_PKG_VERSION").to_owned(),
        vector_unit: VectorUnit::best().to_string(),
        made_at: utc::now(),
        planned: plan(&options(arguments, BTreeSet::new())),
    };
    write(results, folder, &context).map_err(|error| Failure::fault(&error))
}

fn tell(arguments: &Arguments, summary: &Summary) -> Result<(), Failure> {
    if arguments.json {
        return show::print_json(summary);
    }
    let mut text = format!(
        "{} cells: {} made, {} kept, {} failed, {} not run\n",
        summary.cells,
        summary.made,
        summary.kept,
        summary.failed.len(),
        summary.not_run
    );
    for failed in &summary.failed {
        text += &format!("  {}: {}\n", failed.cell, failed.reason);
    }
    for file in &summary.report {
        if file.extension().is_some_and(|end| end != "svg") {
            text += &format!("report: {}\n", file.display());
        }
    }
    show::print(text.trim_end())
}
