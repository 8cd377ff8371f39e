//! Who chooses the actions in trials.

use pubs_core::Input;
use pubs_core::shield::Shield;
use pubs_policy::{Policy, choose};
use pubs_train::surrogate::{Episode, Senses};

use crate::trial::TrialError;

/// Chooses actions for a batch of trials that run side by side.
pub trait Decider {
    /// What the episodes must keep up for it.
    fn senses(&self, shield: Option<&Shield>) -> Senses;

    /// `count` trials begin; what is remembered of earlier ones is forgotten.
    fn begin(&mut self, count: usize);

    /// Actions for the trials that still run, into `actions` in the same order; each is given with
    /// the number it had at the beginning.
    ///
    /// # Errors
    /// Where the policy or the belief fails.
    fn decide(
        &mut self,
        running: &[(usize, &Episode)],
        shield: Option<&Shield>,
        actions: &mut Vec<usize>,
    ) -> Result<(), TrialError>;
}

/// A policy file's network, with the state of a recurrent one.
pub struct NetworkDecider {
    policy: Policy,
    inputs: Vec<Input>,
    stop: usize,
    /// `[trial][state]`; empty where the network has none.
    states: Vec<f32>,
    rows: Rows,
}

/// Memory for one call, `[trial][…]`.
#[derive(Default)]
struct Rows {
    features: Vec<f32>,
    states: Vec<f32>,
    logits: Vec<f32>,
    allowed: Vec<bool>,
}

impl NetworkDecider {
    /// A policy whose inputs are these, on a task whose stop action has this index.
    pub fn new(policy: Policy, inputs: Vec<Input>, stop: usize) -> Self {
        Self {
            policy,
            inputs,
            stop,
            states: Vec::new(),
            rows: Rows::default(),
        }
    }

    fn state_of(&mut self, trial: usize) -> &mut [f32] {
        let width = self.policy.state_width();
        &mut self.states[trial * width..(trial + 1) * width]
    }
}

impl Decider for NetworkDecider {
    fn senses(&self, shield: Option<&Shield>) -> Senses {
        Senses::new(self.inputs.clone(), shield.is_some())
    }

    fn begin(&mut self, count: usize) {
        self.states.clear();
        self.states.resize(count * self.policy.state_width(), 0.0);
    }

    fn decide(
        &mut self,
        running: &[(usize, &Episode)],
        shield: Option<&Shield>,
        actions: &mut Vec<usize>,
    ) -> Result<(), TrialError> {
        let mut rows = std::mem::take(&mut self.rows);
        rows.features.resize(running.len() * self.inputs.len(), 0.0);
        rows.states.clear();
        let features = rows.features.chunks_exact_mut(self.inputs.len());
        for (&(trial, episode), row) in running.iter().zip(features) {
            episode.features(row);
            rows.states.extend_from_slice(self.state_of(trial));
        }
        self.policy.logits_with_state(
            &rows.features,
            running.len(),
            &mut rows.states,
            &mut rows.logits,
        )?;
        let width = self.policy.state_width();
        for (row, &(trial, _)) in running.iter().enumerate() {
            let state = &rows.states[row * width..(row + 1) * width];
            self.state_of(trial).copy_from_slice(state);
        }
        rows.allowed.resize(self.policy.actions(), true);
        actions.clear();
        let logits = rows.logits.chunks_exact(self.policy.actions());
        for ((_, episode), logits) in running.iter().zip(logits) {
            episode.allowed(shield, &mut rows.allowed);
            actions.push(choose(logits, self.stop, |index| rows.allowed[index]));
        }
        self.rows = rows;
        Ok(())
    }
}
