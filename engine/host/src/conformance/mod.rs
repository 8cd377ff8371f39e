//! The kit behind `pubs-engine plugins check`: does a plugin keep the contract of `pubs_plugin.h`?
//!
//! A plugin that only this kit has seen may still be wrong about its object, but will not surprise
//! the engine. Without a setup of the caller's the kit takes [`setup::door`]; a plugin that needs
//! parameters is then told to be checked with an object file.

mod bad_input;
mod density;
mod driver;
mod model;
pub mod setup;

use std::sync::Arc;

use pubs_plugin::{DriverSetup, ModelSetup};

use crate::call::Failure;
use crate::plugin::Functions;
use crate::{DriverPlugin, HostError, ModelPlugin, Plugin};

/// How a check went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The contract is kept.
    Passed,
    /// It is broken.
    Failed,
    /// It could not be checked.
    Skipped,
}

/// One check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Check {
    /// What was checked.
    pub name: &'static str,
    /// How it went.
    pub outcome: Outcome,
    /// What was found.
    pub detail: String,
}

/// All checks of one plugin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConformanceReport {
    /// The plugin's name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// The checks in the order they were made.
    pub checks: Vec<Check>,
}

impl ConformanceReport {
    /// Whether no check failed.
    pub fn passed(&self) -> bool {
        self.checks
            .iter()
            .all(|check| check.outcome != Outcome::Failed)
    }

    /// Records a check; says whether it passed.
    fn record(&mut self, name: &'static str, result: Result<String, String>) -> bool {
        let passed = result.is_ok();
        let outcome = if passed {
            Outcome::Passed
        } else {
            Outcome::Failed
        };
        self.checks.push(Check {
            name,
            outcome,
            detail: result.unwrap_or_else(|detail| detail),
        });
        passed
    }

    fn skip(&mut self, name: &'static str, detail: String) {
        self.checks.push(Check {
            name,
            outcome: Outcome::Skipped,
            detail,
        });
    }

    /// Records what `create` or `open` gave; hands the instance on if there is one.
    fn made<T>(
        &mut self,
        name: &'static str,
        result: Result<T, HostError>,
        generic: bool,
    ) -> Option<T> {
        match result {
            Ok(instance) => {
                self.record(name, Ok("made an instance".to_owned()));
                Some(instance)
            }
            Err(error) if generic && asks_for_parameters(&error) => {
                self.skip(
                    name,
                    format!("needs parameters: pass --object FILE ({error})"),
                );
                None
            }
            Err(error) => {
                self.record(name, Err(error.to_string()));
                None
            }
        }
    }
}

/// An orderly refusal, as of a plugin that was given nothing of its own.
fn asks_for_parameters(error: &HostError) -> bool {
    matches!(
        error,
        HostError::Parameters { .. }
            | HostError::Call {
                failure: Failure::Error(_),
                ..
            }
    )
}

/// Checks a plugin with a setup of the caller's, or a general one. Moves nothing but virtual arms.
pub fn check(
    plugin: &Arc<Plugin>,
    model_setup: Option<&ModelSetup>,
    driver_setup: Option<&DriverSetup>,
) -> ConformanceReport {
    let (name, version) = (plugin.name().to_owned(), plugin.version().to_owned());
    let mut report = ConformanceReport {
        name,
        version,
        checks: Vec::new(),
    };
    // Loading has checked both already and refuses a plugin where they are wrong.
    report.record("table", Ok(format!("{}, tables complete", plugin.kind())));
    report.record(
        "schema",
        Ok(format!(
            "{} bytes, valid",
            plugin.params_schema().to_string().len()
        )),
    );
    match plugin.functions() {
        Functions::ObservationModel(table) => {
            let plugin = ModelPlugin {
                plugin: Arc::clone(plugin),
                table,
            };
            model::check(&mut report, &plugin, model_setup);
        }
        Functions::Driver(table) => {
            let plugin = DriverPlugin {
                plugin: Arc::clone(plugin),
                table,
            };
            driver::check(&mut report, &plugin, driver_setup);
        }
    }
    report
}
