//! Collecting experience with the present policy.

use pubs_core::vector::VectorUnit;
use rand::RngExt;

use crate::environment::{End, Environments, StepOutcome};
use crate::error::TrainError;
use crate::gae::advantages;
use crate::kernels::column::BLOCK;
use crate::loss::Distribution;
use crate::network::{Network, Workspace};
use crate::progress::Episodes;
use crate::rng::Generator;
use crate::scaling::InputScaling;

/// The steps of all copies between two updates. Sample i is step i mod `length` of copy
/// i / `length`.
#[derive(Debug)]
pub(crate) struct Rollout {
    environments: usize,
    length: usize,
    actions: usize,
    /// Scaled, `[sample][feature]`.
    pub(crate) features: Vec<f32>,
    /// 1 or 0, `[sample][action]`.
    pub(crate) allowed: Vec<f32>,
    /// Index of the action taken, `[sample]`.
    pub(crate) taken: Vec<f32>,
    /// Of the action taken, `[sample]`.
    pub(crate) log_probabilities: Vec<f32>,
    /// `[sample]`.
    pub(crate) advantages: Vec<f32>,
    /// Advantage + value, what the value network should have said, `[sample]`.
    pub(crate) returns: Vec<f32>,
    rewards: Vec<f32>,
    ended: Vec<bool>,
    values: Vec<f32>,
    truncated: Truncated,
    present: Present,
}

/// Steps that truncated an episode.
#[derive(Debug, Default)]
struct Truncated {
    samples: Vec<usize>,
    /// Scaled, `[truncation][feature]`.
    features: Vec<f32>,
}

/// The present step of all copies.
#[derive(Debug)]
struct Present {
    /// Unscaled and scaled, `[environment][feature]`.
    raw: Vec<f32>,
    scaled: Vec<f32>,
    /// `[environment][action]`.
    allowed: Vec<bool>,
    /// `[environment]`.
    actions: Vec<usize>,
    log_probabilities: Vec<f32>,
    outcomes: Vec<StepOutcome>,
    distribution: Distribution,
}

/// What collecting needs beside the environments.
pub(crate) struct Collector<'a> {
    pub(crate) unit: VectorUnit,
    pub(crate) policy: &'a Network,
    pub(crate) workspace: &'a mut Workspace,
    pub(crate) scaling: &'a InputScaling,
    pub(crate) generator: &'a mut Generator,
    pub(crate) episodes: &'a mut Episodes,
    /// Steps done before, for messages.
    pub(crate) steps: usize,
}

impl Rollout {
    pub(crate) fn new(environments: &impl Environments, length: usize) -> Self {
        let (count, features) = (environments.count(), environments.features());
        let actions = environments.actions();
        let samples = count * length;
        Self {
            environments: count,
            length,
            actions,
            features: vec![0.0; samples * features],
            allowed: vec![0.0; samples * actions],
            taken: vec![0.0; samples],
            log_probabilities: vec![0.0; samples],
            advantages: vec![0.0; samples],
            returns: vec![0.0; samples],
            rewards: vec![0.0; samples],
            ended: vec![false; samples],
            values: vec![0.0; samples],
            truncated: Truncated::default(),
            present: Present {
                raw: vec![0.0; count * features],
                scaled: vec![0.0; count * features],
                allowed: vec![true; count * actions],
                actions: vec![0; count],
                log_probabilities: vec![0.0; count],
                outcomes: vec![StepOutcome::default(); count],
                distribution: Distribution::new(actions),
            },
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.taken.len()
    }

    /// Steps every copy `length` times with actions drawn from the policy.
    pub(crate) fn collect<E: Environments>(
        &mut self,
        environments: &mut E,
        mut collector: Collector<'_>,
    ) -> Result<(), TrainError<E::Error>> {
        self.truncated.samples.clear();
        self.truncated.features.clear();
        for step in 0..self.length {
            let steps = collector.steps + step * self.environments;
            let present = &mut self.present;
            present.observe(environments, collector.scaling, steps)?;
            present.draw_actions(&mut collector);
            environments
                .step(&present.actions, &mut present.outcomes)
                .map_err(|source| TrainError::Environment { steps, source })?;
            if let Some(index) = present.outcomes.iter().position(|o| !o.reward.is_finite()) {
                let what = "a reward that is not finite";
                return Err(TrainError::BadObservation { index, what, steps });
            }
            self.store(step, environments, &mut collector);
        }
        let steps = collector.steps + self.samples();
        self.present.observe(environments, collector.scaling, steps)
    }

    /// Copies the present step to its samples.
    fn store<E: Environments>(
        &mut self,
        step: usize,
        environments: &E,
        collector: &mut Collector<'_>,
    ) {
        let width = self.present.raw.len() / self.environments;
        for index in 0..self.environments {
            let sample = index * self.length + step;
            let present = &self.present;
            self.features[sample * width..][..width]
                .copy_from_slice(&present.scaled[index * width..][..width]);
            let mask = &present.allowed[index * self.actions..][..self.actions];
            let stored = &mut self.allowed[sample * self.actions..][..self.actions];
            for (stored, allowed) in stored.iter_mut().zip(mask) {
                *stored = f32::from(u8::from(*allowed));
            }
            let outcome = &present.outcomes[index];
            self.taken[sample] = present.actions[index] as f32;
            self.log_probabilities[sample] = present.log_probabilities[index];
            self.rewards[sample] = outcome.reward;
            self.ended[sample] = outcome.end.is_some();
            collector.episodes.record(index, outcome);
            if outcome.end == Some(End::Truncated) {
                self.truncated
                    .add(sample, index, width, environments, collector.scaling);
            }
        }
    }

    /// Estimates advantages and returns with the value network.
    pub(crate) fn estimate(
        &mut self,
        value: &Network,
        workspace: &mut Workspace,
        discount: f32,
        lambda: f32,
    ) {
        let mut lost = vec![0.0; self.truncated.samples.len()];
        evaluate(value, workspace, &self.truncated.features, &mut lost);
        for (&sample, lost) in self.truncated.samples.iter().zip(lost) {
            self.rewards[sample] += discount * lost;
        }
        evaluate(value, workspace, &self.features, &mut self.values);
        let mut next = vec![0.0; self.environments];
        evaluate(value, workspace, &self.present.scaled, &mut next);
        for (index, next) in next.into_iter().enumerate() {
            let own = index * self.length..(index + 1) * self.length;
            let mut values = self.values[own.clone()].to_vec();
            values.push(next);
            let rewards = &self.rewards[own.clone()];
            let ended = &self.ended[own.clone()];
            advantages(
                discount,
                lambda,
                rewards,
                &values,
                ended,
                &mut self.advantages[own],
            );
        }
        let pairs = self.advantages.iter().zip(&self.values);
        for (returns, (advantage, value)) in self.returns.iter_mut().zip(pairs) {
            *returns = advantage + value;
        }
    }
}

impl Truncated {
    fn add<E: Environments>(
        &mut self,
        sample: usize,
        index: usize,
        width: usize,
        environments: &E,
        scaling: &InputScaling,
    ) {
        let mut last = vec![0.0; width];
        environments.last_features(index, &mut last);
        let start = self.features.len();
        self.samples.push(sample);
        self.features.resize(start + width, 0.0);
        scaling.apply(&last, &mut self.features[start..]);
    }
}

impl Present {
    fn observe<E: Environments>(
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

    fn draw_actions(&mut self, collector: &mut Collector<'_>) {
        let actions = self.distribution.logits.len();
        let width = self.scaled.len() / self.actions.len();
        for first in (0..self.actions.len()).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(self.actions.len());
            let features = &self.scaled[first * width..block.end * width];
            let distribution = &mut self.distribution;
            let logits = &mut distribution.logits;
            collector
                .policy
                .forward(block.len(), features, collector.workspace, logits);
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

/// Values of scaled observations `[n][feature]`.
fn evaluate(value: &Network, workspace: &mut Workspace, features: &[f32], values: &mut [f32]) {
    let mut results = [[0.0; BLOCK]];
    for (features, values) in features
        .chunks(BLOCK * value.inputs())
        .zip(values.chunks_mut(BLOCK))
    {
        value.forward(values.len(), features, workspace, &mut results);
        values.copy_from_slice(&results[0][..values.len()]);
    }
}
