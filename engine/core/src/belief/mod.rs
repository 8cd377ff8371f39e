//! The belief: a particle filter over the joint state and its summary, §III-B.
//!
//! Sequential importance sampling without resampling. One update is four steps:
//! *predict* moves every particle by the measured displacement, eq. (6) (`cloud`);
//! *weigh* multiplies by the likelihood of the observation, eq. (7) (`likelihood`);
//! *normalise* makes the weights sum to one, eq. (8) (`weights`);
//! *summarise* takes mean and entropy, eq. (9) and (10), the latter over places: particles that a
//! limit has gathered count as one.
//! Where the object asks for it, each particle also estimates what readings are off by (`bias`).
//! Weights are kept as logarithms. `filter` says what happens when nothing fits any more.

mod bias;
mod cloud;
mod filter;
mod likelihood;
mod model;
mod moments;
mod weights;

pub use cloud::Cloud;
pub use filter::{BeliefError, Filter, Recovery, Update};
pub use model::{Model, ModelError};

/// `[belief]`: the filter's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeliefSettings {
    /// N.
    pub particles: usize,
    /// Filter updates per second (per policy step on abstract objects, see the actions).
    pub rate_hz: f64,
    /// Exponent on the likelihood of each counted force reading.
    pub tempering: f64,
    /// One force reading counts per this much travel or reversal (rad, m or plain); 0: every one.
    pub reading_spacing: f64,
    /// What each particle takes readings to be off by; `None` where they are taken at their word.
    pub force_bias: Option<ForceBias>,
}

/// What readings are off by, a little differently at each run: every particle estimates it for
/// itself, `filter = "rao_blackwell"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceBias {
    /// Standard deviation of the offset that a tare leaves in each axis of the force sensor, N.
    pub offset_sd_n: f64,
    /// Standard deviation of that offset's change from one counted reading to the next, N.
    pub offset_walk_n: f64,
    /// Standard deviation of the friction against what it was at calibration, N.
    pub friction_sd_n: f64,
}

/// x_t = (μ_t, H_t), what the policy sees of a belief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// μ of eq. (9) (rad, m or plain).
    pub mean: f64,
    /// H of eq. (10) divided by ln N, particles gathered at a limit counted as one: 1 is "know
    /// nothing", 0 certainty.
    pub entropy: f64,
}
