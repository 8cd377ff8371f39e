//! Pose of the tool in the base frame.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Tool in base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Tool origin, m.
    pub position: Vector3<f64>,
    /// Rotation from tool axes to base axes.
    pub orientation: UnitQuaternion<f64>,
}

impl Pose {
    /// From a position (m) and a quaternion (x, y, z, w), which is normalised.
    pub fn new(position_m: [f64; 3], [x, y, z, w]: [f64; 4]) -> Self {
        Self {
            position: Vector3::from(position_m),
            orientation: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
        }
    }
}
