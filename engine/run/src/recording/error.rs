//! What can go wrong with a recording, in words for the user.

use std::path::{Path, PathBuf};

use mcap::McapError;

use super::RUN_FORMAT_VERSION;

/// Why a recording cannot be written or read. Each names the file, the reason and the cure.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// The file is there already.
    #[error("{}: this file exists, and a recording is never overwritten; choose another name, or remove it first", file.display())]
    Exists {
        /// The file.
        file: PathBuf,
    },
    /// The file cannot be created or written: the disk is full, the folder is missing.
    #[error("{}: the recording cannot be written: {reason}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        reason: String,
    },
    /// The file cannot be read at all.
    #[error("{}: the recording cannot be read: {reason}; give the path of a recording", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        reason: String,
    },
    /// It is something else.
    #[error("{}: not an MCAP file; give a recording that `run` or `calibrate` has written", file.display())]
    NotMcap {
        /// The file.
        file: PathBuf,
    },
    /// The header itself is cut off.
    #[error("{}: the file ends within its first lines, before it says what was recorded; nothing can be read, record again", file.display())]
    Headless {
        /// The file.
        file: PathBuf,
    },
    /// Another program's MCAP file.
    #[error("{}: an MCAP file, but not a recording of this program (it has no metadata `pubs-engine`); give one that `run` or `calibrate` has written", file.display())]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// The header makes no sense, or is of another version of the format.
    #[error("{}: metadata `pubs-engine`: `{key}` is {found}; expected {rule} (read it with the version of the program that wrote it, or record again)", file.display())]
    Header {
        /// The file.
        file: PathBuf,
        /// Key of the metadata.
        key: &'static str,
        /// Its text.
        found: String,
        /// What it should be.
        rule: String,
    },
    /// A calibration's recording, where a run's is needed.
    #[error("{}: a recording of format {format}, which does not hold what each loop saw (`calibrate` writes it, as did `run` of older versions); a replay needs format {RUN_FORMAT_VERSION}: make the run again with this version of the program", file.display())]
    NoRun {
        /// The file.
        file: PathBuf,
        /// Its format.
        format: u32,
    },
    /// A part without which nothing can be replayed is cut off or damaged.
    #[error("{}: {part} is cut off or damaged, and without it nothing can be replayed; make the run again", file.display())]
    Lacks {
        /// The file.
        file: PathBuf,
        /// What is not there.
        part: String,
    },
    /// Another program has compressed it.
    #[error("{}: its chunks are compressed ({compression}), which this program does not read; write it uncompressed with `mcap compress --compression none`", file.display())]
    Compressed {
        /// The file.
        file: PathBuf,
        /// Name of the compression.
        compression: String,
    },
    /// A topic that every frame needs is not there.
    #[error("{}: there are no messages on {topic}; a recording needs /pose, /wrench and /action, record again", file.display())]
    NoMessages {
        /// The file.
        file: PathBuf,
        /// Name of the topic.
        topic: &'static str,
    },
    /// A message that cannot be used.
    #[error(transparent)]
    Message(Box<BadMessage>),
}

/// A message that cannot be used, and why.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}: {topic} message {number} (t = {time_s:.2} s): {field} is {found}; expected {rule} (record again, or mend or leave out that row in a CSV file of the recording)", file.display())]
pub struct BadMessage {
    /// The file.
    pub file: PathBuf,
    /// Name of the topic.
    pub topic: &'static str,
    /// Which message of the topic, from 1.
    pub number: usize,
    /// Its time since the first message, s.
    pub time_s: f64,
    /// The value within the message, `force.x`.
    pub field: String,
    /// What stands there.
    pub found: String,
    /// What should.
    pub rule: String,
}

impl RecordingError {
    pub(super) fn write(file: &Path, error: &std::io::Error) -> Self {
        Self::Write {
            file: file.to_owned(),
            reason: error.to_string(),
        }
    }

    pub(super) fn mcap(file: &Path, error: &McapError) -> Self {
        match error {
            McapError::Io(error) => Self::write(file, error),
            error => Self::Write {
                file: file.to_owned(),
                reason: error.to_string(),
            },
        }
    }
}
