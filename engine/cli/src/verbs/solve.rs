//! `pubs-engine solve`: bounds and a policy for a discrete POMDP, or for an object on a grid.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::Args;
use pubs_evaluate::grid::GridOrigin;
use pubs_solve::{Method, Pomdp, Progress, Solution, SolveOptions, Stopped, solve};
use serde::Serialize;

use crate::failure::{self, Failure};
use crate::grid::GridArguments;
use crate::options::{check_folder, parse_timeout};
use crate::{Ended, exit, interrupt, pomdp_file, show};

#[derive(Args)]
#[command(
    after_help = "Examples: pubs-engine solve tiger.pomdp --method sarsop --timeout 10
          pubs-engine solve objects/sim_object.toml --timeout 10
          pubs-engine solve objects/door2.toml --goal 0.5 --bins 64

Ctrl-C ends the search and keeps the best policy so far."
)]
pub struct Arguments {
    /// A POMDP in Cassandra's format (.pomdp), or an object file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    object: GridArguments,
    /// `qmdp` or `sarsop`
    #[arg(long, default_value = "sarsop", value_name = "NAME")]
    method: Method,
    /// Stop after this long, with the best policy so far
    #[arg(long, default_value = "60", value_name = "SECONDS", value_parser = parse_timeout)]
    timeout: Duration,
    /// Stop where the bounds at the initial belief are this close
    #[arg(long, default_value = "0.001", value_name = "REWARD", value_parser = parse_precision)]
    precision: f64,
    /// Write the policy here [default: FILE.policy.json]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
    /// No lines of progress
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Serialize)]
struct Report {
    problem: String,
    method: Method,
    states: usize,
    actions: usize,
    observations: usize,
    lower: f64,
    upper: f64,
    gap: f64,
    alpha_vectors: usize,
    beliefs: usize,
    trials: usize,
    time_s: f64,
    stopped: Stopped,
    policy: PathBuf,
}

pub fn run(arguments: &Arguments) -> Ended {
    let (pomdp, origin) = problem(arguments)?;
    let output = arguments
        .output
        .clone()
        .unwrap_or_else(|| arguments.file.with_extension("policy.json"));
    check_folder(&output, "--output")?;
    let options = SolveOptions {
        method: arguments.method,
        precision: arguments.precision,
        timeout: Some(arguments.timeout),
        ..SolveOptions::default()
    };
    let interrupt = interrupt::flag()?;
    let mut speaker = Speaker::new(arguments.quiet);
    let solution = solve(&pomdp, &options, |progress| {
        speaker.say(progress);
        if interrupt.load(Ordering::Acquire) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    let policy = match &origin {
        None => solution.policy.clone(),
        Some(origin) => solution.policy.clone().with_origin(origin.to_value()),
    };
    policy.write(&output).map_err(|error| Failure::Other {
        code: exit::FAULT,
        message: format!(
            "{}\n  name another place with --output",
            failure::chain(&error)
        ),
    })?;
    let report = Report {
        problem: pomdp.name().to_owned(),
        method: arguments.method,
        states: pomdp.states().len(),
        actions: pomdp.actions().len(),
        observations: pomdp.observations().len(),
        lower: solution.lower,
        upper: solution.upper,
        gap: solution.gap(),
        alpha_vectors: solution.alpha_vectors,
        beliefs: solution.beliefs,
        trials: solution.trials,
        time_s: solution.time_s,
        stopped: solution.stopped,
        policy: output,
    };
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&text(&report, &solution))?;
        if origin.is_some() {
            show::note(
                "note: the bounds hold for the object on this grid; `pubs-engine evaluate` says what the \
                 policy earns on the object itself",
            );
        }
    }
    Ok(exit::DONE)
}

/// What is to be solved, and where an object is, what was made of it.
fn problem(arguments: &Arguments) -> Result<(Pomdp, Option<GridOrigin>), Failure> {
    if arguments.file.extension().is_some_and(|end| end == "toml") {
        let (grid, origin) = arguments.object.grid(&arguments.file)?;
        return Ok((grid.pomdp, Some(origin)));
    }
    if let Some(option) = arguments.object.named() {
        return Err(Failure::invalid(format!(
            "{option} is for object files (.toml); {} is a problem of its own",
            arguments.file.display()
        )));
    }
    Ok((pomdp_file::load(&arguments.file)?, None))
}

/// Lines of progress, their heading first.
struct Speaker {
    quiet: bool,
    last: Option<Progress>,
}

impl Speaker {
    fn new(quiet: bool) -> Self {
        Self { quiet, last: None }
    }

    fn say(&mut self, progress: &Progress) {
        if self.quiet || self.last.as_ref() == Some(progress) {
            return;
        }
        if self.last.is_none() {
            show::note(" time_s       lower       upper         gap  alpha vectors   beliefs");
        }
        show::note(&format!(
            "{:7.2} {:11.4} {:11.4} {:11.4} {:14} {:9}",
            progress.time_s,
            progress.lower,
            progress.upper,
            progress.gap,
            progress.alpha_vectors,
            progress.beliefs,
        ));
        self.last = Some(*progress);
    }
}

fn text(report: &Report, solution: &Solution) -> String {
    let reason = match solution.stopped {
        Stopped::Precision => "the precision was reached",
        Stopped::Timeout => "the time was up",
        Stopped::Asked => "interrupted",
    };
    format!(
        "{}: value from {:.4} to {:.4} (gap {:.4}) after {:.2} s, {reason}\n\
         policy: {} ({} alpha vectors by {}, {})",
        report.problem,
        report.lower,
        report.upper,
        report.gap,
        report.time_s,
        report.policy.display(),
        report.alpha_vectors,
        report.method,
        match report.method {
            Method::Sarsop => "its whole plan, pruned ones too",
            Method::Qmdp => "no bound on what they earn",
        },
    )
}

fn parse_precision(text: &str) -> Result<f64, String> {
    let value = text.parse().ok();
    value
        .filter(|value: &f64| value.is_finite() && *value > 0.0)
        .ok_or_else(|| "give a number above 0, such as 0.001".to_owned())
}
