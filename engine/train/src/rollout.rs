//! Collecting experience with the present policy.

mod present;

use pubs_core::vector::VectorUnit;

use present::Present;

use crate::agent::Actor;
use crate::environment::{End, Environments};
use crate::error::TrainError;
use crate::gae::advantages;
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
    /// Whether the step ended an episode, `[sample]`.
    pub(crate) ended: Vec<bool>,
    pub(crate) truncated: Truncated,
    present: Present,
}

/// Steps that truncated an episode.
#[derive(Debug, Default)]
pub(crate) struct Truncated {
    pub(crate) samples: Vec<usize>,
    /// Scaled, `[truncation][feature]`.
    pub(crate) features: Vec<f32>,
}

/// What the value network says of a rollout.
#[derive(Debug)]
pub(crate) struct Values {
    /// Of each sample's observation, `[sample]`.
    pub(crate) samples: Vec<f32>,
    /// Of the last observation of each truncated episode, `[truncation]`.
    pub(crate) lost: Vec<f32>,
    /// Of the observation after the last step, `[environment]`.
    pub(crate) next: Vec<f32>,
}

impl Values {
    /// Room for the values of this rollout.
    pub(crate) fn new(rollout: &Rollout) -> Self {
        Self {
            samples: vec![0.0; rollout.samples()],
            lost: vec![0.0; rollout.truncated.samples.len()],
            next: vec![0.0; rollout.environments],
        }
    }
}

/// What collecting needs beside the environments.
pub(crate) struct Collector<'a, A> {
    pub(crate) unit: VectorUnit,
    pub(crate) actor: A,
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
            truncated: Truncated::default(),
            present: Present::new(environments),
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.taken.len()
    }

    pub(crate) fn environments(&self) -> usize {
        self.environments
    }

    /// Steps of each copy.
    pub(crate) fn length(&self) -> usize {
        self.length
    }

    /// The scaled observations after the last step, `[environment][feature]`.
    pub(crate) fn next_features(&self) -> &[f32] {
        &self.present.scaled
    }

    /// Copies the features of some samples to rows.
    pub(crate) fn gather_features(&self, samples: &[u32], rows: &mut [f32]) {
        let width = self.features.len() / self.samples();
        for (&sample, row) in samples.iter().zip(rows.chunks_exact_mut(width)) {
            let features = &self.features[sample as usize * width..][..width];
            // Element by element: a call of `memcpy` costs more than a few numbers.
            row.iter_mut()
                .zip(features)
                .for_each(|(to, from)| *to = *from);
        }
    }

    /// Steps every copy `length` times with actions drawn from the policy.
    pub(crate) fn collect<E: Environments>(
        &mut self,
        environments: &mut E,
        mut collector: Collector<'_, impl Actor>,
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
        collector: &mut Collector<'_, impl Actor>,
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
            if outcome.end.is_some() {
                collector.actor.begin_episode(index);
            }
            if outcome.end == Some(End::Truncated) {
                self.truncated
                    .add(sample, index, width, environments, collector.scaling);
            }
        }
    }

    /// Estimates advantages and returns from what the value network says.
    pub(crate) fn estimate(&mut self, values: &Values, discount: f32, lambda: f32) {
        for (&sample, lost) in self.truncated.samples.iter().zip(&values.lost) {
            self.rewards[sample] += discount * lost;
        }
        for (index, next) in values.next.iter().enumerate() {
            let own = index * self.length..(index + 1) * self.length;
            let mut values = values.samples[own.clone()].to_vec();
            values.push(*next);
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
        let pairs = self.advantages.iter().zip(&values.samples);
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
