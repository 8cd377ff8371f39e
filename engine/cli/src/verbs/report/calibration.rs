//! The page of a calibration.

use std::path::{Path, PathBuf};

use pubs_calibrate::object_text::{StateUnit, segments_of};
use pubs_calibrate::report::{CalibrationInput, CalibrationPageError, page as page_of};
use pubs_core::object::{self, LoadedObject, Overrides};
use pubs_run::recording::{self, Recording};

use super::{Arguments, Page};
use crate::failure::Failure;
use crate::object::without_model_of;
use crate::verbs::calibrate;

/// The page of an object file, with the recordings it was calibrated with.
///
/// # Errors
/// Where file or recordings cannot be used.
pub fn of_object(arguments: &Arguments, loaded: LoadedObject) -> Result<Page, Failure> {
    let path = &arguments.input;
    let name = loaded.file.name.clone();
    let recordings = calibrate::recordings::read(&calibrate::record::found(path, &name))?;
    page(arguments, path.display().to_string(), loaded, &recordings)
}

/// The page of a recording, with the object file that it belongs to.
///
/// # Errors
/// Where they cannot be used, or do not belong together.
pub fn of_recording(arguments: &Arguments, recording: Recording) -> Result<Page, Failure> {
    let file = &arguments.input;
    let name = recording.header.object.clone();
    let (source, loaded) = match object_file(arguments, &name) {
        Some(path) => {
            let loaded = object::load(&path, &overrides())?;
            (path.display().to_string(), loaded)
        }
        None => embedded(file)?,
    };
    let found = &loaded.file.name;
    if *found != name {
        return Err(Failure::invalid(format!(
            "{} is of the object `{name}`, {source} describes `{found}`: name the right file with --object",
            file.display()
        )));
    }
    let recordings = [(file.display().to_string(), recording)];
    page(arguments, source, loaded, &recordings)
}

/// The one that the user names, or else where it usually lies.
fn object_file(arguments: &Arguments, name: &str) -> Option<PathBuf> {
    if let Some(object) = &arguments.object {
        return Some(object.clone());
    }
    let folder = arguments
        .input
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let beside = folder.unwrap_or(Path::new(".")).join("../objects");
    let folders = [beside, PathBuf::from("objects")];
    let files = folders.map(|folder| folder.join(format!("{name}.toml")));
    files.into_iter().find(|file| file.exists())
}

/// The object file that the recording carries: as it was before this calibration.
fn embedded(file: &Path) -> Result<(String, LoadedObject), Failure> {
    let text = recording::object_toml(file).map_err(|error| Failure::invalid(error.to_string()))?;
    let text = text.ok_or_else(|| {
        Failure::invalid(format!(
            "{} carries no object file: name one with --object",
            file.display()
        ))
    })?;
    let source = format!("{}: object.toml, as it was before", file.display());
    let loaded = object::load_text(&source, text, &overrides())?;
    Ok((source, loaded))
}

fn overrides() -> Overrides {
    Overrides::from_process(std::iter::empty())
}

fn page(
    arguments: &Arguments,
    source: String,
    loaded: LoadedObject,
    recordings: &[(String, Recording)],
) -> Result<Page, Failure> {
    let registry = arguments.plugins.registry();
    let (loaded, task) = without_model_of(loaded, &registry)?;
    let segments = segments_of(&task.observation.table, StateUnit::of(&task.joint))
        .map_err(|error| Failure::invalid(error.to_string()))?;
    if segments.is_empty() && recordings.is_empty() {
        return Err(Failure::invalid(format!(
            "{source} has no calibration segments and no recording of a calibration to report on; `pubs-engine calibrate` makes both"
        )));
    }
    let input = CalibrationInput {
        source: &source,
        object_toml: loaded.text(),
        task: &task,
        segments: &segments,
        recordings,
    };
    let blocks = page_of(&input).map_err(|error| match &error {
        CalibrationPageError::Calibration(_) => Failure::invalid(error.to_string()),
        CalibrationPageError::Plot(_) | CalibrationPageError::Draw(_) => Failure::fault(&error),
    })?;
    let lost = recordings
        .iter()
        .filter_map(|(_, recording)| recording.loss.clone());
    Ok(Page {
        blocks,
        missing: lost.collect(),
    })
}
