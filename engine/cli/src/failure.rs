//! How a verb ends that cannot go on: one readable report and an exit code.

use std::error::Error;

use pubs_core::object::{self, Faults};
use pubs_host::HostError;

use crate::{exit, show};

/// Why a verb could not go on.
#[derive(Debug)]
pub enum Failure {
    /// An object file has faults; they are shown at their lines.
    Faults(Faults),
    /// Another file has faults, already laid out at their lines.
    Shown(String),
    /// Anything else, with its exit code.
    Other {
        /// One of [`exit`].
        code: u8,
        /// What happened, and what to do about it.
        message: String,
    },
}

impl Failure {
    /// In a line, where a verb goes on.
    pub fn in_a_line(&self) -> String {
        match self {
            Self::Faults(faults) => format!("{} faults", faults.0.len()),
            Self::Shown(text) => text.lines().next().unwrap_or_default().to_owned(),
            Self::Other { message, .. } => message.clone(),
        }
    }

    /// Something failed that is not the user's doing.
    pub fn fault(error: &dyn Error) -> Self {
        Self::Other {
            code: exit::FAULT,
            message: chain(error),
        }
    }

    /// The user's words cannot be followed.
    pub fn invalid(message: impl Into<String>) -> Self {
        Self::Other {
            code: exit::INVALID,
            message: message.into(),
        }
    }

    /// The same of several things, a line each.
    pub fn each(lines: impl AsRef<str>) -> Self {
        Self::invalid(lines.as_ref().replace('\n', "\nerror: "))
    }

    /// A plugin or policy does not fit.
    pub fn incompatible(message: impl Into<String>) -> Self {
        Self::Other {
            code: exit::INCOMPATIBLE,
            message: message.into(),
        }
    }

    /// Writes the report to stderr; the exit code.
    pub fn report(&self) -> u8 {
        match self {
            Self::Faults(faults) => {
                show::say(object::render(faults, show::color_on_stderr()).trim_end());
                exit::INVALID
            }
            Self::Shown(report) => {
                show::say(report);
                exit::INVALID
            }
            Self::Other { code, message } => {
                show::say(&format!("error: {message}"));
                *code
            }
        }
    }
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Self::Faults(faults)
    }
}

impl From<HostError> for Failure {
    fn from(error: HostError) -> Self {
        Self::incompatible(chain(&error))
    }
}

/// An error and its causes, each on its own line, unless the line above says it already.
pub fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let cause_text = cause.to_string();
        if !text.contains(&cause_text) {
            text.push_str("\n  because: ");
            text.push_str(&cause_text);
        }
        source = cause.source();
    }
    text
}
