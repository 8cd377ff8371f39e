//! `pubs-engine replay`: what today's filter and policy make of a recorded run.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use pubs_core::object::{self, Overrides};
use pubs_policy::{PolicyFile, Runtime};
use pubs_run::Actor;
use pubs_run::recording::{RunRecording, read_run};
use pubs_run::replay::{Difference, ReplayReport, Tolerances, replay};
use serde_json::Value;

use crate::failure::{Failure, chain};
use crate::object::{Ready, without_driver};
use crate::options::{PluginOptions, RuntimeOptions};
use crate::{Ended, exit, show};

#[derive(Args)]
#[command(
    after_help = "Example: pubs-engine replay recordings/door2-20261124T171750Z.mcap
Exits with 0 where all is the same, with 3 where something differs or the recording lacks data."
)]
pub struct Arguments {
    /// Recording of a run; object file and policies are in it
    #[arg(value_name = "RUN")]
    recording: PathBuf,
    /// Take states as the same within this (rad or m)
    #[arg(long, value_name = "STATE", default_value_t = 0.0, value_parser = tolerance)]
    tolerance_state: f64,
    /// Take forces as the same within this
    #[arg(long, value_name = "N", default_value_t = 0.0, value_parser = tolerance)]
    tolerance_force: f64,
    /// Take entropies (0 to 1) as the same within this
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = tolerance)]
    tolerance_entropy: f64,
    #[command(flatten)]
    plugins: PluginOptions,
    #[command(flatten)]
    runtime: RuntimeOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number
        .filter(|number| *number >= 0.0 && number.is_finite())
        .ok_or_else(|| "give a number from 0 on, such as 1e-6".to_owned())
}

pub fn run(arguments: &Arguments) -> Ended {
    let file = &arguments.recording;
    let recording = read_run(file).map_err(|error| Failure::invalid(error.to_string()))?;
    let runtime = arguments.runtime.runtime()?;
    let ready = object(arguments, &recording)?;
    let policies = policies(&recording, &ready, &runtime)?;
    tell_differences_of_setup(&recording, &ready, &runtime);
    let tolerances = Tolerances {
        state: arguments.tolerance_state,
        force_n: arguments.tolerance_force,
        entropy: arguments.tolerance_entropy,
    };
    let report = replay(
        &recording,
        &ready.task,
        Arc::clone(&ready.model),
        policies,
        &tolerances,
    )
    .map_err(|error| Failure::invalid(error.to_string()))?;
    for missing in &report.missing {
        show::say(&format!("warning: {}: {missing}", file.display()));
    }
    if report.recorded_on != report.replayed_on {
        show::note(&format!(
            "note: recorded on the vector unit {}, replayed on {}: last bits differ (--tolerance-state, --tolerance-force and --tolerance-entropy pass over small differences)",
            report.recorded_on, report.replayed_on
        ));
    }
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&summary(&recording, &report))?;
    }
    Ok(if report.same {
        exit::DONE
    } else {
        exit::MISSED
    })
}

/// The object as it was, without what is set over object files today.
fn object(arguments: &Arguments, recording: &RunRecording) -> Result<Ready, Failure> {
    let name = format!("{}: object.resolved.toml", arguments.recording.display());
    let text = recording.resolved_toml.clone();
    without_driver(
        object::load_text(&name, text, &Overrides::none())?,
        recording.run.belief_frequency,
        &arguments.plugins.registry(),
        recording.header.seed,
    )
}

fn policies(
    recording: &RunRecording,
    ready: &Ready,
    runtime: &Runtime,
) -> Result<Vec<Actor>, Failure> {
    let notes = recording.run.policies.iter();
    notes
        .zip(&recording.policies)
        .map(|(note, bytes)| {
            let name = PathBuf::from(&note.name);
            let file = match &note.foreign_inputs {
                None => PolicyFile::from_memory(&name, bytes.clone()),
                Some(inputs) => PolicyFile::foreign_from_memory(
                    &name,
                    bytes.clone(),
                    inputs,
                    ready.task.actions.len(),
                ),
            };
            let file = file.map_err(|error| Failure::incompatible(chain(&error)))?;
            Actor::open(&file, runtime, ready.model.as_ref())
                .map_err(|error| Failure::incompatible(error.to_string()))
        })
        .collect()
}

/// What may explain a difference.
fn tell_differences_of_setup(recording: &RunRecording, ready: &Ready, runtime: &Runtime) {
    let pairs = [
        (
            "engine",
            &recording.header.engine,
            env!("CARGO_PKG_VERSION").to_owned(),
        ),
        (
            "observation model",
            &recording.run.model,
            ready.model_plugin.clone(),
        ),
        ("runtime", &recording.run.runtime, runtime.to_string()),
    ];
    for (what, then, now) in pairs {
        if *then != now {
            show::note(&format!("note: {what}: recorded with {then}, now {now}"));
        }
    }
}

fn summary(recording: &RunRecording, report: &ReplayReport) -> String {
    let clock = if recording.run.lockstep {
        "in lockstep"
    } else {
        "in real time"
    };
    let mut text = format!(
        "{}: {:.1} s {clock}, seed {}, recorded by engine {}\n",
        recording.header.object, report.time_s, recording.header.seed, recording.header.engine
    );
    let counts = [
        ("observations", report.observations),
        ("beliefs", report.beliefs),
        ("actions", report.actions),
    ];
    for (name, count) in counts {
        text += &format!(
            "{name:<12} {} compared, {} differ\n",
            count.compared, count.differ
        );
    }
    for difference in &report.differences {
        text += &place(difference);
    }
    text += match (&report.first, report.missing.is_empty()) {
        (None, true) => "the same throughout",
        (None, false) => "the same as far as the recording goes",
        (Some(_), _) => "not the same",
    };
    text
}

fn place(difference: &Difference) -> String {
    let shown = |value: &Value| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    format!(
        "first differs at {:.3} s on {} (number {}): {} was {}, is {}\n",
        difference.time_s,
        difference.topic,
        difference.step,
        difference.field,
        shown(&difference.recorded),
        shown(&difference.replayed),
    )
}
