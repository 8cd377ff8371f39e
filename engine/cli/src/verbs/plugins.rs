//! `pubs-engine plugins`: what is there, and whether it keeps the contract.

use clap::{Args, Subcommand};
use pubs_host::{Listed, Plugin};
use serde::Serialize;
use serde_json::Value;

use crate::options::PluginOptions;
use crate::{Ended, exit, show};

#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// List built-in plugins and those on the search path
    #[command(after_help = "Example: pubs-engine plugins list --plugin-dir build/")]
    List(ListArguments),
    /// Load a plugin and run the conformance kit
    #[command(
        after_help = "Example: pubs-engine plugins check build/libmy_model.so --object objects/mine.toml"
    )]
    Check(super::plugin_check::Arguments),
}

#[derive(Args)]
struct ListArguments {
    #[command(flatten)]
    plugins: PluginOptions,
    /// Show the JSON Schema of each plugin's parameters as well
    #[arg(long)]
    schema: bool,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    plugins: Vec<Entry>,
    refused: Vec<Refused>,
}

#[derive(Serialize)]
struct Entry {
    name: String,
    kind: String,
    version: String,
    origin: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    schema: Option<Value>,
}

#[derive(Serialize)]
struct Refused {
    place: String,
    reason: String,
}

pub fn run(arguments: &Arguments) -> Ended {
    match &arguments.verb {
        Verb::List(arguments) => list(arguments),
        Verb::Check(arguments) => super::plugin_check::run(arguments),
    }
}

fn list(arguments: &ListArguments) -> Ended {
    let registry = arguments.plugins.registry();
    let mut report = Report {
        plugins: Vec::new(),
        refused: Vec::new(),
    };
    for listed in registry.list() {
        match listed {
            Listed::Plugin(plugin) => report.plugins.push(entry(plugin, arguments.schema)),
            Listed::Refused { place, reason } => {
                report.refused.push(Refused {
                    place: place.clone(),
                    reason: reason.clone(),
                });
            }
            Listed::NotAPlugin(path) => {
                report.refused.push(Refused {
                    place: path.display().to_string(),
                    reason: "not a plugin".to_owned(),
                });
            }
        }
    }
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&text(&report))?;
    }
    Ok(exit::DONE)
}

fn entry(plugin: &Plugin, schema: bool) -> Entry {
    Entry {
        name: plugin.name().to_owned(),
        kind: plugin.kind().to_string(),
        version: plugin.version().to_owned(),
        origin: plugin.origin().to_string(),
        schema: schema.then(|| plugin.params_schema().clone()),
    }
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    for plugin in &report.plugins {
        text += &format!(
            "{:<16} {:<18} {:<8} {}\n",
            plugin.name, plugin.kind, plugin.version, plugin.origin
        );
        if let Some(schema) = &plugin.schema {
            text += &format!("{schema:#}\n");
        }
    }
    for refused in &report.refused {
        text += &format!("refused: {}: {}\n", refused.place, refused.reason);
    }
    text.trim_end().to_owned()
}
