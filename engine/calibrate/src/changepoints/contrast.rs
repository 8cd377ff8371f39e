//! Whether two neighbouring regions differ beyond doubt, and by an amount that matters.
//!
//! With m the median of a region and d = |x − m|, the mean D of d measures the spread: unlike the
//! variance it is hardly moved by an outlier. Two regions differ in spread where
//! L = ln(D₁/D₂) has L² > penalty · var L, var L = c₁/n₁' + c₂/n₂', with c the squared coefficient
//! of variation of d (π/2 − 1 for normal samples, more where an outlier makes D uncertain), and in
//! level where (m₁ − m₂)² > penalty · (σ₁²/n₁' + σ₂²/n₂'), m here the median of the samples next to
//! the boundary: a jump parts regions, a slope does not. Correlated samples count for fewer:
//! n' = n (1 − r)/(1 + r), r the correlation of successive samples within regions. This is Brown
//! and Forsythe's test, with a penalty for having searched the boundary; where samples are few, the
//! ratio t² of square and variance counts as ν ln(1 + t²/ν), ν = n₁' + n₂', as in a likelihood.

/// σ / D of a normal distribution, √(π/2).
pub(super) const SIGMA_PER_MEAN_DEVIATION: f64 = 1.253_314_137_315_500_1;

/// (σ_d / D)² of a normal distribution, π/2 − 1.
const NORMAL_VARIATION: f64 = std::f64::consts::FRAC_PI_2 - 1.0;

/// Spreads closer than this factor make no difference to a filter.
const SPREAD_FACTOR: f64 = 1.25;

/// Jumps below this many standard deviations are left to the mean curve.
const LEVEL_STEP: f64 = 1.0;

/// A jump shows within so many samples on either side.
const STEP_SAMPLES: usize = 30;

/// The penalty is this times ln n, as for a likelihood with three parameters a boundary (BIC).
const PARAMETERS: f64 = 3.0;

/// Correlation is believed up to here.
const STRONGEST_CORRELATION: f64 = 0.99;

/// A spread is never taken as smaller than this (the whole signal's is about 1).
const SMALLEST_SPREAD: f64 = 1e-3;

/// `changes` without the boundaries between regions that do not differ: the weakest goes first,
/// until all that are left hold.
pub(super) fn distinct(signal: &[f64], mut changes: Vec<usize>) -> Vec<usize> {
    let penalty = PARAMETERS * (signal.len() as f64).ln();
    loop {
        let strengths = strengths(signal, &changes);
        let weakest = (0..changes.len()).min_by(|&a, &b| strengths[a].total_cmp(&strengths[b]));
        match weakest.filter(|&boundary| strengths[boundary] < penalty) {
            None => return changes,
            Some(boundary) => changes.remove(boundary),
        };
    }
}

/// The middle value; the upper of two. None where there is none.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// How clearly each boundary parts its two regions, to be compared with the penalty; 0 where the
/// difference does not matter.
fn strengths(signal: &[f64], changes: &[usize]) -> Vec<f64> {
    let bounds: Vec<usize> = [0]
        .into_iter()
        .chain(changes.iter().copied())
        .chain([signal.len()])
        .collect();
    let regions: Vec<Region> = bounds
        .windows(2)
        .map(|ends| Region::of(&signal[ends[0]..ends[1]]))
        .collect();
    let level_share = independent_share(regions.iter().map(|region| &region.around_level));
    let spread_share = independent_share(regions.iter().map(|region| &region.around_spread));
    regions
        .windows(2)
        .map(|pair| {
            let spread = pair[0].spread_contrast(&pair[1], spread_share);
            spread.max(pair[0].level_contrast(&pair[1], level_share))
        })
        .collect()
}

/// (1 − r)/(1 + r), the share of samples that count as independent; r over all series together.
fn independent_share<'a>(series: impl Iterator<Item = &'a Vec<f64>>) -> f64 {
    let (mut products, mut squares) = (0.0, 0.0);
    for values in series {
        products += values.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
        squares += values.iter().map(|value| value * value).sum::<f64>();
    }
    let correlation = if squares > 0.0 {
        products / squares
    } else {
        0.0
    };
    let correlation = correlation.clamp(0.0, STRONGEST_CORRELATION);
    (1.0 - correlation) / (1.0 + correlation)
}

struct Region<'a> {
    samples: &'a [f64],
    /// D.
    spread: f64,
    /// c.
    variation: f64,
    /// (x − m) / D of each sample.
    around_level: Vec<f64>,
    /// (d − D) / D of each sample.
    around_spread: Vec<f64>,
}

impl<'a> Region<'a> {
    /// Of one sample at least.
    fn of(samples: &'a [f64]) -> Self {
        let count = samples.len() as f64;
        let level = level(samples);
        let mean = samples.iter().map(|x| (x - level).abs()).sum::<f64>() / count;
        let spread = mean.max(SMALLEST_SPREAD);
        let around_level: Vec<f64> = samples.iter().map(|x| (x - level) / spread).collect();
        let around_spread: Vec<f64> = around_level.iter().map(|x| x.abs() - 1.0).collect();
        let variation = around_spread.iter().map(|x| x * x).sum::<f64>() / count;
        Self {
            samples,
            spread,
            variation: variation.max(NORMAL_VARIATION),
            around_level,
            around_spread,
        }
    }

    fn spread_contrast(&self, after: &Self, share: f64) -> f64 {
        let ratio = (self.spread / after.spread).ln();
        if ratio.abs() < SPREAD_FACTOR.ln() {
            return 0.0;
        }
        let [before_count, after_count] = [self, after].map(|r| r.samples.len() as f64 * share);
        let variance = self.variation / before_count + after.variation / after_count;
        clarity(ratio * ratio / variance, before_count + after_count)
    }

    fn level_contrast(&self, after: &Self, share: f64) -> f64 {
        let before = &self.samples[self.samples.len().saturating_sub(STEP_SAMPLES)..];
        let behind = &after.samples[..after.samples.len().min(STEP_SAMPLES)];
        let step = level(before) - level(behind);
        let [own, others] = [self, after].map(|r| (SIGMA_PER_MEAN_DEVIATION * r.spread).powi(2));
        if step * step < LEVEL_STEP * LEVEL_STEP * 0.5 * (own + others) {
            return 0.0;
        }
        let [before_count, after_count] = [before, behind].map(|s| s.len() as f64 * share);
        let variance = own / before_count + others / after_count;
        clarity(step * step / variance, before_count + after_count)
    }
}

fn level(samples: &[f64]) -> f64 {
    median(samples.to_vec()).unwrap_or_default()
}

/// ν ln(1 + t²/ν).
fn clarity(square: f64, freedom: f64) -> f64 {
    freedom * (square / freedom).ln_1p()
}
