//! Where the frames of a recording stand in the file they came from.

use std::path::{Path, PathBuf};

use pubs_run::recording::Frame;

use crate::column::Column;
use crate::fault::Place;

/// The file of a recording, and how its frames are found in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    file: PathBuf,
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Mcap,
    /// The line of each frame.
    Csv(Vec<usize>),
}

impl Source {
    /// An MCAP file. Messages are counted as they could be read: in a file that has lost some, a
    /// later message has a smaller number than in the file as it was.
    pub fn mcap(file: &Path) -> Self {
        Self {
            file: file.to_owned(),
            kind: Kind::Mcap,
        }
    }

    /// A table with the line, from 1, of each frame.
    pub fn csv(file: &Path, lines: Vec<usize>) -> Self {
        Self {
            file: file.to_owned(),
            kind: Kind::Csv(lines),
        }
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// A key of the header.
    pub(crate) fn header(&self, key: &str) -> Place {
        let key = key.to_owned();
        match self.kind {
            Kind::Mcap => Place::Metadata { key },
            Kind::Csv(_) => Place::Comment { key, line: None },
        }
    }

    /// Where it says which demonstrations were carried out.
    pub(crate) fn done(&self) -> Place {
        match self.kind {
            Kind::Mcap => Place::File,
            Kind::Csv(_) => self.header("done"),
        }
    }

    /// Value `column` of `frames[index]`.
    pub(crate) fn cell(&self, frames: &[Frame], index: usize, column: Column) -> Place {
        match &self.kind {
            Kind::Csv(lines) => Place::Cell {
                line: lines.get(index).copied().unwrap_or(0),
                column: column.name().to_owned(),
            },
            Kind::Mcap => {
                let (topic, field) = column.message();
                let time_ns = |index: usize| frames[index].reading.time_ns as f64;
                // The truth has no message where nobody knows it.
                let number = frames[..=index]
                    .iter()
                    .filter(|frame| column != Column::Truth || frame.truth.is_some())
                    .count();
                Place::Message {
                    topic: topic.to_owned(),
                    number,
                    time_s: (time_ns(index) - time_ns(0)) * 1e-9,
                    field,
                }
            }
        }
    }
}
