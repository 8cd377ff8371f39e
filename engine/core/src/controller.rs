//! The controller, eq. (12) and (13): actions to velocities.

use nalgebra::Vector3;

use crate::action::{Action, Mode, Motion};
use crate::joint::{Direction, Path, Pose};

/// Grasp and object sway for about so long after a change of speed, s. Until then the force is not
/// that of the steady motion which an observation model describes.
pub const SWAY_S: f64 = 0.1;

/// `[control]`: speeds, forces and accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// Commands per second.
    pub rate_hz: f64,
    /// v_safe.
    pub safe_speed_m_s: f64,
    /// v_high.
    pub high_speed_m_s: f64,
    /// F_t: safe mode stops above it.
    pub force_threshold_n: f64,
    /// No mode may exceed it; the guard stops in time.
    pub force_limit_n: f64,
    /// Bound on speeding up and on turning round.
    pub acceleration_m_s2: f64,
    /// Deceleration of every stop.
    pub stop_deceleration_m_s2: f64,
    /// Stiffness of grasp and object at a hard stop.
    pub contact_stiffness_n_per_m: f64,
}

impl Control {
    /// Speed of a mode, m/s.
    pub fn speed_m_s(&self, mode: Mode) -> f64 {
        match mode {
            Mode::Safe => self.safe_speed_m_s,
            Mode::HighForce => self.high_speed_m_s,
        }
    }

    /// [`stop_overshoot_n`] of this controller at `speed_m_s`.
    pub fn stop_overshoot_n(&self, speed_m_s: f64) -> f64 {
        let Self {
            rate_hz,
            stop_deceleration_m_s2,
            contact_stiffness_n_per_m,
            ..
        } = *self;
        stop_overshoot_n(
            speed_m_s,
            rate_hz,
            stop_deceleration_m_s2,
            contact_stiffness_n_per_m,
        )
    }

    /// v_s of eq. (13), signed along the path, positive towards open; `force_along_n` is
    /// F_ee · ξ_dir for the direction of the action.
    pub fn speed(&self, action: &Action, force_along_n: f64) -> f64 {
        match action.motion {
            Motion::Stop => 0.0,
            Motion::Move {
                mode: Mode::Safe, ..
            } if force_along_n > self.force_threshold_n => 0.0,
            Motion::Move { mode, .. } => action.sign() * self.speed_m_s(mode),
        }
    }

    /// How long after an order the forces are not those of steady motion, s: the ramp from `speed`
    /// to `target` (signed, m/s), then [`SWAY_S`].
    pub fn unsteady_s(&self, speed: f64, target: f64) -> f64 {
        let ramp_s = if speed * target < 0.0 {
            speed.abs() / self.stop_deceleration_m_s2 + target.abs() / self.acceleration_m_s2
        } else {
            (target - speed).abs() / self.acceleration_m_s2
        };
        if ramp_s == 0.0 { 0.0 } else { ramp_s + SWAY_S }
    }

    /// One control period's change of speed towards `target`: to rest, also to turn round, by the
    /// deceleration of a stop; from one speed to another by the acceleration.
    pub fn ramp(&self, speed: f64, target: f64) -> f64 {
        let braking = self.stop_deceleration_m_s2 / self.rate_hz;
        if speed * target < 0.0 {
            // Turning round: to rest first, so that the old direction is left quickly.
            return speed - speed.clamp(-braking, braking);
        }
        // Slowing down to go on is no stop: braking hard would set the object swaying.
        let step = if target == 0.0 {
            braking
        } else {
            self.acceleration_m_s2 / self.rate_hz
        };
        speed + (target - speed).clamp(-step, step)
    }
}

/// By how much the force still rises when the handle meets a hard stop at `speed_m_s`, N.
///
/// Two control periods pass before the ramp begins (the force arises just after one reading, is
/// seen by the next, and the command takes effect with the one after), then the handle
/// travels v²/2a: `stiffness · (v · 2 / rate + v² / (2 · deceleration))`.
pub fn stop_overshoot_n(
    speed_m_s: f64,
    rate_hz: f64,
    stop_deceleration_m_s2: f64,
    contact_stiffness_n_per_m: f64,
) -> f64 {
    let reaction_m = speed_m_s * 2.0 / rate_hz;
    let ramp_m = speed_m_s * speed_m_s / (2.0 * stop_deceleration_m_s2);
    contact_stiffness_n_per_m * (reaction_m + ramp_m)
}

/// F_ee · ξ_dir for an action's direction, N; 0 for stop.
pub fn force_along(path: &Path, pose: &Pose, action: &Action, force_tool: [f64; 3]) -> f64 {
    if action.is_stop() {
        return 0.0;
    }
    let direction = Direction::of(action.sign());
    (pose.orientation * Vector3::from(force_tool)).dot(&path.tangent(pose, direction))
}
