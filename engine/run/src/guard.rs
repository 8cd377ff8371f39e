//! The guard around every driver: what it sees wrong ends in a ramped stop, and stays one.
//!
//! | trip | when |
//! |---|---|
//! | [`Trip::Driver`] | a call of the driver fails, or it gives what makes no sense (NaN, no unit quaternion) |
//! | [`Trip::DriverFault`] | the driver says that it is in a fault |
//! | [`Trip::Stale`] | the newest reading is older than [`STALE_PERIODS`] control periods |
//! | [`Trip::Force`] | the force is so high that a stop from the present speed would just keep `force_limit_n` |
//! | [`Trip::OffPath`] | the tool is more than [`OFF_PATH_M`] off the line or arc |
//! | [`Trip::Jump`] | the tool moved faster than the high speed allows |
//! | [`Trip::BeyondRange`] | it travelled further than the whole range |
//! | [`Trip::LostGrasp`], [`Trip::Held`] | next to nothing is felt, or the handle does not move ([`crate::grip`]) |
//! | [`Trip::Late`] | the controller itself came so late that the last command had run out |
//! | [`Trip::Silent`] | filter or policy give no sign of life |
//! | [`Trip::Interrupted`] | somebody asked to stop |
//! | [`Trip::Loop`] | a loop failed or panicked |
//! | [`Trip::Violation`] | a high-force action would have left the limits, §III-A.5 |

use std::fmt;

use nalgebra::Vector3;
use pubs_core::Task;
use pubs_core::controller::Control;
use pubs_core::joint::{Path, Pose};
use pubs_plugin::{DriverStatus, Reading, SAFETY_STOP, Twist};

use crate::arm::{Arm, ArmError};

/// Readings may be so many control periods old.
pub const STALE_PERIODS: f64 = 5.0;

/// A command lasts so many control periods; then the driver ramps to rest by itself.
pub const COMMAND_PERIODS: f64 = 5.0;

/// How far off the path the tool may be.
pub const OFF_PATH_M: f64 = 0.02;

/// Room beyond the range for the give of grasp and stops.
pub const RANGE_SLACK_M: f64 = 0.02;

/// Between two readings the tool may move this much faster than the high speed.
const JUMP_FACTOR: f64 = 2.0;
/// And this much further, for noise and the give of the arm.
const JUMP_SLACK_M: f64 = 0.005;

/// Why the guard stopped the arm.
#[derive(Debug, Clone, PartialEq)]
pub enum Trip {
    /// A call of the driver failed.
    Driver(String),
    /// The driver reports a fault.
    DriverFault,
    /// Readings stopped coming.
    Stale {
        /// Age of the newest, s.
        age_s: f64,
    },
    /// Force near the limit.
    Force {
        /// What was felt, N.
        force_n: f64,
        /// Where the guard acts at the present speed, N.
        trip_n: f64,
    },
    /// The tool left the path.
    OffPath {
        /// How far, m.
        deviation_m: f64,
    },
    /// The tool jumped.
    Jump {
        /// How far between two readings, m.
        moved_m: f64,
    },
    /// The tool travelled further than the joint can.
    BeyondRange {
        /// Since the grasp, m.
        travelled_m: f64,
    },
    /// Moving, next to nothing is felt.
    LostGrasp {
        /// What was felt on average, N.
        felt_n: f64,
        /// The least that the object is felt by, N.
        least_n: f64,
    },
    /// The handle does not move although it is pushed.
    Held {
        /// For how long, s.
        held_s: f64,
    },
    /// The controller came too late.
    Late {
        /// By how much, s.
        late_s: f64,
    },
    /// A loop gives no sign of life.
    Silent {
        /// Which one.
        name: &'static str,
        /// For how long, s.
        silent_s: f64,
    },
    /// Somebody asked to stop.
    Interrupted,
    /// A loop failed or panicked.
    Loop {
        /// Which one.
        name: &'static str,
        /// What it said.
        message: String,
    },
    /// A safety violation, judged by the true state.
    Violation {
        /// Name of the action.
        action: String,
    },
}

impl Trip {
    /// Whether something failed, rather than that somebody or something stopped the arm for safety.
    pub fn is_fault(&self) -> bool {
        match self {
            Self::Driver(message) => !message.contains(SAFETY_STOP),
            Self::DriverFault | Self::Loop { .. } => true,
            _ => false,
        }
    }
}

impl fmt::Display for Trip {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Driver(message) => write!(out, "the driver failed: {message}"),
            Self::DriverFault => write!(out, "the driver reports a fault"),
            Self::Stale { age_s } => write!(out, "the newest reading is {:.0} ms old", age_s * 1e3),
            Self::Force { force_n, trip_n } => {
                write!(
                    out,
                    "force {force_n:.1} N; at this speed the arm must stop at {trip_n:.1} N to keep force_limit_n"
                )
            }
            Self::OffPath { deviation_m } => {
                write!(
                    out,
                    "the tool is {:.1} mm off the path of the handle (lost grasp, or wrong radius or directions?)",
                    deviation_m * 1e3
                )
            }
            Self::Jump { moved_m } => write!(
                out,
                "the tool moved {:.1} mm between two readings",
                moved_m * 1e3
            ),
            Self::BeyondRange { travelled_m } => {
                write!(
                    out,
                    "the tool travelled {:.0} mm, further than the whole range (lost grasp, or wrong limits?)",
                    travelled_m * 1e3
                )
            }
            Self::LostGrasp { felt_n, least_n } => write!(
                out,
                "moving, the tool feels {felt_n:.1} N, and this object at least {least_n:.1} N (lost grasp?)"
            ),
            Self::Held { held_s } => write!(
                out,
                "the handle was pushed for {held_s:.1} s and has not moved (jammed, or wrong limits?)"
            ),
            Self::Late { late_s } => {
                write!(out, "the controller loop came {:.0} ms late", late_s * 1e3)
            }
            Self::Silent { name, silent_s } => write!(
                out,
                "no sign of life from the {name} loop for {:.0} ms",
                silent_s * 1e3
            ),
            Self::Interrupted => write!(out, "interrupted"),
            Self::Loop { name, message } => write!(out, "the {name} loop failed: {message}"),
            Self::Violation { action } => {
                write!(out, "safety violation: `{action}` would leave the limits")
            }
        }
    }
}

/// A driver that can only be used within its limits.
pub struct Guard {
    arm: Box<dyn Arm>,
    control: Control,
    range_m: f64,
    per_metre: f64,
    previous: Option<Reading>,
    trip: Option<Trip>,
    moving: Option<(Path, Pose, f64)>,
}

impl Guard {
    /// Wraps an arm for a task that has a controller.
    pub fn new(arm: Box<dyn Arm>, task: &Task, control: Control) -> Self {
        let per_metre = task.joint.per_metre();
        Self {
            arm,
            control,
            range_m: task.joint.range() / per_metre,
            per_metre,
            previous: None,
            trip: None,
            moving: None,
        }
    }

    /// Why the arm was stopped, if it was.
    pub fn tripped(&self) -> Option<&Trip> {
        self.trip.as_ref()
    }

    /// Stops for good; the first reason stays.
    pub fn trip(&mut self, reason: Trip) {
        self.trip.get_or_insert(reason);
    }

    /// Moves virtual time; a failure trips.
    pub fn advance_to(&mut self, time_ns: u64) {
        let result = self.arm.advance_to(time_ns);
        self.note(result);
    }

    /// The true joint state, for scoring.
    pub fn truth(&mut self) -> Option<f64> {
        self.arm.truth()
    }

    /// A checked reading; `None` where there is none that can be used, and then the guard has
    /// tripped.
    pub fn read(&mut self, now_ns: u64, path: Option<&Path>, speed_m_s: f64) -> Option<Reading> {
        let result = self.arm.read();
        let reading = self.note(result)?;
        if let Some(reason) = self.fault_of(&reading, now_ns, path, speed_m_s) {
            self.trip(reason);
        }
        self.previous = Some(reading);
        Some(reading)
    }

    fn fault_of(
        &self,
        reading: &Reading,
        now_ns: u64,
        path: Option<&Path>,
        speed_m_s: f64,
    ) -> Option<Trip> {
        if reading.status == DriverStatus::Fault {
            return Some(Trip::DriverFault);
        }
        let age_s = now_ns.saturating_sub(reading.time_ns) as f64 * 1e-9;
        if age_s > STALE_PERIODS / self.control.rate_hz {
            return Some(Trip::Stale { age_s });
        }
        let force_n = Vector3::from(reading.force_n).norm();
        let trip_n = self.control.force_limit_n - self.control.stop_overshoot_n(speed_m_s.abs());
        if force_n > trip_n {
            return Some(Trip::Force { force_n, trip_n });
        }
        self.jump(reading)
            .or_else(|| self.leaves_path(reading, path?))
    }

    fn jump(&self, reading: &Reading) -> Option<Trip> {
        let previous = self.previous.as_ref()?;
        let moved_m =
            (Vector3::from(reading.position_m) - Vector3::from(previous.position_m)).norm();
        let seconds = reading.time_ns.saturating_sub(previous.time_ns) as f64 * 1e-9;
        let allowed_m = JUMP_FACTOR * self.control.high_speed_m_s * seconds + JUMP_SLACK_M;
        (moved_m > allowed_m).then_some(Trip::Jump { moved_m })
    }

    fn leaves_path(&self, reading: &Reading, path: &Path) -> Option<Trip> {
        let pose = Pose::new(reading.position_m, reading.orientation_xyzw);
        let deviation_m = path.deviation_m(&pose);
        if deviation_m > OFF_PATH_M {
            return Some(Trip::OffPath { deviation_m });
        }
        let travelled_m = path.displacement(&pose).abs() / self.per_metre;
        (travelled_m > self.range_m + RANGE_SLACK_M).then_some(Trip::BeyondRange { travelled_m })
    }

    /// Commands a speed along the path; it is cut to the high speed. A failure trips.
    pub fn command(&mut self, path: &Path, pose: &Pose, speed_m_s: f64, now_ns: u64) {
        let limit = self.control.high_speed_m_s;
        let speed_m_s = if speed_m_s.is_finite() {
            speed_m_s.clamp(-limit, limit)
        } else {
            0.0
        };
        let (linear, angular) = path.velocity(pose, speed_m_s, 1.0 / self.control.rate_hz);
        let twist = Twist {
            linear_m_s: linear.into(),
            angular_rad_s: angular.into(),
        };
        let expires_ns = now_ns + (COMMAND_PERIODS * 1e9 / self.control.rate_hz) as u64;
        self.moving = (speed_m_s != 0.0).then(|| (path.clone(), *pose, speed_m_s));
        let result = self.arm.command(twist, expires_ns);
        self.note(result);
    }

    /// Tells the driver to come to rest by itself, whatever was commanded.
    pub fn stop(&mut self) {
        self.moving = None;
        let result = self.arm.stop();
        self.note(result);
    }

    fn note<T>(&mut self, result: Result<T, ArmError>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(error) => {
                self.trip(Trip::Driver(error.to_string()));
                None
            }
        }
    }
}

impl Drop for Guard {
    /// A guard that goes away while the arm moves, in a panic say, has the driver ramp it to rest.
    fn drop(&mut self) {
        if self.moving.is_some() {
            self.stop();
        }
    }
}
