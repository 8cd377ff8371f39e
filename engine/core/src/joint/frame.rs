//! The three directions along which forces are told apart, §III-A.3.

use nalgebra::Vector3;

/// Orthonormal directions in the base frame: along the motion, up, and normal to both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionFrame {
    /// d: direction of the current motion.
    pub along: Vector3<f64>,
    /// z: up, made orthogonal to d.
    pub up: Vector3<f64>,
    /// n = z × d.
    pub normal: Vector3<f64>,
}

impl MotionFrame {
    /// From the direction of motion (unit) and an up direction that is not parallel to it.
    pub fn new(along: Vector3<f64>, up: Vector3<f64>) -> Self {
        let up = (up - along * along.dot(&up)).normalize();
        Self {
            along,
            up,
            normal: up.cross(&along),
        }
    }

    /// (f_d, f_z, f_n) of a force in the base frame, N.
    pub fn decompose(&self, force: &Vector3<f64>) -> [f64; 3] {
        [
            self.along.dot(force),
            self.up.dot(force),
            self.normal.dot(force),
        ]
    }
}
