//! Whether the handle still moves as often.

use super::region::{Criterion, worst};
use super::spread::{Demonstrations, Doubt, Mean};
use super::{Cause, Drift, Finding, Outcome};
use crate::stored::Stored;

/// Probabilities are taken to be no nearer to 0 and 1 than this, lest one sample decide.
const MARGIN: f64 = 0.02;

/// Readings follow one another so closely that a demonstration may count as a single one: the
/// assumed spread is that of a reading, at the probability's margin or inside it.
const ASSUMED_SD: fn(f64) -> f64 = |deviation| deviation.max(0.14);

const REGION: Criterion = Criterion {
    difference: |value, probability, _| value - probability,
    material: 0.2,
    assumed_sd: ASSUMED_SD,
    doubt: Doubt::ONE,
};

/// Fills in the figures of `drift` and judges them.
pub(super) fn compare(
    stored: &Stored,
    demonstrations: &Demonstrations,
    drift: &mut Drift,
) -> Outcome {
    let probability = |state: f64| stored.moments(state).0.clamp(MARGIN, 1.0 - MARGIN);
    let mut differences = Vec::new();
    let (mut squares, mut variances) = (0.0, 0.0);
    for samples in demonstrations.iter() {
        let mut sum = 0.0;
        for sample in samples {
            let p = probability(sample.state);
            sum += sample.value - stored.moments(sample.state).0;
            squares += (sample.value - p).powi(2) / (p * (1.0 - p));
            variances += p * (1.0 - p);
        }
        differences.push(sum / samples.len() as f64);
    }
    let count = drift.samples as f64;
    let assumed_sd = ASSUMED_SD((variances / count).sqrt());
    drift.offset_n = Some(Mean::of(&differences, assumed_sd).estimate());
    let ratio = (squares / count).sqrt();
    drift.sigma_ratio = Some(ratio);
    let region = worst(stored, demonstrations, &REGION);
    match (region, demonstrations.count()) {
        (None, _) => Outcome::Holds,
        // One that got stuck once proves nothing.
        (Some(_), 1) => Outcome::Unclear,
        (region, _) => Outcome::Fails(Finding {
            cause: Cause::Moves,
            region,
            left: ratio,
        }),
    }
}
