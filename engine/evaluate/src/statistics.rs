//! Means and standard errors.

/// A normal variable is within so many standard deviations in 95 of 100 cases.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The 95 % interval of a share, `successes` of `trials` (one at least), after Wilson (1927): it
/// stays within [0, 1] and has a length where all or none succeed.
pub fn wilson_95(successes: u64, trials: u64) -> [f64; 2] {
    let count = trials as f64;
    let share = successes as f64 / count;
    let squared = NORMAL_95 * NORMAL_95;
    let centre = share + squared / (2.0 * count);
    let half = (share * (1.0 - share) * squared / count + (squared / (2.0 * count)).powi(2)).sqrt();
    [-1.0, 1.0].map(|side| ((centre + side * half) / (1.0 + squared / count)).clamp(0.0, 1.0))
}

/// Sums of a sample, joined in any grouping but added in one order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    count: u64,
    mean: f64,
    /// Sum of squared deviations from the mean (Welford, 1962).
    deviations: f64,
}

impl Sample {
    /// Adds one value.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.deviations += before * (value - self.mean);
    }

    /// Values so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; `None` of nothing.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Standard error of the mean, s/√n; `None` below two values.
    pub fn standard_error(&self) -> Option<f64> {
        let count = self.count as f64;
        (self.count > 1).then(|| (self.deviations / (count - 1.0) / count).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_standard_error_by_hand() {
        let mut sample = Sample::default();
        assert_eq!((sample.mean(), sample.standard_error()), (None, None));
        for value in [2.0, 4.0, 4.0, 6.0] {
            sample.add(value);
        }
        // Variance (4 + 0 + 0 + 4)/3, standard error √(8/3/4).
        assert_eq!(sample.mean(), Some(4.0));
        let error = sample.standard_error().unwrap_or(f64::NAN);
        assert!((error - (8.0_f64 / 12.0).sqrt()).abs() < 1e-12, "{error}");
        assert_eq!(sample.count(), 4);
    }

    /// Against SciPy's `binomtest(k, n).proportion_ci(method="wilson")`, and for 0 of 20 and 20 of
    /// 20 by hand: z²/(n + z²).
    #[test]
    fn wilson_against_known_values() {
        let cases = [
            (19, 20, [0.763_868_806_553_257_7, 0.991_118_551_199_204_4]),
            (20, 20, [0.838_874_841_947_180_4, 1.0]),
            (0, 20, [0.0, 0.161_125_158_052_819_4]),
            (16, 20, [0.583_982_567_748_106_4, 0.919_342_337_420_202]),
            (
                9958,
                10_000,
                [0.994_328_104_183_775_6, 0.996_891_123_031_861_4],
            ),
        ];
        for (successes, trials, expected) in cases {
            let found = wilson_95(successes, trials);
            for (found, expected) in found.into_iter().zip(expected) {
                let name = format!("{successes} of {trials}: {found} for {expected}");
                assert!((found - expected).abs() < 1e-12, "{name}");
            }
        }
    }
}
