//! Estimates of offset, gain and shift, and how well samples agree with what they make of a model.

use super::Sample;
use super::shift;
use super::spread::{Demonstrations, Mean};
use crate::stored::Stored;

/// Demonstrations are assumed to differ by a bias of this many sigmas.
const ASSUMED_BIAS: f64 = 0.5;

/// An offset matters above this many sigmas.
const MATERIAL_OFFSET: f64 = 1.0;

/// A gain matters where it moves this share of the samples by more than one sigma.
const MATERIAL_SHARE: f64 = 0.1;

/// A shift matters above this share of the range.
const MATERIAL_SHIFT: f64 = 0.01;

/// A gain that a bias falsifies by more is not told.
const VAGUE_GAIN: f64 = 0.25;

/// A shift that a bias falsifies by more than this share of the range is not told.
const VAGUE_SHIFT: f64 = 0.02;

/// (e/σ)² of an outlier counts as this, where outliers are left out.
const CLIPPED: f64 = 9.0;

/// The stored model, or what one cause makes of it.
pub(super) enum Model {
    Stored,
    Offset(f64),
    Gain(f64),
    Shift(f64),
}

impl Model {
    fn moments(&self, stored: &Stored, state: f64) -> (f64, f64) {
        match self {
            Self::Stored => stored.moments(state),
            Self::Shift(shift) => stored.moments(state - shift),
            Self::Offset(offset) => {
                let (mean, sigma) = stored.moments(state);
                (mean + offset, sigma)
            }
            Self::Gain(gain) => {
                let (mean, sigma) = stored.moments(state);
                (gain * mean, sigma)
            }
        }
    }
}

/// A stored model and the readings of a new recording.
pub(super) struct Fit<'a> {
    pub(super) stored: &'a Stored<'a>,
    pub(super) demonstrations: &'a Demonstrations,
    /// Those that shifts and costs are worked out from.
    pub(super) thinned: &'a Demonstrations,
}

impl Fit<'_> {
    /// Σ of `terms(value, mean, sigma)` over a demonstration, divided.
    fn quotients(&self, terms: impl Fn(f64, f64, f64) -> (f64, f64)) -> Vec<f64> {
        let quotient = |samples: &[Sample]| {
            let (mut above, mut below) = (0.0, 0.0);
            for sample in samples {
                let (mean, sigma) = self.stored.moments(sample.state);
                let (own_above, own_below) = terms(sample.value, mean, sigma);
                above += own_above;
                below += own_below;
            }
            (below > 0.0).then_some(above / below)
        };
        self.demonstrations.iter().filter_map(quotient).collect()
    }

    /// What a bias of [`ASSUMED_BIAS`] sigmas makes of an estimate whose sensitivity to the
    /// standardised residual of a sample is q / Σ q²: ASSUMED_BIAS · Σ|q| / Σ q².
    fn bias_influence(&self, sensitivity: impl Fn(&Sample) -> f64) -> f64 {
        let (mut sizes, mut squares) = (0.0, 0.0);
        for sample in self.thinned.samples() {
            let q = sensitivity(sample);
            sizes += q.abs();
            squares += q * q;
        }
        ASSUMED_BIAS * sizes / squares
    }

    /// The sigma that a weighted mean sees, (mean of 1/σ²)^(−1/2).
    fn typical_sigma(&self) -> f64 {
        let (mut weights, mut count) = (0.0, 0.0);
        for sample in self.thinned.samples() {
            weights += self.stored.moments(sample.state).1.powi(-2);
            count += 1.0;
        }
        (weights / count).powf(-0.5)
    }

    /// Σ w e / Σ w.
    pub(super) fn offset(&self) -> Mean {
        let each = self.quotients(|value, mean, sigma| {
            let weight = sigma.powi(-2);
            (weight * (value - mean), weight)
        });
        Mean::of(&each, ASSUMED_BIAS * self.typical_sigma())
    }

    /// Whether an offset matters.
    pub(super) fn is_material(&self, offset: &Mean) -> bool {
        offset.value.abs() > MATERIAL_OFFSET * self.typical_sigma()
    }

    /// Σ w μ v / Σ w μ²; None where a bias would falsify it.
    pub(super) fn gain(&self) -> Option<Mean> {
        let vague = self.bias_influence(|sample| {
            let (mean, sigma) = self.stored.moments(sample.state);
            mean / sigma
        });
        // A mean of 0 everywhere makes it NaN.
        if vague.is_nan() || vague > VAGUE_GAIN {
            return None;
        }
        let each = self.quotients(|value, mean, sigma| {
            let weight = sigma.powi(-2);
            (weight * mean * value, weight * mean * mean)
        });
        (!each.is_empty()).then(|| Mean::of(&each, vague))
    }

    /// Whether a gain matters.
    pub(super) fn is_material_gain(&self, gain: &Mean) -> bool {
        self.moves_many(|state| (gain.value - 1.0) * self.stored.moments(state).0)
    }

    /// Whether a change of the mean takes more than a tenth of the readings past one sigma.
    fn moves_many(&self, change: impl Fn(f64) -> f64) -> bool {
        let samples = self.thinned.samples();
        let (mut moved, mut count) = (0.0, 0.0);
        for sample in samples {
            let past = change(sample.state).abs() > self.stored.moments(sample.state).1;
            moved += if past { 1.0 } else { 0.0 };
            count += 1.0;
        }
        moved > MATERIAL_SHARE * count
    }

    /// The likeliest shift; None where a bias would falsify it.
    pub(super) fn shift(&self) -> Option<Mean> {
        let slope = |sample: &Sample| shift::relative_slope(self.stored, sample.state);
        let vague = self.bias_influence(slope);
        if vague.is_nan() || vague > VAGUE_SHIFT * self.stored.range() {
            return None;
        }
        let each: Vec<f64> = self
            .thinned
            .iter()
            .map(|samples| shift::best(self.stored, samples))
            .collect();
        Some(Mean::of(&each, vague))
    }

    /// Whether a shift matters: along a gentle slope a small bias of the session looks like a long one.
    pub(super) fn is_material_shift(&self, shift: &Mean) -> bool {
        let mean = |state: f64| self.stored.moments(state).0;
        let moved = |state: f64| mean(state - shift.value) - mean(state);
        shift.value.abs() > MATERIAL_SHIFT * self.stored.range() && self.moves_many(moved)
    }

    /// The mean over all samples, by demonstration, of a function of e/σ.
    pub(super) fn over(&self, assumed_sd: f64, of: impl Fn(f64) -> f64) -> Mean {
        let each = self.quotients(|value, mean, sigma| (of((value - mean) / sigma), 1.0));
        Mean::of(&each, assumed_sd)
    }

    /// Root mean square of e/σ under a model.
    pub(super) fn ratio(&self, model: &Model) -> f64 {
        self.mean_square(model, f64::INFINITY).sqrt()
    }

    /// Mean of (e/σ)², none of which counts as more than `most`.
    fn mean_square(&self, model: &Model, most: f64) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0);
        for sample in self.demonstrations.samples() {
            let (mean, sigma) = model.moments(self.stored, sample.state);
            squares += ((sample.value - mean) / sigma).powi(2).min(most);
            count += 1.0;
        }
        squares / count
    }

    /// −ln of the likelihood of the samples under a model, but for a constant.
    pub(super) fn cost(&self, model: &Model) -> f64 {
        let each = self.thinned.samples().map(|sample| {
            let (mean, sigma) = model.moments(self.stored, sample.state);
            shift::cost(sample.value - mean, sigma)
        });
        each.sum()
    }

    /// Whether `model` makes up for half of what the mean square of e/σ is above 1, with outliers
    /// or without them.
    pub(super) fn explains(&self, model: &Model) -> bool {
        [CLIPPED, f64::INFINITY].into_iter().any(|most| {
            let excess = |model| self.mean_square(model, most) - 1.0;
            excess(model) < 0.5 * excess(&Model::Stored)
        })
    }
}
