//! The force sensor before anything moves: tared, quiet and near zero, or the recording is refused.

use std::thread;
use std::time::Duration;

use pubs_core::controller::Control;
use pubs_run::Arm;
use serde::Serialize;

use super::RecordError;

/// For so many control periods the resting sensor is watched.
const READINGS: u64 = 50;

/// A baseline further off than this share of the force threshold is refused.
const OFF_SHARE: f64 = 0.5;

/// A baseline noisier than this share of the force threshold is refused.
const NOISE_SHARE: f64 = 0.1;

/// What the resting sensor shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Baseline {
    /// Mean force, tool axes, N.
    pub mean_n: [f64; 3],
    /// Standard deviation of each component, N.
    pub sd_n: [f64; 3],
}

/// How far off and how noisy a baseline may be, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaselineLimits {
    /// On the length of the mean force.
    pub off_n: f64,
    /// On the standard deviation of each component.
    pub noise_n: f64,
}

impl BaselineLimits {
    /// Half and a tenth of the threshold F_t: an offset shifts where safe mode stops by as much,
    /// and so does noise. The grasp may hold a closing door against its spring, hence not zero.
    pub fn of(control: &Control) -> Self {
        Self {
            off_n: OFF_SHARE * control.force_threshold_n,
            noise_n: NOISE_SHARE * control.force_threshold_n,
        }
    }
}

/// Tares the sensor, then watches it at rest.
///
/// # Errors
/// Where the driver fails, or the baseline is beyond `limits`.
pub(super) fn tared(
    arm: &mut dyn Arm,
    control: &Control,
    limits: &BaselineLimits,
    lockstep: bool,
) -> Result<Baseline, RecordError> {
    let period_ns = (1e9 / control.rate_hz) as u64;
    // Virtual time ends before the loops begin theirs, at one second.
    let wait = |arm: &mut dyn Arm, tick: u64| {
        if lockstep {
            return arm.advance_to(tick * period_ns.min(1_000_000_000 / (READINGS + 2)));
        }
        thread::sleep(Duration::from_nanos(period_ns));
        Ok(())
    };
    wait(arm, 1)?;
    arm.tare()?;
    let mut forces = Vec::with_capacity(READINGS as usize);
    for tick in 0..READINGS {
        wait(arm, tick + 2)?;
        forces.push(arm.read()?.force_n);
    }
    let baseline = Baseline::of(&forces);
    baseline.within(limits)?;
    Ok(baseline)
}

impl Baseline {
    fn of(forces_n: &[[f64; 3]]) -> Self {
        let count = forces_n.len() as f64;
        let mean = |axis: usize| forces_n.iter().map(|force| force[axis]).sum::<f64>() / count;
        let mean_n = [mean(0), mean(1), mean(2)];
        let sd = |axis: usize| {
            let squares = forces_n
                .iter()
                .map(|force| (force[axis] - mean_n[axis]).powi(2));
            (squares.sum::<f64>() / (count - 1.0)).sqrt()
        };
        Self {
            mean_n,
            sd_n: [sd(0), sd(1), sd(2)],
        }
    }

    fn within(&self, limits: &BaselineLimits) -> Result<(), RecordError> {
        let noise_n = self.sd_n.iter().copied().fold(0.0, f64::max);
        if noise_n > limits.noise_n {
            return Err(RecordError::Noisy {
                baseline: *self,
                limit_n: limits.noise_n,
            });
        }
        let off_n = self
            .mean_n
            .iter()
            .map(|mean| mean * mean)
            .sum::<f64>()
            .sqrt();
        if off_n > limits.off_n {
            return Err(RecordError::Off {
                baseline: *self,
                off_n,
                limit_n: limits.off_n,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_sd_by_hand_and_what_is_refused() {
        let baseline = Baseline::of(&[[1.0, 0.0, -2.0], [3.0, 0.0, -2.0]]);
        assert_eq!(baseline.mean_n, [2.0, 0.0, -2.0]);
        assert_eq!(baseline.sd_n, [2f64.sqrt(), 0.0, 0.0]);
        let cases = [(3.0, 1.5, "ok"), (2.8, 1.5, "off"), (3.0, 1.4, "noisy")];
        for (off_n, noise_n, expected) in cases {
            let found = match baseline.within(&BaselineLimits { off_n, noise_n }) {
                Ok(()) => "ok",
                Err(RecordError::Off { .. }) => "off",
                Err(RecordError::Noisy { .. }) => "noisy",
                Err(_) => "something else",
            };
            assert_eq!(found, expected, "limits {off_n} N off, {noise_n} N noise");
        }
    }
}
