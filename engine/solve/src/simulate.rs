//! Trials of a policy on its problem, with the exact belief.

use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::belief;
use crate::policy::AlphaPolicy;
use crate::pomdp::Pomdp;

/// How trials are run.
#[derive(Clone, Debug)]
pub struct TrialOptions {
    /// How many.
    pub trials: usize,
    /// A trial ends after this many actions, or sooner in a terminal state.
    pub max_steps: usize,
    /// Equal seeds give equal trials; trial n has its own stream of numbers.
    pub seed: u64,
}

/// What trials earned.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialSummary {
    /// How many there were.
    pub trials: usize,
    /// The mean of the sum of rewards, and its standard error.
    pub reward: Mean,
    /// The mean of the discounted sum of rewards, and its standard error.
    pub discounted: Mean,
    /// The mean number of actions, and its standard error.
    pub steps: Mean,
    /// How many trials ended in a terminal state.
    pub ended: usize,
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    /// The mean.
    pub mean: f64,
    /// Its standard error; 0 where there was one trial.
    pub standard_error: f64,
}

impl Mean {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        if values.is_empty() {
            return Self::default();
        }
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let variance = squares / (count - 1.0).max(1.0);
        Self {
            mean,
            standard_error: (variance / count).sqrt(),
        }
    }
}

/// What one trial earned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// The sum of rewards.
    pub reward: f64,
    /// The discounted sum of rewards.
    pub discounted: f64,
    /// How many actions were taken.
    pub steps: usize,
    /// The state at the end.
    pub last_state: usize,
    /// Whether the trial ended in a terminal state.
    pub ended: bool,
}

/// Runs trials of a policy on all cores; their number changes nothing. The rewards are the expected ones, R(s, a).
///
/// The policy must be one for this problem ([`AlphaPolicy::check_problem`]).
pub fn simulate(pomdp: &Pomdp, policy: &AlphaPolicy, options: &TrialOptions) -> TrialSummary {
    let trials: Vec<Trial> = (0..options.trials)
        .into_par_iter()
        .map(|number| trial(pomdp, policy, options, number))
        .collect();
    let column = |value: fn(&Trial) -> f64| Mean::of(&trials.iter().map(value).collect::<Vec<_>>());
    TrialSummary {
        trials: trials.len(),
        reward: column(|trial| trial.reward),
        discounted: column(|trial| trial.discounted),
        steps: column(|trial| trial.steps as f64),
        ended: trials.iter().filter(|trial| trial.ended).count(),
    }
}

/// Runs trial `number` of those that [`simulate`] runs.
pub fn trial(pomdp: &Pomdp, policy: &AlphaPolicy, options: &TrialOptions, number: usize) -> Trial {
    // Odd multiples of the golden ratio keep the seeds of neighbouring trials far apart.
    let stream = (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(options.seed ^ stream);
    let mut belief = pomdp.start().to_vec();
    let mut state = draw(belief.iter().copied().enumerate(), &mut rng);
    let mut trial = Trial {
        reward: 0.0,
        discounted: 0.0,
        steps: 0,
        last_state: state,
        ended: pomdp.is_terminal(state),
    };
    let mut factor = 1.0;
    while !trial.ended && trial.steps < options.max_steps {
        let action = policy.choose(&belief);
        let reward = pomdp.reward(action, state);
        trial.reward += reward;
        trial.discounted += factor * reward;
        factor *= pomdp.discount();
        state = draw(pomdp.transition(action, state), &mut rng);
        let observation = draw(pomdp.observation(action, state), &mut rng);
        if let Some((next, _)) = belief::update(pomdp, &belief, action, observation) {
            belief = next;
        }
        trial.steps += 1;
        trial.last_state = state;
        trial.ended = pomdp.is_terminal(state);
    }
    trial
}

/// Draws from (item, probability) pairs that sum to one.
fn draw(items: impl Iterator<Item = (usize, f64)>, rng: &mut impl Rng) -> usize {
    let mut left: f64 = rng.random();
    let mut last = 0;
    for (item, probability) in items.filter(|item| item.1 > 0.0) {
        last = item;
        left -= probability;
        if left < 0.0 {
            break;
        }
    }
    last
}
