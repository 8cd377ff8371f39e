//! What is wrong with an object file.

use std::fmt;
use std::ops::Range;

use serde::Serialize;

/// One thing that is wrong, where it stands and what mends it.
///
/// Serialised as `check --json` prints it; line and column are null where the value came from
/// the environment or the command line, and where the whole file is meant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// Path of the object file.
    pub file: String,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// Path of the key, `belief.particles` or `action.3.move` (from 0); empty for the whole file.
    pub key: String,
    /// What was found and which rule it breaks.
    pub message: String,
    /// What to do.
    pub help: String,
    /// The text to show it in.
    #[serde(skip)]
    pub(super) excerpt: Option<Excerpt>,
}

/// A piece of source text with the part at fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Excerpt {
    /// Name of the source: a path, or where an override was given.
    pub name: String,
    /// One whole line.
    pub line: String,
    /// Its number, from 1.
    pub number: usize,
    /// The part at fault, bytes of `line`.
    pub span: Range<usize>,
}

impl Fault {
    /// A fault of the file as a whole.
    pub fn of_file(
        file: impl Into<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            file: file.into(),
            line: None,
            column: None,
            key: String::new(),
            message: message.into(),
            help: help.into(),
            excerpt: None,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.file)?;
        if let (Some(line), Some(column)) = (self.line, self.column) {
            write!(formatter, ":{line}:{column}")?;
        }
        write!(formatter, ": {} ({})", self.message, self.help)
    }
}

/// Everything that is wrong with a file, in the order of its lines. Never empty.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Faults(pub Vec<Fault>);

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, fault) in self.0.iter().enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(formatter, "{separator}{fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Faults {}
