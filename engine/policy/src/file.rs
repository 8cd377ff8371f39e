//! A policy file: read once, checked in full, opened as often as there are threads.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::contract::Contract;
use crate::error::{Fault, PolicyError};
use crate::layout::Layout;
use crate::onnx::Model;
use crate::policy::Policy;
use crate::{Expected, FeatureName, Runtime, State, Warning, seal};

/// File formats that both runtimes read.
const IR_VERSIONS: std::ops::RangeInclusive<u64> = 3..=13;
/// Operator sets that both runtimes know; tract would take any other without a word.
const OPSETS: std::ops::RangeInclusive<u64> = 9..=18;
/// Far above any policy; keeps a wrong path from filling the memory.
const LONGEST_BYTES: u64 = 1 << 30;

/// A checked policy file, kept in memory: what was checked is what runs.
#[derive(Debug, Clone)]
pub struct PolicyFile {
    path: PathBuf,
    bytes: Arc<[u8]>,
    contract: Option<Contract>,
    inputs: Vec<FeatureName>,
    layout: Layout,
    sha256: String,
}

impl PolicyFile {
    /// Reads a file that carries a contract.
    ///
    /// # Errors
    /// Where it is not readable, damaged, of another version, or not as its contract says.
    pub fn read(path: &Path) -> Result<Self, PolicyError> {
        read(path)
            .and_then(|bytes| Self::from_bytes(path, bytes))
            .map_err(|fault| fault.of(path))
    }

    /// Reads a file of another trainer: one float32 input `[batch, inputs]` in SI, unscaled, and
    /// one output `[batch, actions]`. One that carries a state is not supported: nothing says how
    /// its tensors lie and where an episode begins.
    ///
    /// # Errors
    /// Where it is not readable, damaged, of unknown operators, or of another shape.
    pub fn read_foreign(
        path: &Path,
        inputs: &[FeatureName],
        actions: usize,
    ) -> Result<Self, PolicyError> {
        read(path)
            .map_err(|fault| fault.of(path))
            .and_then(|bytes| Self::foreign_from_memory(path, bytes, inputs, actions))
    }

    /// [`read`](Self::read) of bytes that were kept elsewhere; `path` is their name in messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_memory(path: &Path, bytes: Vec<u8>) -> Result<Self, PolicyError> {
        Self::from_bytes(path, bytes).map_err(|fault| fault.of(path))
    }

    /// [`read_foreign`](Self::read_foreign) of bytes that were kept elsewhere; `path` is their name
    /// in messages.
    ///
    /// # Errors
    /// As [`read_foreign`](Self::read_foreign).
    pub fn foreign_from_memory(
        path: &Path,
        bytes: Vec<u8>,
        inputs: &[FeatureName],
        actions: usize,
    ) -> Result<Self, PolicyError> {
        let read = || -> Result<Self, Fault> {
            let model = checked_model(&bytes)?;
            finite(&model)?;
            let layout = Layout::of_foreign(&model, inputs.len(), actions)?;
            Ok(Self::assemble(
                path,
                bytes.clone(),
                &model,
                None,
                inputs.to_vec(),
                layout,
            ))
        };
        read().map_err(|fault| fault.of(path))
    }

    fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, Fault> {
        let model = checked_model(&bytes)?;
        let contract = seal::open(&model)?;
        finite(&model)?;
        let inputs: Vec<FeatureName> = contract
            .inputs
            .iter()
            .map(|feature| feature.name.clone())
            .collect();
        let state = contract.state.as_ref().map_or(0, State::width);
        let layout = Layout::of_ours(&model, inputs.len(), contract.actions.len(), state)?;
        Ok(Self::assemble(
            path,
            bytes,
            &model,
            Some(contract),
            inputs,
            layout,
        ))
    }

    fn assemble(
        path: &Path,
        bytes: Vec<u8>,
        model: &Model,
        contract: Option<Contract>,
        inputs: Vec<FeatureName>,
        layout: Layout,
    ) -> Self {
        Self {
            path: path.to_owned(),
            bytes: bytes.into(),
            contract,
            inputs,
            layout,
            sha256: model.weights_sha256.clone(),
        }
    }

    /// Where it was read from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file itself.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What it promises; `None` for a file of another trainer.
    #[must_use]
    pub fn contract(&self) -> Option<&Contract> {
        self.contract.as_ref()
    }

    /// What it reads, in order.
    #[must_use]
    pub fn inputs(&self) -> &[FeatureName] {
        &self.inputs
    }

    /// The number of its logits.
    #[must_use]
    pub fn actions(&self) -> usize {
        self.layout.actions
    }

    /// Numbers that it carries from step to step; 0 for a perceptron.
    #[must_use]
    pub fn state_width(&self) -> usize {
        self.layout.state
    }

    /// The sha256 of its weights: its name in logs.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// [`Contract::compare`], with the file's name put to a mismatch. A file of another trainer
    /// promises nothing and is taken as it is.
    ///
    /// # Errors
    /// Where the policy is of another task, other actions or another goal.
    pub fn check(&self, expected: &Expected) -> Result<Vec<Warning>, PolicyError> {
        match &self.contract {
            None => Ok(Vec::new()),
            Some(contract) => contract
                .compare(expected)
                .map_err(|fault| Fault::Mismatch(Box::new(fault)).of(&self.path)),
        }
    }

    /// A session for one thread, tried out once so that it fails here or never and its first
    /// action is as quick as any.
    ///
    /// # Errors
    /// Where the runtime refuses it.
    pub fn open(&self, runtime: &Runtime) -> Result<Policy, PolicyError> {
        let refused = |message| {
            Fault::Runtime {
                runtime: runtime.to_string(),
                message,
            }
            .of(&self.path)
        };
        let session = runtime.session(&self.bytes).map_err(refused)?;
        let mut policy = Policy::new(session, self.layout);
        let middle = vec![0.5; self.layout.features];
        let mut start = vec![0.0; self.layout.state];
        policy
            .logits_with_state(&middle, 1, &mut start, &mut Vec::new())
            .map_err(|fault| refused(fault.to_string()))?;
        Ok(policy)
    }
}

fn read(path: &Path) -> Result<Vec<u8>, Fault> {
    let metadata = std::fs::metadata(path).map_err(Fault::Read)?;
    if !metadata.is_file() {
        return Err(Fault::NotAFile);
    }
    if metadata.len() > LONGEST_BYTES {
        return Err(Fault::TooLong(metadata.len()));
    }
    let mut bytes = Vec::new();
    let mut file = File::open(path).map_err(Fault::Read)?;
    file.read_to_end(&mut bytes).map_err(Fault::Read)?;
    Ok(bytes)
}

fn checked_model(bytes: &[u8]) -> Result<Model, Fault> {
    let model = Model::read(bytes).map_err(Fault::Damaged)?;
    if !IR_VERSIONS.contains(&model.ir_version) {
        return Err(Fault::IrVersion {
            found: model.ir_version,
        });
    }
    if !OPSETS.contains(&model.opset) {
        return Err(Fault::Opset { found: model.opset });
    }
    Ok(model)
}

/// tanh swallows NaN, so the logits would not show it.
fn finite(model: &Model) -> Result<(), Fault> {
    model
        .not_finite
        .clone()
        .map_or(Ok(()), |described| Err(Fault::NotFinite(described)))
}

#[cfg(test)]
mod tests;
