//! Bins of one reading.

/// Bins of equal width whose outer two are open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    first_centre: f64,
    width: f64,
    count: usize,
}

impl Bins {
    /// `count` bins whose outer centres are at `from` and `to`.
    pub fn between(from: f64, to: f64, count: usize) -> Self {
        let count = count.max(1);
        if count == 1 || from >= to {
            return Self {
                first_centre: from,
                width: 1.0,
                count: 1,
            };
        }
        Self {
            first_centre: from,
            width: (to - from) / (count - 1) as f64,
            count,
        }
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The bin of a value; what is not a number falls into the first.
    pub fn place(&self, value: f64) -> usize {
        let place = ((value - self.first_centre) / self.width + 0.5).floor();
        place.clamp(0.0, (self.count - 1) as f64) as usize
    }

    /// Probabilities of all bins for N(mean, sigma²).
    pub fn normal(&self, mean: f64, sigma: f64) -> Vec<f64> {
        let below = |edge: usize| {
            let value = self.first_centre + (edge as f64 - 0.5) * self.width;
            0.5 * libm::erfc((mean - value) / (sigma * std::f64::consts::SQRT_2))
        };
        let mut from = 0.0;
        (1..=self.count)
            .map(|edge| {
                let to = if edge == self.count { 1.0 } else { below(edge) };
                let share = to - from;
                from = to;
                share
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_fall_into_the_nearest_centre_and_beyond_the_ends_into_the_outer_bins() {
        let bins = Bins::between(-2.0, 2.0, 5);
        let cases = [
            (-9.0, 0),
            (-1.51, 0),
            (-1.49, 1),
            (0.4, 2),
            (0.6, 3),
            (7.0, 4),
            (f64::NAN, 0),
        ];
        for (value, expected) in cases {
            assert_eq!(bins.place(value), expected, "{value}");
        }
    }

    #[test]
    fn probabilities_are_those_of_the_normal_distribution() {
        // scipy.stats.norm(0.3, 0.8): differences of cdf at -1.5, -0.5, 0.5, 1.5.
        let expected = [
            0.012_224_472_655,
            0.146_430_781_276,
            0.440_051_071_751,
            0.334_486_473_048,
            0.066_807_201_269,
        ];
        let found = Bins::between(-2.0, 2.0, 5).normal(0.3, 0.8);
        for (bin, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert!(
                (found - expected).abs() < 1e-9,
                "bin {bin}: {found}, expected {expected}"
            );
        }
        let sum: f64 = found.iter().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn a_single_bin_holds_everything() {
        for bins in [Bins::between(0.0, 1.0, 1), Bins::between(3.0, 3.0, 9)] {
            assert_eq!((bins.count(), bins.place(99.0)), (1, 0));
            assert_eq!(bins.normal(5.0, 2.0), [1.0]);
        }
    }
}
