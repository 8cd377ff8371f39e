//! Why the arm was brought to rest for good.

use pubs_plugin::SAFETY_STOP;

/// What kind of trouble it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultKind {
    /// The controller has stopped the arm, or says that it must not move: alarm, emergency stop,
    /// servo off, program stopped, contact.
    Safety,
    /// Something here: the arm does not follow, a posture without a way on, a breakdown.
    Driver,
    /// A link that could not be made again.
    Link,
}

/// A fault. It lasts until the driver is opened anew.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Fault {
    /// Kind.
    pub kind: FaultKind,
    /// In words, with the controller's own where it gave some.
    pub reason: String,
}

impl Fault {
    /// The controller's own stop.
    pub fn safety(reason: impl Into<String>) -> Self {
        Self {
            kind: FaultKind::Safety,
            reason: format!("{SAFETY_STOP}{}", reason.into()),
        }
    }

    /// Trouble of the driver's.
    pub fn driver(reason: impl Into<String>) -> Self {
        Self {
            kind: FaultKind::Driver,
            reason: reason.into(),
        }
    }

    /// A link that is gone.
    pub fn link(reason: impl Into<String>) -> Self {
        Self {
            kind: FaultKind::Link,
            reason: reason.into(),
        }
    }
}
