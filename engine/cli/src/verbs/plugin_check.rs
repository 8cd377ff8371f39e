//! `pubs-engine plugins check`: the conformance kit, run on one plugin.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use pubs_core::Task;
use pubs_core::object;
use pubs_core::task::compile;
use pubs_host::conformance::{self, ConformanceReport, Outcome};
use pubs_host::{Listed, Plugin, PluginKind, library};
use serde::Serialize;

use crate::failure::Failure;
use crate::options::LayerOptions;
use crate::{Ended, exit, show};

#[derive(Args)]
pub struct Arguments {
    /// Library file, or the name of a plugin that `plugins list` shows
    plugin: PathBuf,
    /// Try the plugin with the parameters of this object file [default: a door of the kit's own]
    #[arg(long, value_name = "FILE")]
    object: Option<PathBuf>,
    #[command(flatten)]
    layers: LayerOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report<'r> {
    ok: bool,
    name: &'r str,
    version: &'r str,
    checks: Vec<CheckReport<'r>>,
}

#[derive(Serialize)]
struct CheckReport<'r> {
    name: &'r str,
    outcome: &'static str,
    detail: &'r str,
}

pub fn run(arguments: &Arguments) -> Ended {
    let plugin = find(arguments)?;
    let task = match &arguments.object {
        None => None,
        Some(path) => {
            let loaded = object::load(path, &arguments.layers.overrides())?;
            let task = compile(&loaded.file).map_err(|error| Failure::fault(&error))?;
            of_the_plugin(&plugin, &task, path)?;
            Some(task)
        }
    };
    let model_setup = task.as_ref().map(|task| task.model_setup(0));
    let driver_setup = task.as_ref().and_then(|task| task.driver_setup(0));
    let report = conformance::check(&plugin, model_setup.as_ref(), driver_setup.as_ref());
    if arguments.json {
        show::print_json(&json(&report))?;
    } else {
        show::print(&text(&report))?;
    }
    Ok(if report.passed() {
        exit::DONE
    } else {
        exit::INCOMPATIBLE
    })
}

/// An object's parameters are those of the plugins that it names.
fn of_the_plugin(plugin: &Plugin, task: &Task, path: &Path) -> Result<(), Failure> {
    let (key, named) = match plugin.kind() {
        PluginKind::ObservationModel => ("observation.model", Some(&task.observation.model)),
        PluginKind::Driver => (
            "driver.plugin",
            task.driver.as_ref().map(|driver| &driver.plugin),
        ),
    };
    match named {
        Some(named) if named == plugin.name() => Ok(()),
        named => Err(Failure::invalid(format!(
            "{}: {key} is {}, not `{}`; give an object with this plugin, or leave out --object",
            path.display(),
            named.map_or("nothing".to_owned(), |named| format!("`{named}`")),
            plugin.name()
        ))),
    }
}

fn find(arguments: &Arguments) -> Result<Arc<Plugin>, Failure> {
    if arguments.plugin.exists() {
        return Ok(Arc::new(library::load(&arguments.plugin)?));
    }
    let registry = arguments.layers.plugins.registry();
    let named = registry.list().iter().find_map(|listed| match listed {
        Listed::Plugin(plugin) if arguments.plugin.as_os_str() == plugin.name() => {
            Some(Arc::clone(plugin))
        }
        _ => None,
    });
    named.ok_or_else(|| {
        let plugin = arguments.plugin.display();
        Failure::invalid(format!(
            "`{plugin}` is neither a file nor a plugin that `pubs-engine plugins list` shows"
        ))
    })
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "passed",
        Outcome::Failed => "failed",
        Outcome::Skipped => "skipped",
    }
}

fn json(report: &ConformanceReport) -> Report<'_> {
    let checks = report.checks.iter().map(|check| CheckReport {
        name: check.name,
        outcome: word(check.outcome),
        detail: &check.detail,
    });
    Report {
        ok: report.passed(),
        name: &report.name,
        version: &report.version,
        checks: checks.collect(),
    }
}

fn text(report: &ConformanceReport) -> String {
    let mut text = format!("{} {}\n", report.name, report.version);
    for check in &report.checks {
        text += &format!(
            "  {:<8} {:<28} {}\n",
            word(check.outcome),
            check.name,
            check.detail
        );
    }
    text + if report.passed() {
        "keeps the contract"
    } else {
        "breaks the contract"
    }
}
