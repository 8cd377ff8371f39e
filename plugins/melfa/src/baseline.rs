//! What the resting sensor shows, and whether it is fit to begin from.

use std::fmt;

use nalgebra::Vector3;

use crate::params::{Params, Zero};
use crate::wrench::Wrench;

/// Beyond this share of its range a sensor is saturated.
const SATURATED: f64 = 0.95;

/// Fewer samples tell no baseline.
const FEWEST: usize = 10;

/// Mean, noise and drift of a while at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Baseline {
    /// Mean wrench.
    pub mean: Wrench,
    /// Greatest standard deviation of a force component, N.
    pub noise_n: f64,
    /// Change of the mean force from the first half to the second, per second, N/s.
    pub drift_n_s: f64,
    /// Samples.
    pub count: usize,
}

/// What is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaselineLimits {
    /// Of a force that is taken for zero, N.
    pub load_n: f64,
    /// N.
    pub noise_n: f64,
    /// N/s.
    pub drift_n_s: f64,
    /// N.
    pub force_range_n: f64,
    /// N m.
    pub torque_range_nm: f64,
}

/// Why a baseline is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum BaselineFault {
    #[error(
        "only {count} samples came in {seconds:.2} s: is the sensor connected and the monitor's data type right (force_id)?"
    )]
    Few { count: usize, seconds: f64 },
    #[error(
        "the sensor is saturated: {size:.1} {unit} of {range} {unit}; take the load off it, or correct force_range_n and torque_range_nm"
    )]
    Saturated {
        size: f64,
        range: f64,
        unit: &'static str,
    },
    #[error(
        "the resting force is {size_n:.1} N, too much to be taken for zero (baseline_load_n = {limit_n}): take the load off, or let the controller compensate the gripper's weight"
    )]
    Loaded { size_n: f64, limit_n: f64 },
    #[error(
        "the resting force scatters by {noise_n:.2} N (baseline_noise_n = {limit_n}): keep the arm still, check cable and shield"
    )]
    Noisy { noise_n: f64, limit_n: f64 },
    #[error(
        "the resting force drifts by {drift_n_s:.2} N/s (baseline_drift_n_s = {limit_n_s}): let the sensor warm up, touch nothing"
    )]
    Drifting { drift_n_s: f64, limit_n_s: f64 },
}

impl BaselineLimits {
    /// As the parameters say.
    pub fn new(params: &Params) -> Self {
        Self {
            load_n: match params.zero {
                Zero::Resting => params.baseline_load_n,
                // The grasp may hold a door against its spring.
                Zero::Given => f64::INFINITY,
            },
            noise_n: params.baseline_noise_n,
            drift_n_s: params.baseline_drift_n_s,
            force_range_n: params.force_range_n,
            torque_range_nm: params.torque_range_nm,
        }
    }
}

impl Baseline {
    /// Of samples taken evenly over `seconds`.
    ///
    /// # Errors
    /// Where there are too few.
    pub fn of(samples: &[Wrench], seconds: f64) -> Result<Self, BaselineFault> {
        let count = samples.len();
        if count < FEWEST {
            return Err(BaselineFault::Few { count, seconds });
        }
        let mean = mean(samples);
        let squares: Vector3<f64> = samples
            .iter()
            .map(|sample| (sample.force - mean.force).map(|off| off * off))
            .sum();
        let (first, second) = samples.split_at(count / 2);
        let change = self::mean(second).force - self::mean(first).force;
        Ok(Self {
            mean,
            noise_n: (squares / (count - 1) as f64).map(f64::sqrt).max(),
            drift_n_s: change.norm() / (0.5 * seconds),
            count,
        })
    }

    /// Whether it is fit to begin from.
    ///
    /// # Errors
    /// The first thing that is not.
    pub fn check(&self, limits: &BaselineLimits) -> Result<(), BaselineFault> {
        let sides = [
            (self.mean.force.amax(), limits.force_range_n, "N"),
            (self.mean.torque.amax(), limits.torque_range_nm, "N m"),
        ];
        for (size, range, unit) in sides {
            if !matches!(size, size if size < SATURATED * range) {
                return Err(BaselineFault::Saturated { size, range, unit });
            }
        }
        let size_n = self.mean.force.norm();
        if !matches!(size_n, size if size <= limits.load_n) {
            let limit_n = limits.load_n;
            return Err(BaselineFault::Loaded { size_n, limit_n });
        }
        let Self {
            noise_n, drift_n_s, ..
        } = *self;
        if !matches!(noise_n, noise if noise <= limits.noise_n) {
            let limit_n = limits.noise_n;
            return Err(BaselineFault::Noisy { noise_n, limit_n });
        }
        if !matches!(drift_n_s, drift if drift <= limits.drift_n_s) {
            let limit_n_s = limits.drift_n_s;
            return Err(BaselineFault::Drifting {
                drift_n_s,
                limit_n_s,
            });
        }
        Ok(())
    }
}

impl fmt::Display for Baseline {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let f = &self.mean.force;
        write!(
            out,
            "force ({:.2}, {:.2}, {:.2}) N, noise {:.2} N, drift {:.2} N/s, {} samples",
            f.x, f.y, f.z, self.noise_n, self.drift_n_s, self.count
        )
    }
}

fn mean(samples: &[Wrench]) -> Wrench {
    let count = samples.len() as f64;
    Wrench {
        force: samples
            .iter()
            .map(|sample| sample.force)
            .sum::<Vector3<f64>>()
            / count,
        torque: samples
            .iter()
            .map(|sample| sample.torque)
            .sum::<Vector3<f64>>()
            / count,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const LIMITS: BaselineLimits = BaselineLimits {
        load_n: 20.0,
        noise_n: 0.5,
        drift_n_s: 2.0,
        force_range_n: 200.0,
        torque_range_nm: 4.0,
    };

    fn samples(force: impl Fn(usize) -> f64) -> Vec<Wrench> {
        (0..100)
            .map(|index| Wrench {
                force: Vector3::new(0.0, force(index), 0.0),
                torque: Vector3::new(0.0, 0.0, 0.5),
            })
            .collect()
    }

    #[test]
    fn numbers_by_hand() {
        // ±1 in turn: mean 0, standard deviation √(100/99). A line 0 to 0.99: its halves have means
        // 0.245 and 0.745, half a second apart.
        let turns = Baseline::of(
            &samples(|index| if index % 2 == 0 { 1.0 } else { -1.0 }),
            1.0,
        );
        let turns = turns.unwrap();
        assert!(
            (turns.noise_n - (100.0f64 / 99.0).sqrt()).abs() < 1e-12,
            "{turns:?}"
        );
        assert!(
            turns.drift_n_s < 1e-12 && turns.mean.force.norm() < 1e-12,
            "{turns:?}"
        );
        let line = Baseline::of(&samples(|index| index as f64 * 0.01), 1.0).unwrap();
        assert!((line.drift_n_s - 1.0).abs() < 1e-12, "{line:?}");
        assert_eq!(line.mean.torque.z, 0.5);
    }

    #[test]
    fn what_is_not_quiet_is_refused() {
        let found = |force: &dyn Fn(usize) -> f64| {
            let baseline = Baseline::of(&samples(force), 1.0).unwrap();
            baseline.check(&LIMITS)
        };
        assert_eq!(found(&|_| 12.0), Ok(()));
        let loaded = found(&|_| -21.0);
        assert!(
            matches!(loaded, Err(BaselineFault::Loaded { .. })),
            "{loaded:?}"
        );
        let noisy = found(&|index| if index % 2 == 0 { 1.0 } else { -1.0 });
        assert!(
            matches!(noisy, Err(BaselineFault::Noisy { .. })),
            "{noisy:?}"
        );
        // 0.012 N per sample would scatter by 0.35 N, below the limit, but it is 1.2 N/s.
        let drifting = found(&|index| index as f64 * 0.012 * 1.2);
        assert_eq!(drifting, Ok(()));
        let baseline = Baseline::of(&samples(|index| index as f64 * 0.012), 0.3).unwrap();
        let drifting = baseline.check(&LIMITS);
        assert!(
            matches!(drifting, Err(BaselineFault::Drifting { .. })),
            "{drifting:?}"
        );
        let saturated = found(&|_| -199.0);
        assert!(
            matches!(saturated, Err(BaselineFault::Saturated { .. })),
            "{saturated:?}"
        );
        assert!(found(&|_| f64::NAN).is_err(), "NaN was taken");
        let few = Baseline::of(&samples(|_| 0.0)[..5], 1.0);
        assert!(
            matches!(few, Err(BaselineFault::Few { count: 5, .. })),
            "{few:?}"
        );
    }
}
