//! What is wrong with an input, where it stands and what mends it.

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// The file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What was found there.
    pub found: String,
    /// The rule that it breaks.
    pub rule: String,
    /// What to do.
    pub cure: String,
}

/// A place in an input file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a table, from 1 as an editor counts, and its column.
    Cell {
        /// The line.
        line: usize,
        /// Name of the column.
        column: String,
    },
    /// A `# key = value` line of a table.
    Comment {
        /// The key.
        key: String,
        /// The line, from 1, where it is known.
        line: Option<usize>,
    },
    /// A message of an MCAP file.
    Message {
        /// Name of the topic.
        topic: String,
        /// Which message of the topic, from 1.
        number: usize,
        /// Its time since the first frame, s.
        time_s: f64,
        /// The value within the message.
        field: String,
    },
    /// A key of the metadata of an MCAP file.
    Metadata {
        /// The key.
        key: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Cell { line, column } => write!(out, "line {line}, column {column}: "),
            Self::Comment {
                key,
                line: Some(line),
            } => write!(out, "line {line}, `# {key}`: "),
            Self::Comment { key, line: None } => write!(out, "`# {key}`: "),
            Self::Message {
                topic,
                number,
                time_s,
                field,
            } => write!(
                out,
                "{topic} message {number} (t = {time_s:.2} s), {field}: "
            ),
            Self::Metadata { key } => write!(out, "metadata `{key}`: "),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            place,
            found,
            rule,
            cure,
        } = self;
        write!(
            out,
            "{}: {place}{found}; expected {rule} ({cure})",
            file.display()
        )
    }
}

/// An input that cannot be used, with everything that is wrong with it. Never empty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refused {
    /// The first faults, in the order of the file.
    pub faults: Vec<Fault>,
    /// How many more there are.
    pub more: usize,
}

/// So many faults of one file are told.
const TOLD: usize = 20;

impl Refused {
    /// Keeps a fault, or counts it where enough are told.
    pub(crate) fn push(&mut self, fault: Fault) {
        if self.faults.len() < TOLD {
            self.faults.push(fault);
        } else {
            self.more += 1;
        }
    }

    /// Nothing wrong so far.
    pub(crate) fn none() -> Self {
        Self {
            faults: Vec::new(),
            more: 0,
        }
    }

    /// The value, unless something was wrong.
    pub(crate) fn unless_at_fault<T>(self, value: T) -> Result<T, Self> {
        if self.faults.is_empty() {
            Ok(value)
        } else {
            Err(self)
        }
    }
}

impl From<Fault> for Refused {
    fn from(fault: Fault) -> Self {
        Self {
            faults: vec![fault],
            more: 0,
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.faults.iter().map(Fault::to_string).collect();
        out.write_str(&lines.join("\n"))?;
        if self.more > 0 {
            write!(out, "\nand {} more", self.more)?;
        }
        Ok(())
    }
}

impl std::error::Error for Refused {}

/// The word most like `word`; `None` where nothing comes near.
pub(crate) fn nearest<'w>(word: &str, words: impl Iterator<Item = &'w str>) -> Option<&'w str> {
    const ALIKE: f64 = 0.8;
    words
        .map(|known| (strsim::jaro_winkler(word, known), known))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}
