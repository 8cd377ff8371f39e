//! The page of a run.

use pubs_core::object::{self, Overrides};
use pubs_core::task::compile;
use pubs_evaluate::report::run::{RunInput, missing, page as page_of};
use pubs_run::recording::RunRecording;

use super::{Arguments, Page};
use crate::failure::Failure;
use crate::object::without_driver;

/// # Errors
/// Where the object file in the recording cannot be used.
pub fn page(arguments: &Arguments, recording: &RunRecording) -> Result<Page, Failure> {
    let name = format!("{}: object.resolved.toml", arguments.input.display());
    // The object as it was, without what is set over object files today.
    let loaded = object::load_text(&name, recording.resolved_toml.clone(), &Overrides::none())?;
    let task = compile(&loaded.file).map_err(|error| Failure::fault(&error))?;
    let ready = without_driver(
        loaded,
        recording.run.belief_frequency,
        &arguments.plugins.registry(),
        recording.header.seed,
    )
    .map_err(|failure| failure.in_a_line());
    let input = RunInput {
        file: &arguments.input,
        recording,
        task: &task,
        model: match &ready {
            Ok(ready) => Ok(ready.model.as_ref()),
            Err(why) => Err(why),
        },
    };
    Ok(Page {
        blocks: page_of(&input).map_err(|error| Failure::fault(&error))?,
        missing: missing(recording),
    })
}
