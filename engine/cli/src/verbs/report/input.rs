//! What an input is, told by what is in it.

use std::path::Path;

use pubs_run::recording::{RunRecording, read_run};
use serde::Serialize;

use crate::failure::Failure;

/// What a page can be about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Run,
}

/// An input, read.
pub enum Input {
    Run(Box<RunRecording>),
}

impl Input {
    pub fn kind(&self) -> Kind {
        match self {
            Self::Run(_) => Kind::Run,
        }
    }
}

/// Whether the input comes from another program.
pub fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads an input.
///
/// # Errors
/// Where it is nothing that a page can be about, or damaged.
pub fn read(path: &Path) -> Result<Input, Failure> {
    let recording = read_run(path).map_err(|error| Failure::invalid(error.to_string()))?;
    Ok(Input::Run(Box::new(recording)))
}
