//! What an input is, told by what is in it.

use std::io::Read;
use std::path::Path;

use pubs_core::object::{self, LoadedObject, Overrides};
use pubs_evaluate::report::evaluation::{self, Judged};
use pubs_policy::PolicyFile;
use pubs_run::recording::{
    self, FORMAT_VERSION, Recording, RecordingError, RunRecording, read_run,
};
use serde::Serialize;

use crate::failure::{Failure, chain};

/// What MCAP files begin with.
const MCAP: &[u8] = b"\x89MCAP";

/// What is understood, for whoever gives something else.
const UNDERSTOOD: &str = "a report needs a recording of `run` or `calibrate` (.mcap), a policy of `train` (.onnx), \
     what `evaluate --json` prints, or a calibrated object file (.toml)";

/// What a page is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Run,
    Training,
    Evaluation,
    Calibration,
}

/// An input, read.
pub enum Input {
    Run(Box<RunRecording>),
    Policy(Box<PolicyFile>),
    Evaluation { text: String, judged: Vec<Judged> },
    CalibrationRecording(Box<Recording>),
    Object(Box<LoadedObject>),
}

impl Input {
    pub fn kind(&self) -> Kind {
        match self {
            Self::Run(_) => Kind::Run,
            Self::Policy(_) => Kind::Training,
            Self::Evaluation { .. } => Kind::Evaluation,
            Self::CalibrationRecording(_) | Self::Object(_) => Kind::Calibration,
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
    let bytes = bytes(path)?;
    if bytes.starts_with(MCAP) {
        return if is_stdin(path) {
            Err(Failure::invalid(
                "a recording is read from its file, not from stdin",
            ))
        } else {
            recording(path)
        };
    }
    match String::from_utf8(bytes) {
        Ok(text) if text.trim_start().starts_with(['{', '[']) && !is_table(&text) => {
            judged(path, text)
        }
        Ok(text) if is_table(&text) || has_end(path, "toml") => {
            let name = path.display().to_string();
            let overrides = Overrides::from_process(std::iter::empty());
            Ok(Input::Object(Box::new(object::load_text(
                &name, text, &overrides,
            )?)))
        }
        Ok(_) if !has_end(path, "onnx") => Err(other(path)),
        Ok(text) => policy(path, text.into_bytes()),
        Err(error) => policy(path, error.into_bytes()),
    }
}

fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let bytes = if is_stdin(path) {
        let mut bytes = Vec::new();
        std::io::stdin()
            .lock()
            .read_to_end(&mut bytes)
            .map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    let bytes = bytes
        .map_err(|error| Failure::invalid(format!("cannot read {}: {error}", path.display())))?;
    if bytes.is_empty() {
        return Err(Failure::invalid(format!(
            "{} is empty; {UNDERSTOOD}",
            path.display()
        )));
    }
    Ok(bytes)
}

fn has_end(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|found| found == end)
}

fn other(path: &Path) -> Failure {
    Failure::invalid(format!("{} is none of these: {UNDERSTOOD}", path.display()))
}

/// A run's where its format says so, else a calibration's.
fn recording(path: &Path) -> Result<Input, Failure> {
    let invalid = |error: RecordingError| Failure::invalid(error.to_string());
    match read_run(path) {
        Ok(recording) => Ok(Input::Run(Box::new(recording))),
        Err(RecordingError::NoRun {
            format: FORMAT_VERSION,
            ..
        }) => {
            let recording = recording::read(path).map_err(invalid)?;
            Ok(Input::CalibrationRecording(Box::new(recording)))
        }
        Err(error) => Err(invalid(error)),
    }
}

/// Whether it is TOML that could describe an object; one with faults is then shown with them.
fn is_table(text: &str) -> bool {
    let heads = |line: &str| {
        let line = line.trim();
        line == "[joint]"
            || line
                .split('=')
                .next()
                .is_some_and(|key| key.trim() == "schema")
    };
    text.lines().any(heads)
}

fn judged(path: &Path, text: String) -> Result<Input, Failure> {
    let judged = evaluation::read(&text)
        .map_err(|error| Failure::invalid(format!("{}: {error}; {UNDERSTOOD}", path.display())))?;
    Ok(Input::Evaluation { text, judged })
}

/// A policy, by its name or since nothing else is left.
fn policy(path: &Path, bytes: Vec<u8>) -> Result<Input, Failure> {
    match PolicyFile::from_memory(path, bytes) {
        Ok(file) => Ok(Input::Policy(Box::new(file))),
        Err(error) if has_end(path, "onnx") => Err(Failure::incompatible(chain(&error))),
        Err(_) => Err(other(path)),
    }
}
