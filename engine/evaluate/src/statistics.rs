//! Means and standard errors.

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
}
