//! The engine's frames and the controller's.
//!
//! The engine thinks of the tool in its own base. The controller thinks of the tool or of the
//! flange, as it is set up, in its base. Lengths are in m here.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use pubs_melfa_protocol::pose::quaternion_of;

use crate::params::{ControllerPose, Params};

/// What lies between the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// The controller's base in the engine's.
    base: Isometry3<f64>,
    /// The tool at whatever the controller's poses are of.
    tool: Isometry3<f64>,
}

fn isometry(position_m: [f64; 3], rotation_deg: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(position_m),
        quaternion_of(&rotation_deg.map(f64::to_radians)),
    )
}

impl Frames {
    /// As the parameters say.
    pub fn new(params: &Params) -> Self {
        let tool = match params.controller_pose {
            ControllerPose::Tool => Isometry3::identity(),
            ControllerPose::Flange => isometry(params.tool_position_m, params.tool_rotation_deg),
        };
        Self {
            base: isometry(params.base_position_m, params.base_rotation_deg),
            tool,
        }
    }

    /// The tool in the engine's base, from the controller's pose.
    pub fn to_engine(&self, controller: &Isometry3<f64>) -> Isometry3<f64> {
        self.base * controller * self.tool
    }

    /// The controller's pose, from the tool in the engine's base.
    pub fn to_controller(&self, tool: &Isometry3<f64>) -> Isometry3<f64> {
        self.base.inverse() * tool * self.tool.inverse()
    }

    /// A vector of the engine's base in the controller's.
    pub fn turned_to_controller(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.base.rotation.inverse() * vector
    }

    /// The tool origin in the controller's base.
    pub fn tool_origin(&self, tool: &Isometry3<f64>) -> Vector3<f64> {
        (self.base.inverse() * tool).translation.vector
    }
}

/// Position and quaternion (x, y, z, w) as readings have them.
pub fn parts(pose: &Isometry3<f64>) -> ([f64; 3], [f64; 4]) {
    let rotation: &UnitQuaternion<f64> = &pose.rotation;
    let q = rotation.as_ref();
    (pose.translation.vector.into(), [q.i, q.j, q.k, q.w])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_and_tool_are_put_on_in_their_order() {
        let mut params = Params {
            controller_pose: ControllerPose::Flange,
            tool_position_m: [0.0, 0.0, 0.1],
            base_position_m: [1.0, 0.0, 0.0],
            base_rotation_deg: [0.0, 0.0, 90.0],
            ..Params::default()
        };
        // A flange 0.5 m along the controller's x, looking down: the tool is 0.1 m below it, and the
        // controller's x is the engine's y.
        let flange = isometry([0.5, 0.0, 0.4], [180.0, 0.0, 0.0]);
        let tool = Frames::new(&params).to_engine(&flange);
        let expected = Vector3::new(1.0, 0.5, 0.3);
        assert!(
            (tool.translation.vector - expected).norm() < 1e-12,
            "{tool}"
        );
        let back = Frames::new(&params).to_controller(&tool);
        assert!((back.translation.vector - flange.translation.vector).norm() < 1e-12);
        assert!(back.rotation.angle_to(&flange.rotation) < 1e-12);

        params.controller_pose = ControllerPose::Tool;
        let tool = Frames::new(&params).to_engine(&flange);
        assert!(
            (tool.translation.vector.z - 0.4).abs() < 1e-12,
            "the tool is in it already"
        );
    }
}
