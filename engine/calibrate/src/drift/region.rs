//! Where along the joint a model is off.

use super::Sample;
use super::spread::{Demonstrations, Doubt, Mean};
use crate::stored::Stored;

/// Regions are segments, cut where they are longer than this share of the range.
const LONGEST: f64 = 0.1;

/// A demonstration with fewer samples in a region says nothing of it.
const FEWEST: usize = 3;

/// A stretch of the joint where what was measured differs from the model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    /// Its start, rad or m.
    pub(super) from: f64,
    /// Its end.
    pub(super) to: f64,
    /// Mean of the stored model there, N or a probability.
    pub(super) stored: f64,
    /// Mean of what was measured.
    pub(super) measured: f64,
    /// Their difference over sigma.
    size: f64,
}

/// What counts as a difference.
pub(super) struct Criterion {
    /// (value, mean, sigma) to the difference that is judged.
    pub(super) difference: fn(f64, f64, f64) -> f64,
    /// From here on it matters.
    pub(super) material: f64,
    /// How far demonstrations are assumed to spread, from the sigma at the region's middle.
    pub(super) assumed_sd: fn(f64) -> f64,
    pub(super) doubt: Doubt,
}

/// The region with the largest difference that counts.
pub(super) fn worst(
    stored: &Stored,
    demonstrations: &Demonstrations,
    criterion: &Criterion,
) -> Option<Region> {
    let regions = bounds(stored).into_iter();
    let found = regions.filter_map(|ends| differing(stored, demonstrations, criterion, ends));
    found.max_by(|a, b| a.size.total_cmp(&b.size))
}

fn bounds(stored: &Stored) -> Vec<(f64, f64)> {
    let longest = LONGEST * stored.range();
    let mut bounds = Vec::new();
    for segment in stored.segments() {
        let length = segment.to - segment.from;
        let parts = (length / longest).ceil().max(1.0);
        let at = |part: f64| segment.from + length * part / parts;
        bounds.extend((0..parts as usize).map(|part| (at(part as f64), at(part as f64 + 1.0))));
    }
    bounds
}

fn differing(
    stored: &Stored,
    demonstrations: &Demonstrations,
    criterion: &Criterion,
    (from, to): (f64, f64),
) -> Option<Region> {
    // The limits themselves, where a pressing tool leaves the state, belong to the outermost regions.
    let (first, last) = stored.ends();
    let inside = |sample: &&Sample| {
        let after = sample.state >= from || from <= first;
        after && (sample.state < to || to >= last)
    };
    let difference = |sample: &Sample| {
        let (mean, sigma) = stored.moments(sample.state);
        (criterion.difference)(sample.value, mean, sigma)
    };
    let groups: Vec<Vec<Sample>> = demonstrations
        .iter()
        .map(|samples| samples.iter().filter(inside).copied().collect())
        .filter(|samples: &Vec<Sample>| samples.len() >= FEWEST)
        .collect();
    if groups.is_empty() {
        return None;
    }
    let differences: Vec<f64> = groups
        .iter()
        .map(|group| average(group, difference))
        .collect();
    let sigma = stored.moments(0.5 * (from + to)).1;
    let mean = Mean::of(&differences, (criterion.assumed_sd)(sigma));
    let size = mean.value.abs();
    if size <= criterion.material || !mean.differs_from(0.0, criterion.doubt) {
        return None;
    }
    let all: Vec<Sample> = groups.concat();
    Some(Region {
        from,
        to,
        stored: average(&all, |sample| stored.moments(sample.state).0),
        measured: average(&all, |sample| sample.value),
        size,
    })
}

fn average(samples: &[Sample], of: impl Fn(&Sample) -> f64) -> f64 {
    samples.iter().map(of).sum::<f64>() / samples.len() as f64
}
