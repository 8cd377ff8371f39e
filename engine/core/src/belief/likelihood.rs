//! The observation likelihood, eq. (11), added to log weights.

use crate::vector::{Arithmetic, dispatched, ln};

/// Floor of the probability of either outcome of m_p: eq. (11) would let one odd reading rule out
/// a state for ever.
pub const LEAST_PROBABILITY: f32 = 0.001;

#[inline(always)]
fn gaussian_body<A: Arithmetic>(
    log_weights: &mut [f32],
    mean: &[f32],
    sigma: &[f32],
    observed: f32,
    exponent: f32,
) {
    for ((log_weight, &mean), &sigma) in log_weights.iter_mut().zip(mean).zip(sigma) {
        let deviation = (observed - mean) / sigma;
        let penalty = A::multiply_add(0.5 * deviation, deviation, ln::<A>(sigma));
        *log_weight = A::multiply_add(-exponent, penalty, *log_weight);
    }
}

dispatched! {
    /// Adds exponent · ln N(observed; mean, sigma²) + const to each log weight; the constant ½ ln 2π
    /// is the same for all and left out.
    pub fn add_gaussian(
        log_weights: &mut [f32],
        mean: &[f32],
        sigma: &[f32],
        observed: f32,
        exponent: f32,
    ) = gaussian_body
}

#[inline(always)]
fn bernoulli_body<A: Arithmetic>(log_weights: &mut [f32], probability: &[f32], observed: bool) {
    for (log_weight, &probability) in log_weights.iter_mut().zip(probability) {
        let of_one = probability.clamp(LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY);
        let of_outcome = if observed { of_one } else { 1.0 - of_one };
        *log_weight += ln::<A>(of_outcome);
    }
}

dispatched! {
    /// Adds the log probability of a 0-or-1 reading to each log weight.
    pub fn add_bernoulli(log_weights: &mut [f32], probability: &[f32], observed: bool) = bernoulli_body
}
