//! The policy file: its contract, writing it as ONNX, running it.
//!
//! A policy is one ONNX file. Its graph takes the belief summary as named features in SI, scales
//! them itself and gives one logit per action; beside the file nothing is needed. Its metadata is
//! the contract: which task it was trained for, which goal, what its inputs and outputs are, and
//! sha256 sums over all of it, so that a damaged file or one of another task is refused.
//!
//! Writing: a [`Network`] and a [`Contract`] go through [`write()`], which runs the file and
//! compares it with the trainer's own logits before the file appears under its name. Running: a
//! [`Runtime`] is chosen once per process, a [`PolicyFile`] is read and checked in full, and each
//! thread opens its own [`Policy`] from it.

// The tests share their helpers with those outside the crate.
#[cfg(test)]
extern crate self as pubs_policy;

#[cfg(test)]
#[path = "../tests/common/mod.rs"]
mod common;

pub mod compare;
pub mod contract;
pub mod error;
pub mod export;
pub mod feature;
pub mod file;
mod hash;
mod layout;
pub mod lstm;
pub mod method;
pub mod network;
pub mod onnx;
pub mod policy;
pub mod runtime;
mod seal;

pub use compare::{Expected, Mismatch, Warning};
pub use contract::{Contract, FORMAT_VERSION, Goal, RECURRENT_FORMAT_VERSION, Shield, State};
pub use error::{Fault, PolicyError};
pub use export::{Existing, ExportError, Reference, write};
pub use feature::{Feature, FeatureName};
pub use file::PolicyFile;
pub use hash::{canonical_json, sha256_hex, task_hash};
pub use lstm::LstmCell;
pub use method::{Method, UnknownMethod};
pub use network::{Dense, Network, NetworkError};
pub use policy::{Policy, RunError, choose};
pub use runtime::{Runtime, RuntimeError};
