//! From the sensor's six numbers to the wrench by the tool on the object, tool axes at the tool
//! origin.

use nalgebra::{UnitQuaternion, Vector3};
use pubs_melfa_protocol::pose::quaternion_of;

use crate::params::{Params, SignedAxis};

/// Force (N) and torque (N m).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// N.
    pub force: Vector3<f64>,
    /// N m.
    pub torque: Vector3<f64>,
}

impl Wrench {
    /// This without `offset`.
    pub fn without(&self, offset: &Self) -> Self {
        Self {
            force: self.force - offset.force,
            torque: self.torque - offset.torque,
        }
    }

    /// Whether every number is one.
    pub fn is_finite(&self) -> bool {
        self.force
            .iter()
            .chain(self.torque.iter())
            .all(|value| value.is_finite())
    }
}

/// How the sensor sits.
///
/// A map of signed axes is a rotation, or a rotation of all axes negated: then the sensor tells
/// what the object does to the tool. Either way force and torque change alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounting {
    axes: [SignedAxis; 3],
    rotation: UnitQuaternion<f64>,
    position_m: Vector3<f64>,
}

impl Mounting {
    /// As the parameters say.
    pub fn new(params: &Params) -> Self {
        Self {
            axes: params.sensor_axes,
            rotation: quaternion_of(&params.sensor_rotation_deg.map(f64::to_radians)),
            position_m: params.sensor_position_m.into(),
        }
    }

    /// At the tool: torque about the tool origin is that about the sensor's and r × F, with r from
    /// the tool origin to the sensor's.
    pub fn at_tool(&self, raw: &Wrench) -> Wrench {
        let turned = |vector: &Vector3<f64>| {
            self.rotation * Vector3::from(self.axes.map(|axis| axis.of(vector)))
        };
        let force = turned(&raw.force);
        Wrench {
            force,
            torque: turned(&raw.torque) + self.position_m.cross(&force),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Name; axes, rotation (deg) and position (m) of the sensor; force and torque at the tool.
    type Case = (
        &'static str,
        [&'static str; 3],
        [f64; 3],
        [f64; 3],
        [f64; 3],
        [f64; 3],
    );

    #[test]
    fn axes_rotation_and_shift_by_hand() {
        let raw = Wrench {
            force: Vector3::new(1.0, 2.0, 3.0),
            torque: Vector3::new(0.1, 0.2, 0.3),
        };
        let cases: [Case; 4] = [
            (
                "as it is",
                ["x", "y", "z"],
                [0.0; 3],
                [0.0; 3],
                [1.0, 2.0, 3.0],
                [0.1, 0.2, 0.3],
            ),
            // What the object does to the tool: all negated.
            (
                "reaction",
                ["-x", "-y", "-z"],
                [0.0; 3],
                [0.0; 3],
                [-1.0, -2.0, -3.0],
                [-0.1, -0.2, -0.3],
            ),
            // A quarter turn about z takes x to y and y to -x.
            (
                "turned",
                ["x", "y", "z"],
                [0.0, 0.0, 90.0],
                [0.0; 3],
                [-2.0, 1.0, 3.0],
                [-0.2, 0.1, 0.3],
            ),
            // The sensor 0.1 m behind the tool origin: r × F = (0, 0, -0.1) × (1, 2, 3) = (0.2, -0.1, 0).
            (
                "shifted",
                ["x", "y", "z"],
                [0.0; 3],
                [0.0, 0.0, -0.1],
                [1.0, 2.0, 3.0],
                [0.3, 0.1, 0.3],
            ),
        ];
        for (name, axes, rotation, position, force, torque) in cases {
            let params = Params {
                sensor_axes: axes.map(|axis| SignedAxis::named(axis).unwrap()),
                sensor_rotation_deg: rotation,
                sensor_position_m: position,
                ..Params::default()
            };
            let found = Mounting::new(&params).at_tool(&raw);
            assert!(
                (found.force - Vector3::from(force)).norm() < 1e-12,
                "{name}: {found:?}"
            );
            assert!(
                (found.torque - Vector3::from(torque)).norm() < 1e-12,
                "{name}: {found:?}"
            );
        }
    }
}
