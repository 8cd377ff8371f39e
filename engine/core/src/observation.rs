//! The observation o = [f_d, f_z, f_n, m_p] of an arm, §III-A.3.

use nalgebra::Vector3;

use crate::joint::{Direction, Path, Pose};

/// Names of an arm's channels, in no particular order; a model chooses among them.
pub const ARM_CHANNELS: [&str; 4] = ["f_d", "f_z", "f_n", "m_p"];

/// Forces along the frame of the motion, N, and whether the handle moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmObservation {
    /// Along the direction of motion; resistance is positive.
    pub f_d: f64,
    /// Up.
    pub f_z: f64,
    /// Along z × d.
    pub f_n: f64,
    /// m_p: whether the handle moved more than the threshold since the last filter update.
    pub moved: bool,
}

impl ArmObservation {
    /// Decomposes a wrench's force (tool axes, by the tool on the object) at `pose`.
    pub fn new(
        path: &Path,
        pose: &Pose,
        direction: Direction,
        force_tool: [f64; 3],
        moved: bool,
    ) -> Self {
        let force = pose.orientation * Vector3::from(force_tool);
        let [f_d, f_z, f_n] = path.frame(pose, direction).decompose(&force);
        Self {
            f_d,
            f_z,
            f_n,
            moved,
        }
    }

    /// The value of a channel by its name; `None` for a name no arm has.
    pub fn channel(&self, name: &str) -> Option<f32> {
        match name {
            "f_d" => Some(self.f_d as f32),
            "f_z" => Some(self.f_z as f32),
            "f_n" => Some(self.f_n as f32),
            "m_p" => Some(if self.moved { 1.0 } else { 0.0 }),
            _ => None,
        }
    }
}
