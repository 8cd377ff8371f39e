//! The policy file: its contract, writing it as ONNX, running it.
//!
//! A policy is one ONNX file. Its graph takes named inputs in SI (the belief summary, or the
//! latest readings for the baselines of §IV-B), scales them itself and gives one logit per action;
//! beside the file nothing is needed. Its metadata is the contract: which task it was trained for,
//! which goal, what its inputs and outputs are, and sha256 sums over all of it, so that a damaged
//! file or one of another task is refused.
//!
//! A recurrent policy has LSTM layers and carries a [`State`] from step to step. Beside `belief
//! [batch, inputs]` and `logits [batch, actions]` its graph has the tensors `state_in` and
//! `state_out`, both `[batch, state_width]`: LSTM layer by LSTM layer h, then c, all zeros where
//! an episode begins. Its contract says so in `state` and has format version 2, by which an engine
//! that knows no state refuses it; a perceptron's contract stays at 1.
//!
//! Writing: a [`Network`] and a [`Contract`] go through [`write()`], which runs the file and
//! compares it with the trainer's own logits, and a state step by step, before the file appears
//! under its name. Running: a [`Runtime`] is chosen once per process, a [`PolicyFile`] is read and
//! checked in full, and each thread opens its own [`Policy`] from it.
//!
//! | module | what it is for |
//! |---|---|
//! | [`feature`] | the inputs by name, unit and scaling |
//! | [`network`], [`lstm`] | what a trainer hands over, and its plain forward pass |
//! | [`contract`], [`compare`] | what a file promises, and whether an object can take it |
//! | [`export`] | writing a file and proving it |
//! | [`mod@file`], [`policy`] | reading a file in full, running it |
//! | [`runtime`] | tract or ONNX Runtime, once per process |
//! | [`onnx`] | the file format |
//! | [`error`] | why a file is refused |

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
