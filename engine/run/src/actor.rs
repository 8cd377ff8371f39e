//! A policy at work: its network, what it reads, and what a recurrent one remembers.

use pubs_core::Input;
use pubs_core::belief::Model;
use pubs_core::input::Seen;
use pubs_policy::{Policy, PolicyError, PolicyFile, RunError, Runtime};

use crate::inputs::{UnknownChannel, resolve};

/// A policy that is ready to be asked.
pub struct Actor {
    policy: Policy,
    inputs: Vec<Input>,
    features: Vec<f32>,
    state: Vec<f32>,
    logits: Vec<f32>,
}

/// Why a policy file cannot act on an object.
#[derive(Debug, thiserror::Error)]
pub enum ActorError {
    /// The runtime refuses it.
    #[error(transparent)]
    Policy(#[from] PolicyError),
    /// It reads what the object does not give.
    #[error(transparent)]
    Channel(#[from] UnknownChannel),
}

impl Actor {
    /// Opens a policy file for an object whose observation model is this.
    ///
    /// # Errors
    /// [`ActorError`].
    pub fn open(
        file: &PolicyFile,
        runtime: &Runtime,
        model: &dyn Model,
    ) -> Result<Self, ActorError> {
        let inputs = resolve(file.inputs(), model)?;
        let policy = file.open(runtime)?;
        Ok(Self {
            features: vec![0.0; inputs.len()],
            state: vec![0.0; policy.state_width()],
            logits: Vec::new(),
            policy,
            inputs,
        })
    }

    /// Number of actions that it chooses among.
    pub fn actions(&self) -> usize {
        self.policy.actions()
    }

    /// Logits `[actions]` of one step; what a recurrent policy remembers goes on.
    pub(crate) fn logits(&mut self, seen: &Seen<'_>) -> Result<&[f32], RunError> {
        seen.fill(&self.inputs, &mut self.features);
        self.policy
            .logits_with_state(&self.features, 1, &mut self.state, &mut self.logits)?;
        Ok(&self.logits)
    }
}
