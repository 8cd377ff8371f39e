//! The joint of an object, its limits S = [s_min, s_max], and its path in space.

mod frame;
mod path;
mod pose;

pub use frame::MotionFrame;
pub use path::{Direction, Path};
pub use pose::Pose;

use nalgebra::Vector3;
use pubs_plugin::JointType;

/// What kind of joint, with what only that kind has.
#[derive(Debug, Clone, PartialEq)]
pub enum JointKind {
    /// A hinge; states in rad.
    Revolute {
        /// Hinge axis to handle, m.
        radius_m: f64,
        /// Where things are at the grasp.
        geometry: Geometry,
        /// Unit vector from the handle to the hinge axis, tool frame at the grasp.
        hinge_direction: Vector3<f64>,
    },
    /// A slide; states in m.
    Prismatic {
        /// Where things are at the grasp.
        geometry: Geometry,
    },
    /// A benchmark in plain numbers; no robot can move it.
    Abstract {
        /// Whether states are whole numbers.
        integer: bool,
    },
}

impl JointKind {
    /// The unit in which people read states, and how many of it are one of SI: degrees,
    /// centimetres, or plain numbers without a unit.
    pub fn shown_unit(&self) -> (&'static str, f64) {
        match self {
            Self::Revolute { .. } => ("deg", 1_f64.to_degrees()),
            Self::Prismatic { .. } => ("cm", 100.0),
            Self::Abstract { .. } => ("", 1.0),
        }
    }
}

/// Directions in the tool frame at the grasp, unit vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Along which the handle opens.
    pub opening_direction: Vector3<f64>,
    /// Against gravity.
    pub up_direction: Vector3<f64>,
    /// m_p is 1 where the handle moved more than this between two filter updates, m.
    pub motion_threshold_m: f64,
}

/// A single joint with one degree of freedom, §III-A.1.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Kind and geometry.
    pub kind: JointKind,
    /// s_min, the closed limit (rad, m or plain).
    pub lower: f64,
    /// s_max, the open limit (rad, m or plain).
    pub upper: f64,
    /// Where the state may be at first: the prior (rad, m or plain).
    pub start: (f64, f64),
}

impl Joint {
    /// s_max − s_min.
    pub fn range(&self) -> f64 {
        self.upper - self.lower
    }

    /// Whether `state` is in S.
    pub fn contains(&self, state: f64) -> bool {
        (self.lower..=self.upper).contains(&state)
    }

    /// The state at `fraction` of the range from closed to open.
    pub fn at_fraction(&self, fraction: f64) -> f64 {
        self.lower + fraction * self.range()
    }

    /// Whether states are whole numbers.
    pub fn is_integer(&self) -> bool {
        matches!(self.kind, JointKind::Abstract { integer: true })
    }

    /// Geometry at the grasp; `None` for an abstract joint.
    pub fn geometry(&self) -> Option<&Geometry> {
        match &self.kind {
            JointKind::Revolute { geometry, .. } | JointKind::Prismatic { geometry } => {
                Some(geometry)
            }
            JointKind::Abstract { .. } => None,
        }
    }

    /// Joint displacement per metre the handle travels: 1/radius for a hinge, else 1.
    pub fn per_metre(&self) -> f64 {
        match self.kind {
            JointKind::Revolute { radius_m, .. } => 1.0 / radius_m,
            JointKind::Prismatic { .. } | JointKind::Abstract { .. } => 1.0,
        }
    }

    /// Its kind, as plugins and recordings name it.
    pub fn joint_type(&self) -> JointType {
        match self.kind {
            JointKind::Revolute { .. } => JointType::Revolute,
            JointKind::Prismatic { .. } => JointType::Prismatic,
            JointKind::Abstract { .. } => JointType::Abstract,
        }
    }

    /// Unit of a state as it stands in files: `rad`, `m` or `1`.
    pub fn unit(&self) -> &'static str {
        match self.kind {
            JointKind::Revolute { .. } => "rad",
            JointKind::Prismatic { .. } => "m",
            JointKind::Abstract { .. } => "1",
        }
    }

    /// A state as a person reads it: degrees, centimetres or the plain number.
    pub fn display(&self, state: f64) -> String {
        match self.kind {
            JointKind::Revolute { .. } => format!("{:.1}°", state.to_degrees()),
            JointKind::Prismatic { .. } => format!("{:.1} cm", state * 100.0),
            JointKind::Abstract { .. } => format!("{state:.2}"),
        }
    }
}
