//! The filter: one update, and what happens when no particle fits.
//!
//! # Recovery
//! Without resampling, a belief that has ruled out the truth stays wrong for ever. An observation
//! is called *impossible* when its predictive density ln Σ w_i Z(o | y_i, a) falls below
//! [`IMPOSSIBLE_LOG_DENSITY`]. Then the history is dropped: the particles stay where the measured
//! motion took them, the weights are even again, and the observation that broke the belief is
//! weighed alone, its log-likelihood cut off [`RECOVERY_SPAN`] below the best. After
//! [`RECOVERIES_IN_A_ROW`] impossible observations in a row the update fails instead: then the
//! model and the object do not belong together.

use std::fmt;
use std::sync::Arc;

use pubs_plugin::{ChannelKind, Support, Transitions};

use super::bias::Biases;
use super::moments::Moments;
use super::{Cloud, Model, ModelError, Summary, likelihood, weights};
use crate::vector::VectorUnit;
use crate::{Action, Task};

/// ln of the predictive density (forces in N, constants left out) below which an observation is
/// impossible: a reading some 14 standard deviations from everything the belief holds likely.
pub const IMPOSSIBLE_LOG_DENSITY: f64 = -100.0;

/// How much better than the worst the best particle may be after a recovery, nats.
pub const RECOVERY_SPAN: f32 = 10.0;

/// So many impossible observations in a row are one too many.
pub const RECOVERIES_IN_A_ROW: u32 = 10;

/// What an update did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Update {
    /// Eq. (6)–(8) as they stand.
    Weighed,
    /// The observation was impossible, and the recovery rule acted.
    Recovered(Recovery),
}

/// An impossible observation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovery {
    /// ln of its predictive density.
    pub log_density: f64,
    /// How many in a row this makes.
    pub in_a_row: u32,
}

/// Why an update failed; the belief is then as it was before.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BeliefError {
    /// Every particle is impossible, again and again.
    #[error(
        "no particle can explain what is felt: {observation} during `{action}` has log density {log_density:.0} \
         (impossible below {IMPOSSIBLE_LOG_DENSITY}), {in_a_row} times in a row; \
         the observation model does not fit this object: calibrate it again, or check the force sensor's tare and sign"
    )]
    Impossible {
        /// Channel names and values.
        observation: Observed,
        /// Name of the action.
        action: String,
        /// ln of the predictive density.
        log_density: f64,
        /// How many in a row.
        in_a_row: u32,
    },
    /// A reading is not a finite number.
    #[error("the observation during `{action}` is not finite: {observation}")]
    NotFinite {
        /// Channel names and values.
        observation: Observed,
        /// Name of the action.
        action: String,
    },
    /// The model failed or gave numbers that make no likelihood.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model's likelihood is not a number.
    #[error(
        "the observation model gives a likelihood that is not a number for {observation} during `{action}`"
    )]
    NotANumber {
        /// Channel names and values.
        observation: Observed,
        /// Name of the action.
        action: String,
    },
}

/// An observation with its channel names, for messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed(Vec<(String, f32)>);

impl fmt::Display for Observed {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(out, "{comma}{name} = {value:.3}")?;
        }
        Ok(())
    }
}

/// A particle filter for one task.
pub struct Filter {
    model: Arc<dyn Model>,
    unit: VectorUnit,
    actions: Arc<[Action]>,
    tempering: f32,
    reading_spacing: f64,
    prior: Cloud,
    cloud: Cloud,
    before: Cloud,
    biases: Option<Biases>,
    log_weights: Vec<f32>,
    previous: Vec<f32>,
    log_likelihood: Vec<f32>,
    moments: Moments,
    summary: Summary,
    entropy_scale: f64,
    recoveries: u32,
    recoveries_in_a_row: u32,
    travel_since_reading: f64,
    last_sign: f64,
}

impl Filter {
    /// A filter that knows nothing: even weights over the prior.
    pub fn new(task: &Task, model: Arc<dyn Model>) -> Self {
        Self::on(VectorUnit::best(), task, model)
    }

    /// The same on a chosen vector unit.
    pub fn on(unit: VectorUnit, task: &Task, model: Arc<dyn Model>) -> Self {
        let particles = task.belief.particles;
        let prior = Cloud::on(unit, &task.joint, particles);
        let channels = model.channels().len();
        let biases = task
            .belief
            .force_bias
            .map(|settings| Biases::new(settings, particles, model.channels()));
        let mut filter = Self {
            model,
            unit,
            actions: task.actions.as_slice().into(),
            tempering: task.belief.tempering as f32,
            reading_spacing: task.belief.reading_spacing,
            cloud: prior.clone(),
            before: prior.clone(),
            prior,
            biases,
            log_weights: vec![0.0; particles],
            previous: vec![0.0; particles],
            log_likelihood: vec![0.0; particles],
            moments: Moments::new(particles, channels),
            summary: Summary {
                mean: 0.0,
                entropy: 1.0,
            },
            entropy_scale: 1.0 / (particles as f64).ln(),
            recoveries: 0,
            recoveries_in_a_row: 0,
            travel_since_reading: f64::INFINITY,
            last_sign: 0.0,
        };
        filter.reset();
        filter
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.cloud.clone_from(&self.prior);
        self.forget_weights_and_biases();
        self.recoveries = 0;
        self.recoveries_in_a_row = 0;
        self.travel_since_reading = f64::INFINITY;
        self.last_sign = 0.0;
        self.normalise();
    }

    /// Mean and entropy, eq. (9) and (10).
    pub fn summary(&self) -> Summary {
        self.summary
    }

    /// States of the particles, ascending.
    pub fn states(&self) -> &[f32] {
        self.cloud.states()
    }

    /// Logarithms of the normalised weights.
    pub fn log_weights(&self) -> &[f32] {
        &self.log_weights
    }

    /// How often the recovery rule acted since the start.
    pub fn recoveries(&self) -> u32 {
        self.recoveries
    }

    /// The vector unit that results depend on in their last bit.
    pub fn vector_unit(&self) -> VectorUnit {
        self.unit
    }

    /// Share of weights^exponent at states of at least `state`.
    pub fn flattened_mass_above(&self, state: f64, exponent: f64) -> f64 {
        self.flattened_mass(state as f32, f32::INFINITY, exponent)
    }

    /// Share of weights^exponent at states of at most `state`.
    pub fn flattened_mass_below(&self, state: f64, exponent: f64) -> f64 {
        self.flattened_mass(f32::NEG_INFINITY, state as f32, exponent)
    }

    fn flattened_mass(&self, from: f32, to: f32, exponent: f64) -> f64 {
        let mass = weights::flattened_mass(
            self.unit,
            &self.log_weights,
            self.cloud.states(),
            exponent as f32,
            from,
            to,
        );
        f64::from(mass)
    }

    /// The central interval that holds `mass` of the belief. Each particle stands for the states
    /// nearest to it, so the ends lie half a particle spacing outwards.
    pub fn interval(&self, mass: f64) -> (f64, f64) {
        let tail = 0.5 * (1.0 - mass);
        let half = 0.5 * self.cloud.spacing();
        let particles = || {
            self.cloud
                .states()
                .iter()
                .copied()
                .zip(self.log_weights.iter().copied())
        };
        let from = quantile(particles(), tail).unwrap_or(f64::NEG_INFINITY);
        let to = quantile(particles().rev(), tail).unwrap_or(f64::INFINITY);
        (from - half, to + half)
    }

    /// One update: the handle moved by `displacement` (rad, m or plain) under `action` and
    /// `observation` `[C]` was made.
    ///
    /// # Errors
    /// [`BeliefError`]; the belief is then as it was before.
    pub fn update(
        &mut self,
        action: usize,
        displacement: f64,
        observation: &[f32],
    ) -> Result<Update, BeliefError> {
        if !observation.iter().all(|value| value.is_finite()) || !displacement.is_finite() {
            return Err(BeliefError::NotFinite {
                observation: self.observed(observation),
                action: self.action_name(action),
            });
        }
        self.before.clone_from(&self.cloud);
        if let Some(biases) = &mut self.biases {
            biases.remember();
        }
        self.previous.copy_from_slice(&self.log_weights);
        let counts_force = self.counts_force_reading(displacement);
        self.cloud.shift(displacement);
        let result = self
            .weigh(action, observation, counts_force)
            .and_then(|()| self.settle(action, observation));
        if result.is_err() {
            std::mem::swap(&mut self.cloud, &mut self.before);
            if let Some(biases) = &mut self.biases {
                biases.restore();
            }
            self.log_weights.copy_from_slice(&self.previous);
            self.normalise();
        }
        result
    }

    /// The handle moved by `displacement` while nothing could be learnt from the forces: eq. (6)
    /// alone. A displacement that is not finite is ignored.
    pub fn follow(&mut self, displacement: f64) {
        if displacement.is_finite() && displacement != 0.0 {
            self.cloud.shift(displacement);
            self.normalise();
        }
    }

    /// Whether this update's force reading counts: one does per `reading_spacing` of travel or
    /// reversal, because readings taken closer together are not independent.
    fn counts_force_reading(&mut self, displacement: f64) -> bool {
        if self.reading_spacing == 0.0 {
            return true;
        }
        let reversed = displacement * self.last_sign < 0.0;
        if displacement != 0.0 {
            self.last_sign = displacement.signum();
        }
        self.travel_since_reading += displacement.abs();
        let counts = reversed || self.travel_since_reading >= self.reading_spacing;
        if counts {
            self.travel_since_reading = 0.0;
        }
        counts
    }

    /// Eq. (7).
    fn weigh(
        &mut self,
        action: usize,
        observation: &[f32],
        counts_force: bool,
    ) -> Result<(), BeliefError> {
        let model = self.model.as_ref();
        if self
            .moments
            .predict(model, action, &self.before, &self.cloud)?
            == Support::Absent
        {
            return self.weigh_by_likelihood(action, observation, counts_force);
        }
        for (index, (channel, &observed)) in model.channels().iter().zip(observation).enumerate() {
            let (mean, sigma) = (self.moments.mean(index), self.moments.sigma(index));
            match channel.kind {
                ChannelKind::Gaussian if counts_force => {
                    let biases = self.biases.as_mut();
                    let biases = biases.map(|all| all.of(index, &self.actions[action]));
                    likelihood::add_force(
                        self.unit,
                        &mut self.log_weights,
                        (mean, sigma),
                        biases,
                        observed,
                        self.tempering,
                    );
                }
                ChannelKind::Gaussian => {}
                ChannelKind::Bernoulli => {
                    likelihood::add_bernoulli(
                        self.unit,
                        &mut self.log_weights,
                        mean,
                        observed > 0.5,
                    );
                }
            }
        }
        Ok(())
    }

    fn weigh_by_likelihood(
        &mut self,
        action: usize,
        observation: &[f32],
        counts_force: bool,
    ) -> Result<(), BeliefError> {
        if self.biases.is_some() {
            let message = "the filter rao_blackwell needs a model that provides moments";
            return Err(ModelError(message.to_owned()).into());
        }
        if !counts_force {
            return Ok(());
        }
        let transitions = Transitions {
            action,
            before: self.before.states(),
            after: self.cloud.states(),
        };
        if self
            .model
            .log_likelihood(transitions, observation, &mut self.log_likelihood)?
            == Support::Absent
        {
            let message = "the observation model provides neither moments nor log_likelihood";
            return Err(ModelError(message.to_owned()).into());
        }
        for (log_weight, log_likelihood) in self.log_weights.iter_mut().zip(&self.log_likelihood) {
            *log_weight += self.tempering * log_likelihood;
        }
        Ok(())
    }

    /// Eq. (8), or the recovery rule.
    fn settle(&mut self, action: usize, observation: &[f32]) -> Result<Update, BeliefError> {
        let log_density = self.normalise();
        if log_density.is_nan() {
            return Err(BeliefError::NotANumber {
                observation: self.observed(observation),
                action: self.action_name(action),
            });
        }
        if log_density >= IMPOSSIBLE_LOG_DENSITY {
            self.recoveries_in_a_row = 0;
            return Ok(Update::Weighed);
        }
        let in_a_row = self.recoveries_in_a_row + 1;
        if in_a_row >= RECOVERIES_IN_A_ROW {
            return Err(BeliefError::Impossible {
                observation: self.observed(observation),
                action: self.action_name(action),
                log_density,
                in_a_row,
            });
        }
        self.recoveries_in_a_row = in_a_row;
        self.recoveries += 1;
        self.start_afresh(action, observation)?;
        Ok(Update::Recovered(Recovery {
            log_density,
            in_a_row,
        }))
    }

    fn start_afresh(&mut self, action: usize, observation: &[f32]) -> Result<(), BeliefError> {
        self.forget_weights_and_biases();
        self.weigh(action, observation, true)?;
        let best = self
            .log_weights
            .iter()
            .copied()
            .fold(f32::NEG_INFINITY, f32::max);
        for log_weight in &mut self.log_weights {
            *log_weight = if best.is_finite() {
                log_weight.max(best - RECOVERY_SPAN)
            } else {
                0.0
            };
        }
        self.normalise();
        Ok(())
    }

    fn forget_weights_and_biases(&mut self) {
        self.log_weights.fill(0.0);
        if let Some(biases) = &mut self.biases {
            biases.forget();
        }
    }

    /// Normalises and summarises; ln of what the weights summed to.
    fn normalise(&mut self) -> f64 {
        let sums = weights::normalise(self.unit, &mut self.log_weights, self.cloud.states());
        let entropy = sums.entropy - self.entropy_of_gatherings();
        self.summary = Summary {
            mean: sums.mean,
            entropy: (entropy * self.entropy_scale).clamp(0.0, 1.0),
        };
        sums.log_total
    }

    /// What eq. (10) counts too much where a limit has gathered particles: they are at one place and
    /// always will be, so they are one hypothesis. Counted apart they would keep the entropy high
    /// in a belief that is sure of the limit, nats.
    fn entropy_of_gatherings(&self) -> f64 {
        let count = self.log_weights.len();
        let [(_, below), (_, above)] = self.cloud.gathered();
        let (lower, upper) = (below, above.min(count - below));
        let gatherings = [
            &self.log_weights[..lower],
            &self.log_weights[count - upper..],
        ];
        gatherings
            .into_iter()
            .filter(|gathering| gathering.len() > 1)
            .map(|gathering| f64::from(weights::entropy_of_gathering(self.unit, gathering)))
            .sum()
    }

    fn observed(&self, observation: &[f32]) -> Observed {
        let names = self
            .model
            .channels()
            .iter()
            .map(|channel| channel.name.clone());
        Observed(names.zip(observation.iter().copied()).collect())
    }

    fn action_name(&self, action: usize) -> String {
        self.actions
            .get(action)
            .map_or_else(|| format!("action {action}"), |action| action.name.clone())
    }
}

/// First state at which the weights, summed in the order given, reach `mass`.
fn quantile(mut particles: impl Iterator<Item = (f32, f32)>, mass: f64) -> Option<f64> {
    let mut sum = 0.0;
    let reached = particles.find(|&(_, log_weight)| {
        sum += f64::from(log_weight).exp();
        sum >= mass
    });
    reached.map(|(state, _)| f64::from(state))
}
