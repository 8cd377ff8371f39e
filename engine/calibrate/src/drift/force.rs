//! Offset, gain, shift, local change and noise of a force.

use super::fit::{Fit, Model};
use super::region::{Criterion, Region, worst};
use super::spread::{Demonstrations, Doubt, Mean};
use super::{Cause, Drift, Finding, Outcome};
use crate::stored::Stored;

/// Noise matters where the rms residual is above this many sigmas.
const MATERIAL_NOISE: f64 = 1.5;

/// Or where more than this share of the samples lies beyond two sigmas.
const MATERIAL_OUTSIDE: f64 = 0.2;

/// Share of a normal distribution beyond two sigmas.
const EXPECTED_OUTSIDE: f64 = 0.0455;

/// Assumed spread between demonstrations of the mean square of e/σ, and of the share outside.
const ASSUMED_SQUARE_SD: f64 = 0.5;
const ASSUMED_OUTSIDE_SD: f64 = 0.1;

/// Samples of a demonstration that shifts and costs are worked out from.
const THINNED: usize = 400;

/// A cause further down the list must explain more than the one before by this factor.
const CLEARLY_MORE: f64 = 1.05;

const REGION: Criterion = Criterion {
    difference: |value, mean, sigma| (value - mean) / sigma,
    material: 1.5,
    assumed_sd: |_| 0.7,
    doubt: Doubt::REGION,
};

/// Fills in the figures of `drift` and judges them: first whether anything is off beyond doubt,
/// then what explains it best.
pub(super) fn compare(
    stored: &Stored,
    demonstrations: &Demonstrations,
    drift: &mut Drift,
) -> Outcome {
    let thinned = demonstrations.thinned(THINNED);
    let fit = Fit {
        stored,
        demonstrations,
        thinned: &thinned,
    };
    let estimates = Estimates {
        offset: fit.offset(),
        gain: fit.gain(),
        shift: fit.shift(),
    };
    let noise = Noise::of(&fit);
    drift.offset_n = Some(estimates.offset.estimate());
    drift.gain = estimates.gain.map(|gain| gain.estimate());
    drift.shift = estimates.shift.map(|shift| shift.estimate());
    drift.sigma_ratio = Some(noise.ratio);
    drift.outside = Some(noise.outside.value);

    let causes = estimates.causes(&fit);
    let region = worst(stored, demonstrations, &REGION);
    let cause_fails = causes.iter().any(|cause| cause.beyond_doubt);
    if cause_fails || region.is_some() || noise.is_beyond_doubt() {
        return Outcome::Fails(finding(&fit, causes, region, &noise));
    }
    if fit.is_material(&estimates.offset) || noise.is_material() {
        return Outcome::Unclear;
    }
    Outcome::Holds
}

/// What explains the residuals best. A cause that leaves half of what they are too large by is
/// named only where neither a region nor noise is beyond doubt.
fn finding(fit: &Fit, causes: Vec<Possible>, region: Option<Region>, noise: &Noise) -> Finding {
    let local_or_noise = region.is_some() || noise.is_beyond_doubt();
    let clearest = clearest(fit, causes);
    if let Some(found) = clearest.filter(|found| found.explains || !local_or_noise) {
        return Finding {
            cause: found.cause,
            region: None,
            left: fit.ratio(&found.model),
        };
    }
    let cause = if region.is_some() {
        Cause::Region
    } else {
        Cause::Noise
    };
    let left = noise.ratio;
    Finding {
        cause,
        region,
        left,
    }
}

/// The cause after which the samples are likeliest, of those that are beyond doubt or explain.
fn clearest(fit: &Fit, causes: Vec<Possible>) -> Option<Possible> {
    let before = fit.cost(&Model::Stored);
    let gained = |cause: &Possible| before - fit.cost(&cause.model);
    causes
        .into_iter()
        .filter(|cause| cause.beyond_doubt || cause.explains)
        .reduce(|best, next| {
            let clearly_more = gained(&next) > CLEARLY_MORE * gained(&best);
            if clearly_more { next } else { best }
        })
}

/// Estimates over the demonstrations.
struct Estimates {
    offset: Mean,
    gain: Option<Mean>,
    shift: Option<Mean>,
}

/// A cause that is large enough to matter.
struct Possible {
    cause: Cause,
    model: Model,
    beyond_doubt: bool,
    /// [`Fit::explains`].
    explains: bool,
}

impl Estimates {
    /// Those that matter, the commonest first.
    fn causes(&self, fit: &Fit) -> Vec<Possible> {
        let possible = |cause, model, beyond_doubt| {
            let explains = fit.explains(&model);
            Possible {
                cause,
                model,
                beyond_doubt,
                explains,
            }
        };
        let offset = Some(self.offset).filter(|offset| fit.is_material(offset));
        let gain = self.gain.filter(|gain| fit.is_material_gain(gain));
        let shift = self.shift.filter(|shift| fit.is_material_shift(shift));
        let offset = offset.map(|offset| {
            let model = Model::Offset(offset.value);
            possible(Cause::Offset, model, offset.differs_from(0.0, Doubt::ONE))
        });
        let gain = gain.map(|gain| {
            let model = Model::Gain(gain.value);
            possible(Cause::Gain, model, gain.differs_from(1.0, Doubt::ONE))
        });
        let shift = shift.map(|shift| {
            let model = Model::Shift(shift.value);
            possible(Cause::Shift, model, shift.differs_from(0.0, Doubt::ONE))
        });
        [offset, gain, shift].into_iter().flatten().collect()
    }
}

/// How widely the samples scatter.
struct Noise {
    /// Mean of (e/σ)².
    squares: Mean,
    /// Share of |e| > 2 σ.
    outside: Mean,
    /// Root mean square of e/σ over all samples.
    ratio: f64,
}

impl Noise {
    fn of(fit: &Fit) -> Self {
        let is_outside = |z: f64| if z.abs() > 2.0 { 1.0 } else { 0.0 };
        Self {
            squares: fit.over(ASSUMED_SQUARE_SD, |z| z * z),
            outside: fit.over(ASSUMED_OUTSIDE_SD, is_outside),
            ratio: fit.ratio(&Model::Stored),
        }
    }

    fn is_noisy(&self) -> bool {
        self.squares.value > MATERIAL_NOISE * MATERIAL_NOISE
    }

    fn is_scattered(&self) -> bool {
        self.outside.value > MATERIAL_OUTSIDE
    }

    fn is_material(&self) -> bool {
        self.is_noisy() || self.is_scattered()
    }

    fn is_beyond_doubt(&self) -> bool {
        self.is_noisy() && self.squares.differs_from(1.0, Doubt::ONE)
            || self.is_scattered() && self.outside.differs_from(EXPECTED_OUTSIDE, Doubt::ONE)
    }
}
