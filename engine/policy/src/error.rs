//! Why a policy file is refused.

use std::path::PathBuf;

use crate::compare::Mismatch;
use crate::contract::{FORMAT_VERSION, RECURRENT_FORMAT_VERSION};

/// A policy file that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("policy {}: {fault}", path.display())]
pub struct PolicyError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with a policy file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// Not there, not readable.
    #[error("cannot be read: {0}; give the path of an .onnx file")]
    Read(std::io::Error),
    /// A directory, a device.
    #[error("is not a file; give the path of an .onnx file")]
    NotAFile,
    /// Larger than any policy.
    #[error("is {0} bytes long, too long for a policy")]
    TooLong(u64),
    /// Not a whole ONNX file.
    #[error("is damaged or not an ONNX file: {0}; train or copy it again")]
    Damaged(String),
    /// A file format that the runtimes do not know.
    #[error("has ONNX file format {found}, known are 3 to 13; export it again with a known one")]
    IrVersion {
        /// The version in the file.
        found: u64,
    },
    /// Operators that the runtimes do not know.
    #[error(
        "uses ONNX operator set {found}, known are 9 to 18; export it again with opset_version=17"
    )]
    Opset {
        /// The version in the file.
        found: u64,
    },
    /// Written by another trainer.
    #[error(
        "carries no contract, so nobody knows what it reads; say it with --inputs, for example --inputs mean,entropy"
    )]
    NoContract,
    /// Written by an older or newer engine.
    #[error("has contract version {found}, this engine reads versions {FORMAT_VERSION} to {RECURRENT_FORMAT_VERSION}; {}", cure(*.newer))]
    FormatVersion {
        /// The version in the file.
        found: u64,
        /// Whether it is ahead of this engine's.
        newer: bool,
    },
    /// A sum is missing.
    #[error("is damaged: its metadata lacks {key}; train or copy it again")]
    NoSum {
        /// The entry.
        key: &'static str,
    },
    /// A sum differs: something has changed since it was written.
    #[error(
        "is damaged: the sha256 of its {part} is {found}, not {stated} as written; train or copy it again"
    )]
    Sum {
        /// Weights, network or contract.
        part: &'static str,
        /// As written.
        stated: String,
        /// As found.
        found: String,
    },
    /// The contract does not make sense.
    #[error("has a contract that {0}")]
    Contract(String),
    /// NaN or infinity among the weights.
    #[error("has weights that are no numbers: {0}; train it again")]
    NotFinite(String),
    /// Inputs or outputs are not what the contract or the caller says.
    #[error("{0}")]
    Shape(String),
    /// The runtime does not take it.
    #[error("is refused by {runtime}: {message}")]
    Runtime {
        /// Which runtime.
        runtime: String,
        /// Its own account.
        message: String,
    },
    /// Of another task.
    #[error("{0}")]
    Mismatch(Box<Mismatch>),
}

impl Fault {
    /// Puts the file's name to it.
    pub(crate) fn of(self, path: impl Into<PathBuf>) -> PolicyError {
        PolicyError {
            path: path.into(),
            fault: self,
        }
    }
}

fn cure(newer: bool) -> &'static str {
    if newer {
        "use a newer engine, or train it again with this one"
    } else {
        "train it again with this engine"
    }
}
