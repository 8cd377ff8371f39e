//! Regions of distinct variance of a signal, §III-C.1, by Bayesian online changepoint detection
//! (Adams and MacKay, arXiv:0710.3742).
//!
//! The detector gives, for each sample, a distribution over the length of the run it belongs to;
//! walking back along the likeliest runs gives candidates. It takes samples as independent and
//! normal, which measured forces are not, so single outliers and slow wandering make candidates
//! too: only those stay that part regions which differ beyond doubt and by an amount that matters
//! (`contrast.rs`).

mod contrast;
mod refine;

use changepoint::rv::dist::NormalInvGamma;
use changepoint::utils::map_changepoints;
use changepoint::{BocpdLike, BocpdTruncated};

/// Expected samples between changes, λ of the hazard 1/λ. The detector drops run lengths that
/// together have less than 0.001 of the probability; a change that is just starting has 1/λ, so
/// from λ = 1000 on it is never looked at and the result is noise. The result depends on λ weakly.
const EXPECTED_RUN: f64 = 250.0;

/// The detector's work grows with the square of the number of samples it is given, so it gets the
/// signal in pieces of this many, whose ends are candidates like any other.
const PIECE: usize = 500;

/// Beyond this many samples the detector gets blocks of them, and the work grows no further.
const MOST_BLOCKS: usize = 4000;

/// Deviations of up to about this many σ are left alone, larger ones grow like the logarithm: no
/// outlier drowns the rest.
const LINEAR_SIGMAS: f64 = 5.0;

/// And none counts as more than this, which stands for some 140 σ.
const LARGEST: f64 = 20.0;

/// No region is shorter: fewer samples say nothing of a variance.
const SHORTEST_REGION: usize = 10;

/// A spread below this share of the level is rounding.
const ROUNDING: f64 = 1e-9;

/// Why no changes can be looked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChangepointError {
    /// The detector would answer "no change" to the rest of the signal.
    #[error("sample {index} is {value}; changepoints need finite numbers")]
    NotFinite {
        /// Place in the signal, from 0.
        index: usize,
        /// What is there.
        value: f64,
    },
}

/// Indices where a new region begins, without the first 0, increasing. Regions differ from their
/// neighbours in standard deviation (by a quarter at least) or in level (by a standard deviation
/// at least). Scale and offset of the signal do not matter; a constant signal and one shorter
/// than two regions have no changes. Takes about 0.1 s at most, however
/// long the signal.
///
/// # Errors
/// Where a sample is not finite.
pub fn changepoints(signal: &[f64]) -> Result<Vec<usize>, ChangepointError> {
    if let Some(index) = signal.iter().position(|value| !value.is_finite()) {
        let value = signal[index];
        return Err(ChangepointError::NotFinite { index, value });
    }
    let Some(standard) = standardised(signal) else {
        return Ok(Vec::new());
    };
    if signal.len() < 2 * SHORTEST_REGION {
        return Ok(Vec::new());
    }
    let changes = merge_short(&candidates(&standard), signal.len(), SHORTEST_REGION);
    let changes = contrast::distinct(&standard, changes);
    let changes = refine::refined(&standard, changes, SHORTEST_REGION);
    Ok(contrast::distinct(&standard, changes))
}

/// `changes` of a signal of `n` samples without those that bound a region of fewer than `minimum`:
/// the shortest region joins its shorter neighbour until none is too short or one is left.
pub fn merge_short(changes: &[usize], n: usize, minimum: usize) -> Vec<usize> {
    let mut bounds = vec![0];
    bounds.extend(changes.iter().copied().filter(|&at| at > 0 && at < n));
    bounds.push(n);
    let length = |bounds: &[usize], region: usize| bounds[region + 1] - bounds[region];
    while bounds.len() > 2 {
        let regions = bounds.len() - 1;
        let shortest = (0..regions).min_by_key(|&region| length(&bounds, region));
        let Some(shortest) = shortest.filter(|&region| length(&bounds, region) < minimum) else {
            break;
        };
        let joins_left = shortest + 1 == regions
            || shortest > 0 && length(&bounds, shortest - 1) < length(&bounds, shortest + 1);
        bounds.remove(if joins_left { shortest } else { shortest + 1 });
    }
    bounds.pop();
    bounds.remove(0);
    bounds
}

/// (x − median) / σ, with σ from the median absolute deviation, or from the mean one where more
/// than half of the samples are equal; large ones drawn in. None where all are equal.
fn standardised(signal: &[f64]) -> Option<Vec<f64>> {
    let level = contrast::median(signal.to_vec())?;
    let deviations: Vec<f64> = signal.iter().map(|x| (x - level).abs()).collect();
    let mean = deviations.iter().sum::<f64>() / deviations.len() as f64;
    let median = contrast::median(deviations)?;
    let sigma = [1.4826 * median, contrast::SIGMA_PER_MEAN_DEVIATION * mean]
        .into_iter()
        .find(|&sigma| sigma > ROUNDING * level.abs())?;
    let drawn_in = |x: &f64| {
        let large = LINEAR_SIGMAS * ((x - level) / (sigma * LINEAR_SIGMAS)).asinh();
        large.clamp(-LARGEST, LARGEST)
    };
    Some(signal.iter().map(drawn_in).collect())
}

/// Where the likeliest runs begin.
fn candidates(standard: &[f64]) -> Vec<usize> {
    let block = standard.len().div_ceil(MOST_BLOCKS);
    let blocks: Vec<f64> = standard.chunks(block).map(signed_size).collect();
    let mut changes = Vec::new();
    for (piece, blocks) in blocks.chunks(PIECE).enumerate() {
        let starts = runs(blocks).into_iter().map(|start| piece * PIECE + start);
        changes.extend(starts.map(|start| start * block));
    }
    changes
}

/// The root mean square of a block with the sign of its mean: the detector sees the variance of
/// every sample, not of every tenth.
fn signed_size(block: &[f64]) -> f64 {
    let square = block.iter().map(|x| x * x).sum::<f64>() / block.len() as f64;
    square.sqrt().copysign(block.iter().sum())
}

/// Starts of runs, 0 among them. Mean and variance of a run are unknown; their prior is worth one sample around
/// 0 with the signal's own variance, m = 0, v = 1, a = 1, b = 1 of the normal-inverse-gamma
/// distribution, which fits because the signal is standardised.
fn runs(signal: &[f64]) -> Vec<usize> {
    let prior = NormalInvGamma::new_unchecked(0.0, 1.0, 1.0, 1.0);
    let mut detector = BocpdTruncated::new(EXPECTED_RUN, prior);
    let (mut starts, mut first, mut lengths) = (Vec::new(), 0, Vec::<Vec<f64>>::new());
    for (index, sample) in signal.iter().enumerate() {
        let mut distribution = detector.step(sample).to_vec();
        if distribution.iter().any(|p| !p.is_finite()) {
            // So unlikely under every run that all probabilities are 0: a run starts here.
            starts.extend(map_changepoints(&lengths).iter().map(|at| first + at));
            (first, lengths) = (index, Vec::new());
            detector.reset();
            distribution = detector.step(sample).to_vec();
            starts.push(index);
        }
        lengths.push(distribution);
    }
    starts.extend(map_changepoints(&lengths).iter().map(|at| first + at));
    starts.sort_unstable();
    starts.dedup();
    starts
}
