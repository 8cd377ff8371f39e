//! A robot arm, or something that behaves like one.

use crate::{DriverCheck, DriverSetup, PluginError};

/// Velocity of the tool: base axes at the tool origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Twist {
    /// Linear velocity, m/s.
    pub linear_m_s: [f64; 3],
    /// Angular velocity, rad/s.
    pub angular_rad_s: [f64; 3],
}

/// What the driver says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u32)]
pub enum DriverStatus {
    /// Following commands.
    #[default]
    Ready = 0,
    /// At rest or ramping to rest by itself, because the last command expired or it was told to.
    Stopped = 1,
    /// Not able to move until somebody has looked; `stop` and `close` still work.
    Fault = 2,
}

/// Begins the message of an error by which `read` or `command` tells that the robot's own safety
/// functions have stopped it: an emergency stop, an alarm, a contact. The run then ends as stopped
/// for safety, not as faulty.
pub const SAFETY_STOP: &str = "safety stop: ";

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Reading {
    /// When it was taken: the host's monotonic clock, or virtual time after `advance_to`.
    pub time_ns: u64,
    /// Tool origin in the base frame, m.
    pub position_m: [f64; 3],
    /// Tool orientation in the base frame, quaternion (x, y, z, w).
    pub orientation_xyzw: [f64; 4],
    /// Force exerted by the tool on the object, tool axes, tared, N.
    pub force_n: [f64; 3],
    /// Torque about the tool origin, tool axes, tared, N m.
    pub torque_nm: [f64; 3],
    /// Whether it follows commands.
    pub status: DriverStatus,
}

/// A driver. The engine calls it from one thread at a time, not always the same one.
///
/// It must come to rest by itself, by a ramp, when a command's expiry passes without another.
pub trait Driver: Send + Sized + 'static {
    /// The name an object file uses.
    const NAME: &'static str;
    /// The plugin's own version.
    const VERSION: &'static str;
    /// JSON Schema of `[driver] params`.
    const PARAMS_SCHEMA: &'static str;

    /// Connects; nothing moves yet.
    ///
    /// # Errors
    /// Where the parameters are wrong or the robot does not answer.
    fn open(setup: &DriverSetup) -> Result<Self, PluginError>;

    /// Looks at everything that `open` needs, in the order in which to mend it, and goes on after a
    /// check that failed where that makes sense. Nothing moves and nothing is changed. `None` where
    /// there is nothing to look at.
    ///
    /// # Errors
    /// Where the parameters are wrong; a robot that is not ready is a check that failed.
    fn diagnose(_setup: &DriverSetup) -> Result<Option<Vec<DriverCheck>>, PluginError> {
        Ok(None)
    }

    /// Names the force sensor, as `[source] sensor` of an object file does.
    fn sensor(&self) -> &str;

    /// The newest measurement; returns at once.
    ///
    /// # Errors
    /// Where the link is lost.
    fn read(&mut self) -> Result<Reading, PluginError>;

    /// Moves the tool with `twist` until `expires_ns` on the clock of [`Reading::time_ns`].
    ///
    /// # Errors
    /// Where the link is lost or the robot refuses.
    fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), PluginError>;

    /// Takes the present wrench for zero. Only at rest and out of contact.
    ///
    /// # Errors
    /// Where the baseline is not quiet.
    fn tare(&mut self) -> Result<(), PluginError>;

    /// Ramps to rest and stays there until the next `command`.
    ///
    /// # Errors
    /// Where the robot cannot be told.
    fn stop(&mut self) -> Result<(), PluginError>;

    /// Whether [`advance_to`](Self::advance_to) works. Without it the table leaves the function out.
    const VIRTUAL_TIME: bool = false;

    /// From the first call on, time stands still but for these calls.
    ///
    /// # Errors
    /// Where the driver has no virtual time or the time lies in the past.
    fn advance_to(&mut self, _time_ns: u64) -> Result<(), PluginError> {
        Err(PluginError::new("this driver lives in real time"))
    }

    /// The true joint state (rad or m), for scoring alone; `None` where nobody knows it.
    fn truth(&mut self) -> Option<f64> {
        None
    }
}
