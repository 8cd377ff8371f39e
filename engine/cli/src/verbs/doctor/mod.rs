//! `pubs-engine doctor`: what stands in the way of a run, and what to do about it. Nothing moves.

mod machine;
mod robot;
mod room;

use std::path::PathBuf;

use clap::Args;
use pubs_plugin::{CheckState, DriverCheck};
use serde::Serialize;

use crate::driver::DriverOptions;
use crate::options::{LayerOptions, RuntimeOptions};
use crate::{Ended, exit, show};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine doctor
          pubs-engine doctor objects/door2.toml --driver melfa --set driver.params.host=192.168.0.20
Nothing moves. Exit code 0 where a run could begin, 1 where a check has failed.")]
pub struct Arguments {
    /// Object file whose driver is to be looked at as well
    #[arg(value_name = "OBJECT")]
    object: Option<PathBuf>,
    #[command(flatten)]
    layers: LayerOptions,
    #[command(flatten)]
    driver: DriverOptions,
    #[command(flatten)]
    runtime: RuntimeOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Everything that was looked at.
#[derive(Serialize)]
struct Diagnosis {
    ok: bool,
    checks: Vec<Check>,
}

/// A check and what it belongs to.
#[derive(Serialize)]
struct Check {
    of: &'static str,
    #[serde(flatten)]
    check: DriverCheck,
}

pub fn run(arguments: &Arguments) -> Ended {
    let registry = arguments.layers.plugins.registry();
    let mut checks: Vec<Check> = of("machine", machine::checks(&arguments.runtime)).collect();
    checks.extend(of("machine", room::checks(arguments.object.as_deref())));
    checks.extend(of("plugins", machine::plugins(&registry)));
    if let Some(object) = &arguments.object {
        let overrides = arguments.driver.overrides(&arguments.layers);
        let (of_object, of_driver) = robot::checks(object, &overrides, &registry);
        checks.extend(of("object", of_object));
        checks.extend(of("driver", of_driver));
    }
    let failed = |check: &Check| check.check.state == CheckState::Fault;
    let diagnosis = Diagnosis {
        ok: !checks.iter().any(failed),
        checks,
    };
    if arguments.json {
        show::print_json(&diagnosis)?;
    } else {
        show::print(&text(&diagnosis))?;
    }
    Ok(if diagnosis.ok {
        exit::DONE
    } else {
        exit::FAULT
    })
}

fn of(of: &'static str, checks: Vec<DriverCheck>) -> impl Iterator<Item = Check> {
    checks.into_iter().map(move |check| Check { of, check })
}

/// One line each, its cure below it.
fn text(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    let mut section = "";
    for Check { of, check } in &diagnosis.checks {
        if *of != section {
            text += &format!("{of}\n");
            section = of;
        }
        let state = match check.state {
            CheckState::Ok => "ok",
            CheckState::Warn => "warn",
            CheckState::Fault => "FAULT",
            CheckState::Skipped => "skipped",
        };
        text += &format!("  {state:<8} {:<16} {}\n", check.name, check.found);
        if !check.cure.is_empty() {
            text += &format!("{:27}do: {}\n", "", check.cure);
        }
    }
    let faults = count(diagnosis, CheckState::Fault);
    let warnings = count(diagnosis, CheckState::Warn);
    text += &format!("faults: {faults}, warnings: {warnings}");
    text
}

fn count(diagnosis: &Diagnosis, state: CheckState) -> usize {
    let states = diagnosis.checks.iter().map(|check| check.check.state);
    states.filter(|found| *found == state).count()
}

/// A check that was made.
fn check(name: &str, state: CheckState, found: String, cure: &str) -> DriverCheck {
    DriverCheck {
        name: name.to_owned(),
        state,
        found,
        cure: cure.to_owned(),
    }
}
