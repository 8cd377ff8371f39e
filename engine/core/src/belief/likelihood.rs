//! The observation likelihood, eq. (11), added to log weights; with a bias of the sensor where the
//! filter carries one.

use crate::vector::{Arithmetic, VectorUnit, dispatched, ln};

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
    fn add_gaussian(
        log_weights: &mut [f32],
        mean: &[f32],
        sigma: &[f32],
        observed: f32,
        exponent: f32,
    ) = gaussian_body
}

/// What one channel's readings say of the force bias at each particle: it is h·o + f with o the
/// sensor's offset and f the change of friction, jointly normal.
pub struct ForceBiases<'a> {
    /// h: −1 where the channel's axis has turned round with the motion, else 1.
    pub sign: f32,
    /// What o's variance grows by before each reading, N².
    pub walk_variance: f32,
    /// Means of o, N.
    pub offset: &'a mut [f32],
    /// Means of f, N.
    pub friction: &'a mut [f32],
    /// Variances of o, N².
    pub offset_variance: &'a mut [f32],
    /// Covariances of o and f, N².
    pub covariance: &'a mut [f32],
    /// Variances of f, N².
    pub friction_variance: &'a mut [f32],
}

#[inline(always)]
fn biased_gaussian_body<A: Arithmetic>(
    log_weights: &mut [f32],
    mean: &[f32],
    sigma: &[f32],
    biases: ForceBiases<'_>,
    observed: f32,
    exponent: f32,
) {
    let (h, walk_variance) = (biases.sign, biases.walk_variance);
    let means = biases.offset.iter_mut().zip(biases.friction);
    let variances = biases
        .offset_variance
        .iter_mut()
        .zip(biases.covariance)
        .zip(biases.friction_variance);
    let predicted = mean.iter().zip(sigma);
    let particles = log_weights
        .iter_mut()
        .zip(predicted)
        .zip(means)
        .zip(variances);
    for (((log_weight, (&mean, &sigma)), (offset, friction)), ((p_oo, p_of), p_ff)) in particles {
        *p_oo += walk_variance;
        let of_offset = A::multiply_add(h, *p_oo, *p_of);
        let of_friction = A::multiply_add(h, *p_of, *p_ff);
        let variance = A::multiply_add(h, of_offset, of_friction);
        let total = A::multiply_add(sigma, sigma, exponent * variance);
        let deviation = observed - mean - A::multiply_add(h, *offset, *friction);
        let gain = exponent / total;
        let share = gain * deviation;
        let penalty = 0.5 * A::multiply_add(share, deviation, ln::<A>(total));
        *log_weight += A::multiply_add(1.0 - exponent, ln::<A>(sigma), -penalty);
        *offset = A::multiply_add(share, of_offset, *offset);
        *friction = A::multiply_add(share, of_friction, *friction);
        *p_oo = A::multiply_add(-gain * of_offset, of_offset, *p_oo);
        *p_of = A::multiply_add(-gain * of_offset, of_friction, *p_of);
        *p_ff = A::multiply_add(-gain * of_friction, of_friction, *p_ff);
    }
}

dispatched! {
    /// The same where readings have a bias b = h·o + f that is known at each particle as a normal:
    /// adds exponent τ times the log-likelihood with b integrated out, ln ∫ N(observed; mean + b,
    /// sigma²)^τ p(b) db, to each log weight, and leaves what the reading says of o and f.
    ///
    /// N(…, sigma²)^τ is a normal of variance sigma²/τ but for a factor, so this is the update of
    /// a Kalman filter. With P the covariance of (o, f), V = (h, 1) P (h, 1)ᵀ the variance of b,
    /// e = observed − mean − b and T = sigma² + τV: the log weight grows by (1 − τ) ln sigma −
    /// ½ ln T − ½ τe²/T, (o, f) by P (h, 1)ᵀ τe/T, and P shrinks by P (h, 1)ᵀ (h, 1) P τ/T. Where
    /// P is 0 it is [`add_gaussian`].
    fn add_biased_gaussian(
        log_weights: &mut [f32],
        mean: &[f32],
        sigma: &[f32],
        biases: ForceBiases<'_>,
        observed: f32,
        exponent: f32,
    ) = biased_gaussian_body
}

/// Adds a force reading's log-likelihood to each log weight, with biases where there are some.
pub fn add_force(
    unit: VectorUnit,
    log_weights: &mut [f32],
    (mean, sigma): (&[f32], &[f32]),
    biases: Option<ForceBiases<'_>>,
    observed: f32,
    exponent: f32,
) {
    match biases {
        None => add_gaussian(unit, log_weights, mean, sigma, observed, exponent),
        Some(biases) => {
            add_biased_gaussian(unit, log_weights, mean, sigma, biases, observed, exponent);
        }
    }
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
