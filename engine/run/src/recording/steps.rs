//! What a run records beside its frames: what each loop saw, so that a replay can show it the same.

use serde::{Deserialize, Serialize};

use super::{Frame, Observation};
use crate::loops::Verdict;
use crate::messages::BeliefMessage;

/// Bins of the particle histogram, evenly over the joint's range.
pub const BINS: usize = 50;

/// One tick of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// Its number, from 1.
    pub tick: u64,
    /// When it came.
    pub time_ns: u64,
    /// Time of the policy step whose order was in force; 0 before the first.
    pub order_ns: u64,
    /// Whether the arm was to come to rest whatever was ordered.
    pub stopping: bool,
    /// The reading and what was made of it; `None` where the driver gave none that can be used.
    pub felt: Option<(Frame, Observation)>,
}

/// One step of the filter.
#[derive(Debug, Clone, PartialEq)]
pub struct BeliefStep {
    /// When it came.
    pub time_ns: u64,
    /// The tick whose sample it took in; 0: there was none yet.
    pub tick: u64,
    /// What it told the policy, its own number among it.
    pub message: BeliefMessage,
    /// Mass of the particles in each bin; it adds up to 1.
    pub histogram: [f32; BINS],
    /// How often the recovery rule has acted so far.
    pub recoveries: u32,
    /// Why it could not go on.
    pub error: Option<String>,
}

/// One step of the policy.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its number, from 1.
    pub step: u64,
    /// When it came; the order it gave carries this time.
    pub time_ns: u64,
    /// The filter's step whose belief it took in; 0: there was none yet.
    pub belief: u64,
    /// The true joint state as it was known to the judge of violations.
    pub truth: Option<f64>,
    /// Which goal of the run, from 0.
    pub goal: usize,
    /// Index of the action chosen or still in force.
    pub action: usize,
    /// What it asked for.
    pub verdict: ChoiceVerdict,
    /// Why it could not go on.
    pub error: Option<String>,
}

/// What a policy step asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChoiceVerdict {
    /// Carry out the action.
    Going,
    /// All goals are dealt with.
    Done,
    /// A safety violation: stop for good.
    Violation,
}

impl From<&Verdict> for ChoiceVerdict {
    fn from(verdict: &Verdict) -> Self {
        match verdict {
            Verdict::Going => Self::Going,
            Verdict::Done => Self::Done,
            Verdict::Violation(_) => Self::Violation,
        }
    }
}

/// The guard stopped the arm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GuardStop {
    /// When.
    pub time_ns: u64,
    /// Why, in words.
    pub reason: String,
}

/// Range and goals of a run (rad or m).
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// `rad` or `m`.
    pub unit: &'static str,
    /// Closed.
    pub lower: f64,
    /// Open.
    pub upper: f64,
    /// Goals in turn.
    pub goals: Vec<f64>,
    /// Half the width of each goal's region.
    pub tolerance: f64,
}

/// Mass of the particles in [`BINS`] even bins from `lower` to `upper`; what lies outside counts
/// for the bin at that end.
pub fn histogram(states: &[f32], log_weights: &[f32], lower: f64, upper: f64) -> [f32; BINS] {
    let mut mass = [0.0; BINS];
    let per_bin = BINS as f64 / (upper - lower);
    for (&state, &log_weight) in states.iter().zip(log_weights) {
        let bin = ((f64::from(state) - lower) * per_bin).clamp(0.0, (BINS - 1) as f64);
        mass[bin as usize] += log_weight.exp();
    }
    mass
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_fall_into_their_bins() {
        let ln = |weights: [f32; 5]| weights.map(f32::ln);
        // Bins are 0.1 wide; the ends count for the outermost bins.
        let states = [0.0, 0.05, 0.25, 5.0, 7.0];
        let mass = histogram(&states, &ln([0.1, 0.2, 0.3, 0.15, 0.25]), 0.0, 5.0);
        for (bin, expected) in [(0, 0.3), (2, 0.3), (49, 0.4), (1, 0.0), (25, 0.0)] {
            assert!(
                (mass[bin] - expected).abs() < 1e-6,
                "bin {bin} holds {} in place of {expected}",
                mass[bin]
            );
        }
    }
}
