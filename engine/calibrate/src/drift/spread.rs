//! Standard errors from the spread between demonstrations.

use super::{Estimate, Sample};

/// The assumed spread between demonstrations counts as much as this many of them. With few, their
/// own spread may be small by chance.
const ASSUMED: f64 = 8.0;

/// Samples by demonstration.
pub(super) struct Demonstrations(Vec<Vec<Sample>>);

impl Demonstrations {
    pub(super) fn of(samples: &[Sample]) -> Self {
        let mut sorted = samples.to_vec();
        sorted.sort_by_key(|sample| sample.demonstration);
        let groups = sorted.chunk_by(|a, b| a.demonstration == b.demonstration);
        Self(groups.map(<[Sample]>::to_vec).collect())
    }

    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[Sample]> {
        self.0.iter().map(Vec::as_slice)
    }

    pub(super) fn samples(&self) -> impl Iterator<Item = &Sample> {
        self.0.iter().flatten()
    }

    /// Each with at most so many samples, evenly spaced.
    pub(super) fn thinned(&self, most: usize) -> Self {
        let thin = |samples: &Vec<Sample>| {
            let step = samples.len().div_ceil(most);
            samples.iter().step_by(step.max(1)).copied().collect()
        };
        Self(self.0.iter().map(thin).collect())
    }
}

/// How rarely a true value may be taken for a false one: standard normal deviations, two-sided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Doubt(f64);

impl Doubt {
    /// Once in a thousand.
    pub(super) const ONE: Self = Self(3.290_5);
    /// Once in ten thousand, for one of several regions.
    pub(super) const REGION: Self = Self(3.890_6);
}

/// The mean of one estimate for each demonstration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean {
    pub(super) value: f64,
    sd: f64,
    freedom: f64,
}

impl Mean {
    /// Of the estimates θ₁ … θ_D, one at least, where demonstrations are assumed to spread by
    /// σ_a: sd² = s²/D, s² = (ν_a σ_a² + Σ(θ − mean)²)/(ν_a + D − 1), which has ν_a + D − 1 degrees
    /// of freedom (a scaled inverse χ² prior on the variance).
    pub(super) fn of(estimates: &[f64], assumed_sd: f64) -> Self {
        let count = estimates.len() as f64;
        let value = estimates.iter().sum::<f64>() / count;
        let squares: f64 = estimates.iter().map(|own| (own - value).powi(2)).sum();
        let freedom = ASSUMED + count - 1.0;
        let variance = (ASSUMED * assumed_sd * assumed_sd + squares) / freedom;
        let sd = (variance / count).sqrt();
        Self { value, sd, freedom }
    }

    /// Whether it differs from `expected` beyond doubt (Student's t).
    pub(super) fn differs_from(&self, expected: f64, doubt: Doubt) -> bool {
        (self.value - expected).abs() > student(doubt.0, self.freedom) * self.sd
    }

    pub(super) fn estimate(&self) -> Estimate {
        Estimate {
            value: self.value,
            sd: self.sd,
        }
    }
}

/// The quantile of Student's t that belongs to the normal one `z` (expansion of Cornish and
/// Fisher; Abramowitz and Stegun 26.7.5): within 2 % from 8 degrees of freedom on.
fn student(z: f64, freedom: f64) -> f64 {
    let square = z * z;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
    ];
    let mut quantile = z;
    for (power, term) in (1..).zip(terms) {
        quantile += z * term / freedom.powi(power);
    }
    quantile
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_student() {
        // scipy.stats.t.ppf(1 - 0.0005, ν) and (1 - 0.00005, ν)
        let cases = [
            (Doubt::ONE, 12.0, 4.318),
            (Doubt::ONE, 8.0, 5.041),
            (Doubt::ONE, 23.0, 3.768),
            (Doubt::REGION, 8.0, 7.120),
            (Doubt::REGION, 23.0, 4.693),
        ];
        for (doubt, freedom, expected) in cases {
            let found = student(doubt.0, freedom);
            let off = (found / expected - 1.0).abs();
            assert!(off < 0.02, "{found} is not {expected} at {freedom}");
        }
    }

    #[test]
    fn the_error_of_a_mean_comes_from_the_spread_between_demonstrations() {
        // s² = (8 · 0.25 + 2)/(8 + 2), sd² = s²/3
        let mean = Mean::of(&[1.0, 2.0, 3.0], 0.5);
        assert!((mean.value - 2.0).abs() < 1e-12);
        assert!(
            (mean.sd - (0.4f64 / 3.0).sqrt()).abs() < 1e-12,
            "{}",
            mean.sd
        );
        // One demonstration: what is assumed.
        assert!((Mean::of(&[1.0], 0.5).sd - 0.5).abs() < 1e-12);
    }
}
