//! The filter k times as fast as the policy, §IV-C and Fig. 4 (bottom).

use super::Task;
use crate::{Action, Motion};

/// A frequency that an object cannot have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FrequencyError {
    /// Less than once per policy step.
    #[error("the belief is updated at least once per policy step, not {0} times")]
    Zero(u32),
    /// The controller is the fastest loop.
    #[error(
        "{times} belief updates per policy step are {rate_hz} Hz, above the controller's {control_hz} Hz; raise control.rate_hz or ask for fewer"
    )]
    Controller {
        /// Updates per policy step.
        times: u32,
        /// What that makes.
        rate_hz: f64,
        /// control.rate_hz.
        control_hz: f64,
    },
    /// m_p would say that a moving handle stands still.
    #[error(
        "with {times} belief updates per policy step the handle moves {moved_m} m between two, which joint.motion_threshold_m = {threshold_m} counts as standing still; lower it or ask for fewer"
    )]
    Threshold {
        /// Updates per policy step.
        times: u32,
        /// Travel at the safe speed, m.
        moved_m: f64,
        /// joint.motion_threshold_m.
        threshold_m: f64,
    },
    /// No move can be carried out in so many parts.
    #[error(
        "no action of `{object}` can be carried out in {times} equal parts of whole states; ask for a number that divides a move"
    )]
    Indivisible {
        /// Name of the object.
        object: String,
        /// Parts asked for.
        times: u32,
    },
}

impl Task {
    /// The same task with the belief updated `times` times per policy step.
    ///
    /// On an arm every movement is observed so often. On an abstract object the large moves are:
    /// those longer than the shortest one, and on whole states those that `times` divides; the
    /// rest keep a single observation ("for large moves (action = ±10)", §IV-C).
    ///
    /// # Errors
    /// Where the object's rates, threshold or moves do not allow it.
    pub fn with_belief_frequency(mut self, times: u32) -> Result<Self, FrequencyError> {
        if times == 0 {
            return Err(FrequencyError::Zero(times));
        }
        if self.control.is_some() {
            self.set_arm_frequency(times)?;
        } else {
            self.set_large_moves(times)?;
        }
        Ok(self)
    }

    fn set_arm_frequency(&mut self, times: u32) -> Result<(), FrequencyError> {
        let rate_hz = self.policy.rate_hz * f64::from(times);
        let (Some(control), Some(geometry)) = (&self.control, self.joint.geometry()) else {
            return Ok(());
        };
        if rate_hz > control.rate_hz {
            return Err(FrequencyError::Controller {
                times,
                rate_hz,
                control_hz: control.rate_hz,
            });
        }
        let (moved_m, threshold_m) = (
            control.safe_speed_m_s / rate_hz,
            geometry.motion_threshold_m,
        );
        if moved_m <= threshold_m {
            return Err(FrequencyError::Threshold {
                times,
                moved_m,
                threshold_m,
            });
        }
        self.belief.rate_hz = rate_hz;
        for action in &mut self.actions {
            observe(action, times);
        }
        Ok(())
    }

    fn set_large_moves(&mut self, times: u32) -> Result<(), FrequencyError> {
        let length = |action: &Action| action.displacement().abs();
        let shortest = self.movements().map(|(_, action)| length(action));
        let shortest = shortest.fold(f64::INFINITY, f64::min);
        let integer = self.joint.is_integer();
        let divisible = |length: f64| !integer || (length / f64::from(times)).fract() == 0.0;
        let mut any = times == 1;
        for action in &mut self.actions {
            let length = length(action);
            let large = length > shortest && divisible(length);
            observe(action, if large { times } else { 1 });
            any |= large;
        }
        if any {
            return Ok(());
        }
        Err(FrequencyError::Indivisible {
            object: self.name.clone(),
            times,
        })
    }
}

fn observe(action: &mut Action, times: u32) {
    if let Motion::Move { observations, .. } = &mut action.motion {
        *observations = times;
    }
}
