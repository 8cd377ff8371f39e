//! Is what a model calls its likelihood a density, and does it draw from that density?
//!
//! Observations are drawn from a wide proposal q fitted to the model's own samples. The mean of
//! p/q is then the integral of p (1 for a density), and the means of x·p/q and x²·p/q are those of
//! the density, which must be those of the samples.

use pubs_plugin::{ChannelKind, ModelSetup, Transitions};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::{HostError, ModelInstance};

const DRAWS: usize = 4096;

/// The proposal is this much wider than the samples, so that p/q stays bounded in the tails.
const WIDER: f64 = 1.7;

/// Difference allowed beside five standard errors.
const TOLERANCE: f64 = 0.03;

pub(super) fn check(model: &ModelInstance, setup: &ModelSetup) -> Result<String, String> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (lower, upper) = (setup.joint.lower, setup.joint.upper);
    let mut looked_at = 0;
    for (action, described) in setup
        .actions
        .iter()
        .enumerate()
        .filter(|(_, action)| !action.stop)
    {
        for share in [0.1, 0.5, 0.9] {
            let state = lower + share * (upper - lower);
            let state = if setup.joint.integer {
                state.round()
            } else {
                state
            };
            let after = (state + described.displacement).clamp(lower, upper);
            let place = Place {
                model,
                action,
                before: state as f32,
                after: after as f32,
            };
            place.check(&mut random)?;
            looked_at += 1;
        }
    }
    Ok(format!(
        "integrates to one and fits its own samples at {looked_at} transitions, {DRAWS} draws each"
    ))
}

/// One transition.
struct Place<'a> {
    model: &'a ModelInstance,
    action: usize,
    before: f32,
    after: f32,
}

/// A channel's samples in two numbers, and whether it is 0 or 1.
struct Spread {
    mean: f64,
    sd: f64,
    binary: bool,
}

impl Place<'_> {
    fn check(&self, random: &mut Xoshiro256PlusPlus) -> Result<(), String> {
        let spreads = self.spreads(random)?;
        let mut weights = Vec::with_capacity(DRAWS);
        let mut draws = Vec::with_capacity(DRAWS);
        for _ in 0..DRAWS {
            let (draw, log_proposal) = propose(&spreads, random);
            weights.push((self.log_density(&draw)? - log_proposal).exp());
            draws.push(draw);
        }
        self.compare("the integral of the density", &weights, 1.0, 1.0)?;
        for (channel, spread) in spreads.iter().enumerate() {
            let name = &self.model.channels()[channel].name;
            // Standardised, so that one tolerance serves channels of any unit.
            let scaled = |power: i32| -> Vec<f64> {
                let standard =
                    |draw: &Vec<f32>| (f64::from(draw[channel]) - spread.mean) / spread.sd;
                draws
                    .iter()
                    .zip(&weights)
                    .map(|(draw, weight)| weight * standard(draw).powi(power))
                    .collect()
            };
            // The samples' own mean and variance are known to 1/√DRAWS; allow for that.
            self.compare(
                &format!("the mean of `{name}` less that of its samples, in sd,"),
                &scaled(1),
                0.0,
                2.0,
            )?;
            self.compare(
                &format!("the variance of `{name}` over that of its samples"),
                &scaled(2),
                1.0,
                3.0,
            )?;
        }
        Ok(())
    }

    /// Mean of `values` against `expected`, within five standard errors (more where `doubt` > 1).
    fn compare(&self, what: &str, values: &[f64], expected: f64, doubt: f64) -> Result<(), String> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values
            .iter()
            .map(|value| (value - mean).powi(2))
            .sum::<f64>()
            / count;
        let allowed =
            TOLERANCE + 5.0 * (variance / count).sqrt() + (doubt - 1.0) * 5.0 / count.sqrt();
        if (mean - expected).abs() <= allowed {
            return Ok(());
        }
        let Self {
            action,
            before,
            after,
            ..
        } = self;
        Err(format!(
            "{what} is {mean:.4}, expected {expected} ± {allowed:.4} (action {action}, state {before} to {after})"
        ))
    }

    /// The model's own samples at this transition.
    fn spreads(&self, random: &mut Xoshiro256PlusPlus) -> Result<Vec<Spread>, String> {
        let channels = self.model.channels();
        let (before, after) = (vec![self.before; DRAWS], vec![self.after; DRAWS]);
        let normals: Vec<f32> = (0..channels.len() * DRAWS)
            .map(|_| random.sample(StandardNormal))
            .collect();
        let mut samples = vec![f32::NAN; channels.len() * DRAWS];
        let transitions = Transitions {
            action: self.action,
            before: &before,
            after: &after,
        };
        self.model
            .sample(transitions, &normals, &mut samples)
            .map_err(|error: HostError| error.to_string())?;
        let spread = |(channel, values): (&pubs_plugin::Channel, &[f32])| {
            let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / DRAWS as f64;
            let variance = values
                .iter()
                .map(|value| (f64::from(*value) - mean).powi(2))
                .sum::<f64>()
                / DRAWS as f64;
            let binary = channel.kind == ChannelKind::Bernoulli;
            match variance.sqrt() {
                sd if sd > 0.0 => Ok(Spread { mean, sd, binary }),
                // A channel that is nearly always the same number has no spread to compare.
                _ if binary => Ok(Spread {
                    mean,
                    sd: 1.0,
                    binary,
                }),
                _ => Err(format!(
                    "`{}` is {mean} in every sample; a density needs some spread",
                    channel.name
                )),
            }
        };
        channels
            .iter()
            .zip(samples.chunks(DRAWS))
            .map(spread)
            .collect()
    }

    fn log_density(&self, observation: &[f32]) -> Result<f64, String> {
        let mut value = [f32::NAN];
        let transitions = Transitions {
            action: self.action,
            before: &[self.before],
            after: &[self.after],
        };
        self.model
            .log_likelihood(transitions, observation, &mut value)
            .map_err(|error| error.to_string())?;
        Ok(f64::from(value[0]))
    }
}

/// One draw from q and ln q of it.
fn propose(spreads: &[Spread], random: &mut Xoshiro256PlusPlus) -> (Vec<f32>, f64) {
    let mut log_proposal = 0.0;
    let draw = spreads.iter().map(|spread| {
        if spread.binary {
            log_proposal += 0.5_f64.ln();
            return f32::from(random.random::<bool>());
        }
        let normal: f64 = random.sample(StandardNormal);
        let sd = WIDER * spread.sd;
        log_proposal -= normal * normal / 2.0 + (sd * std::f64::consts::TAU.sqrt()).ln();
        (spread.mean + sd * normal) as f32
    });
    (draw.collect(), log_proposal)
}
