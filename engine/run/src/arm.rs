//! What the loops need of a robot; every driver plugin gives it, and tests have their own.

use pubs_host::{DriverInstance, HostError};
use pubs_plugin::{Reading, Twist};

/// A driver that failed, in words for the user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ArmError(pub String);

impl From<HostError> for ArmError {
    fn from(error: HostError) -> Self {
        Self(error.to_string())
    }
}

/// An arm. The functions are those of [`pubs_plugin::Driver`].
pub trait Arm: Send {
    /// The newest measurement.
    ///
    /// # Errors
    /// Where the link is lost or the measurement makes no sense.
    fn read(&mut self) -> Result<Reading, ArmError>;

    /// Moves with `twist` until `expires_ns`.
    ///
    /// # Errors
    /// Where the robot refuses.
    fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), ArmError>;

    /// Takes the present wrench for zero. Only at rest and out of contact.
    ///
    /// # Errors
    /// Where the baseline is not quiet.
    fn tare(&mut self) -> Result<(), ArmError>;

    /// Ramps to rest.
    ///
    /// # Errors
    /// Where the robot cannot be told.
    fn stop(&mut self) -> Result<(), ArmError>;

    /// Moves virtual time forward.
    ///
    /// # Errors
    /// Where the driver has none.
    fn advance_to(&mut self, time_ns: u64) -> Result<(), ArmError>;

    /// The true joint state, for scoring alone.
    fn truth(&mut self) -> Option<f64>;
}

impl Arm for DriverInstance {
    fn read(&mut self) -> Result<Reading, ArmError> {
        Ok(Self::read(self)?)
    }

    fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), ArmError> {
        Ok(Self::command(self, twist, expires_ns)?)
    }

    fn tare(&mut self) -> Result<(), ArmError> {
        Ok(Self::tare(self)?)
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        Ok(Self::stop(self)?)
    }

    fn advance_to(&mut self, time_ns: u64) -> Result<(), ArmError> {
        Ok(Self::advance_to(self, time_ns)?)
    }

    fn truth(&mut self) -> Option<f64> {
        Self::truth(self).ok().flatten()
    }
}
