//! One step of all copies: what they see and what they do.

use rand::RngExt;

use super::Collector;
use crate::agent::Actor;
use crate::environment::{Environments, StepOutcome};
use crate::error::TrainError;
use crate::kernels::column::BLOCK;
use crate::loss::Distribution;
use crate::scaling::InputScaling;

/// The present step of all copies.
#[derive(Debug)]
pub(super) struct Present {
    /// Unscaled and scaled, `[environment][feature]`.
    pub(super) raw: Vec<f32>,
    pub(super) scaled: Vec<f32>,
    /// `[environment][action]`.
    pub(super) allowed: Vec<bool>,
    /// `[environment]`.
    pub(super) actions: Vec<usize>,
    pub(super) log_probabilities: Vec<f32>,
    pub(super) outcomes: Vec<StepOutcome>,
    distribution: Distribution,
}

impl Present {
    pub(super) fn new(environments: &impl Environments) -> Self {
        let (count, features) = (environments.count(), environments.features());
        let actions = environments.actions();
        Self {
            raw: vec![0.0; count * features],
            scaled: vec![0.0; count * features],
            allowed: vec![true; count * actions],
            actions: vec![0; count],
            log_probabilities: vec![0.0; count],
            outcomes: vec![StepOutcome::default(); count],
            distribution: Distribution::new(actions),
        }
    }

    pub(super) fn observe<E: Environments>(
        &mut self,
        environments: &E,
        scaling: &InputScaling,
        steps: usize,
    ) -> Result<(), TrainError<E::Error>> {
        environments.observe(&mut self.raw, &mut self.allowed);
        scaling.apply(&self.raw, &mut self.scaled);
        let bad = |index, what| Err(TrainError::BadObservation { index, what, steps });
        if let Some(position) = self.scaled.iter().position(|x| !x.is_finite()) {
            let width = environments.features();
            return bad(position / width, "an observation that is not finite");
        }
        let mut masks = self.allowed.chunks_exact(environments.actions());
        match masks.position(|mask| !mask.contains(&true)) {
            Some(index) => bad(index, "a mask that allows no action"),
            None => Ok(()),
        }
    }

    pub(super) fn draw_actions(&mut self, collector: &mut Collector<'_, impl Actor>) {
        let actions = self.distribution.logits.len();
        let width = self.scaled.len() / self.actions.len();
        for first in (0..self.actions.len()).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(self.actions.len());
            let features = &self.scaled[first * width..block.end * width];
            let distribution = &mut self.distribution;
            let logits = &mut distribution.logits;
            collector.actor.logits(block.clone(), features, logits);
            for (sample, index) in block.clone().enumerate() {
                let mask = &self.allowed[index * actions..][..actions];
                for (column, allowed) in distribution.allowed.iter_mut().zip(mask) {
                    column[sample] = f32::from(u8::from(*allowed));
                }
            }
            distribution.normalise(collector.unit);
            for (sample, index) in block.enumerate() {
                let action = draw(distribution, sample, collector.generator.random());
                self.actions[index] = action;
                self.log_probabilities[index] = distribution.log_probabilities[action][sample];
            }
        }
    }
}

/// The action where the cumulative probability first exceeds `level`, a number in [0, 1).
fn draw(distribution: &Distribution, sample: usize, level: f32) -> usize {
    let mut cumulative = 0.0;
    let mut last_possible = 0;
    for (action, column) in distribution.probabilities.iter().enumerate() {
        cumulative += column[sample];
        if column[sample] > 0.0 {
            last_possible = action;
        }
        if cumulative > level {
            return action;
        }
    }
    // Rounding left the sum a little below 1.
    last_possible
}
