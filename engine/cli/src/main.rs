//! `pubs-engine`: moves doors and drawers to a chosen joint state by touch alone.
//!
//! One file per verb in `verbs`; what they share is [`object`] (an object file made ready),
//! [`policies`] (finding or training one), [`pomdp_file`] (a POMDP from its file), [`show`] (what goes to stdout and stderr) and
//! [`failure`] (how a verb ends that cannot go on). Exit codes are in [`exit`].

mod built_in;
mod driver;
mod exit;
mod failure;
mod grid;
mod interrupt;
mod live;
mod object;
mod options;
mod policies;
mod pomdp_file;
mod recorded;
mod show;
mod training;
mod verbs;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::failure::Failure;
use crate::show::Talk;

/// Moves doors and drawers to a chosen joint state by touch alone.
#[derive(Parser)]
#[command(name = "pubs-engine", version, propagate_version = true, max_term_width = 100, after_help = exit::TABLE)]
struct Program {
    #[command(subcommand)]
    verb: Verb,
    /// Say nothing but faults, warnings and results
    #[arg(long, short, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Say what is read from where as well
    #[arg(long, short, global = true)]
    verbose: bool,
}

#[derive(Subcommand)]
enum Verb {
    /// Move an object to one or more goals
    Run(verbs::run::Arguments),
    /// Feed a recorded run through today's filter and policy and say where they first differ
    Replay(verbs::replay::Arguments),
    /// Check object files and report every fault at its line
    Check(verbs::check::Arguments),
    /// Write a new object file, commented, from flags or a few questions
    New(verbs::new::Arguments),
    /// Print the engine's default settings, commented
    Config(verbs::config::Arguments),
    /// Record demonstrations and fit an object's observation model, or check that it still holds
    Calibrate(verbs::calibrate::Arguments),
    /// Draw an object's observation model and the readings behind it
    Plot(verbs::plot::Arguments),
    /// Fit tables of measured doors and judge how honestly they locate a pull
    Survey(verbs::survey::Arguments),
    /// Train a policy for an object
    Train(verbs::train::Arguments),
    /// Judge a policy by many simulated trials
    Evaluate(verbs::evaluate::Arguments),
    /// Make one page of a run, a training, an evaluation or a calibration
    Report(verbs::report::Arguments),
    /// Run the paper's evaluation and report it beside the paper's numbers
    Reproduce(verbs::reproduce::Arguments),
    /// Solve a discrete POMDP
    Solve(verbs::solve::Arguments),
    /// List plugins, or check one
    Plugins(verbs::plugins::Arguments),
    /// Say what stands in the way of a run, and what to do about it
    Doctor(verbs::doctor::Arguments),
    /// Print completions for a shell
    Completions(verbs::completions::Arguments),
    /// Print the manual page, or write one for every verb
    Man(verbs::man::Arguments),
}

fn main() -> ExitCode {
    let program = Program::parse();
    show::choose(match (program.quiet, program.verbose) {
        (true, _) => Talk::Quiet,
        (_, true) => Talk::Verbose,
        _ => Talk::Usual,
    });
    let result = match program.verb {
        Verb::Run(arguments) => verbs::run::run(&arguments),
        Verb::Replay(arguments) => verbs::replay::run(&arguments),
        Verb::Check(arguments) => verbs::check::run(&arguments),
        Verb::New(arguments) => verbs::new::run(&arguments),
        Verb::Config(arguments) => verbs::config::run(&arguments),
        Verb::Calibrate(arguments) => verbs::calibrate::run(&arguments),
        Verb::Plot(arguments) => verbs::plot::run(&arguments),
        Verb::Survey(arguments) => verbs::survey::run(&arguments),
        Verb::Train(arguments) => verbs::train::run(&arguments),
        Verb::Evaluate(arguments) => verbs::evaluate::run(&arguments),
        Verb::Report(arguments) => verbs::report::run(&arguments),
        Verb::Reproduce(arguments) => verbs::reproduce::run(&arguments),
        Verb::Solve(arguments) => verbs::solve::run(&arguments),
        Verb::Plugins(arguments) => verbs::plugins::run(&arguments),
        Verb::Doctor(arguments) => verbs::doctor::run(&arguments),
        Verb::Completions(arguments) => verbs::completions::run(&arguments),
        Verb::Man(arguments) => verbs::man::run(&arguments),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(failure) => ExitCode::from(failure.report()),
    }
}

/// What a verb gives back: its exit code, or why it could not go on.
type Ended = Result<u8, Failure>;

#[cfg(test)]
mod examples;
