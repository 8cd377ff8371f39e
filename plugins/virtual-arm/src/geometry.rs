//! Where the handle is: frames of a joint in the base, and the way its handle truly goes.

use nalgebra::{UnitQuaternion, Vector3};

use crate::world::{Deviation, Joint};

/// The joint in the base frame.
#[derive(Debug, Clone)]
pub struct Geometry {
    radius_m: Option<f64>,
    /// Base frame with the joint at zero; columns along the path, lateral, vertical.
    axes: [Vector3<f64>; 3],
    hinge_axis: Vector3<f64>,
    handle_m: Vector3<f64>,
    orientation: UnitQuaternion<f64>,
    path: [Deviation; 2],
}

/// The handle at one position of the joint.
#[derive(Debug, Clone, Copy)]
pub struct HandleFrame {
    /// Base frame: along the path towards open, lateral (away from the hinge), vertical.
    pub axes: [Vector3<f64>; 3],
    /// Where the handle truly is, base frame, m.
    pub position_m: Vector3<f64>,
    /// How the handle moves per metre of its way, in `axes`.
    pub slope: Vector3<f64>,
    /// The tool's orientation were the grasp at ease.
    pub orientation: UnitQuaternion<f64>,
    /// Turn of the handle per metre of its way, base frame, rad/m.
    pub turn: Vector3<f64>,
}

impl HandleFrame {
    /// Components of a base vector along the frame's axes.
    pub fn local(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.axes[0].dot(vector),
            self.axes[1].dot(vector),
            self.axes[2].dot(vector),
        )
    }

    /// The base vector with these components.
    pub fn base(&self, local: &Vector3<f64>) -> Vector3<f64> {
        self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }
}

impl Geometry {
    /// Lays the joint out in the base frame.
    pub fn new(joint: &Joint, path: [Deviation; 2]) -> Self {
        let orientation = joint.closed_orientation;
        let along = joint.opening;
        let (lateral, vertical) = match joint.hinge {
            Some(hinge) => {
                let lateral = -(hinge - along * hinge.dot(&along)).normalize();
                let vertical = along.cross(&lateral);
                (lateral, vertical * vertical.dot(&joint.up).signum())
            }
            None => {
                let vertical = (joint.up - along * joint.up.dot(&along)).normalize();
                (vertical.cross(&along), vertical)
            }
        };
        Self {
            radius_m: joint.radius_m,
            axes: [along, lateral, vertical].map(|axis| orientation * axis),
            // Axis = opening × hinge direction, and the hinge lies opposite to lateral.
            hinge_axis: orientation * lateral.cross(&along),
            handle_m: joint.closed_position_m,
            orientation,
            path,
        }
    }

    /// The handle when it has gone `x_m` from the zero of the joint.
    pub fn handle(&self, x_m: f64) -> HandleFrame {
        let (lateral, lateral_slope) = self.path[0].at(x_m);
        let (vertical, vertical_slope) = self.path[1].at(x_m);
        let [along, outward, upward] = self.axes;
        let Some(radius) = self.radius_m else {
            return HandleFrame {
                axes: self.axes,
                position_m: self.handle_m + along * x_m + outward * lateral + upward * vertical,
                slope: Vector3::new(1.0, lateral_slope, vertical_slope),
                orientation: self.orientation,
                turn: Vector3::zeros(),
            };
        };
        let angle = x_m / radius;
        let (sine, cosine) = angle.sin_cos();
        let along_now = along * cosine - outward * sine;
        let outward_now = outward * cosine + along * sine;
        let centre = self.handle_m - outward * radius;
        HandleFrame {
            axes: [along_now, outward_now, upward],
            position_m: centre + outward_now * (radius + lateral) + upward * vertical,
            slope: Vector3::new(1.0 + lateral / radius, lateral_slope, vertical_slope),
            orientation: self.turn_by(angle) * self.orientation,
            turn: self.hinge_axis / radius,
        }
    }

    /// Tool position at the grasp: on the ideal line or arc, so that the path's deviation loads
    /// the grasp as a function of the joint state alone.
    pub fn ideal_position_m(&self, x_m: f64) -> Vector3<f64> {
        let straight = Self {
            path: [Deviation::NONE; 2],
            ..self.clone()
        };
        straight.handle(x_m).position_m
    }

    fn turn_by(&self, angle: f64) -> UnitQuaternion<f64> {
        let half = 0.5 * angle;
        let (sine, cosine) = half.sin_cos();
        let vector = self.hinge_axis * sine;
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(
            cosine, vector.x, vector.y, vector.z,
        ))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::world::World;

    /// door2 worked out by hand: tool x = base y, tool y = base z, tool z = base x; so it opens
    /// towards base -x, its hinge is 0.32 m towards base +y, and its axis points down.
    #[test]
    fn door2_opens_towards_the_robot_about_a_hinge_on_the_left() {
        let world = World::load("door2").unwrap();
        let geometry = Geometry::new(&world.joint, [Deviation::NONE; 2]);

        let close = |found: Vector3<f64>, x: f64, y: f64, z: f64, what: &str| {
            assert!(
                (found - Vector3::new(x, y, z)).norm() < 1e-12,
                "{what}: {found:?}"
            );
        };
        close(geometry.hinge_axis, 0.0, 0.0, -1.0, "axis");
        let closed = geometry.handle(0.0);
        close(
            closed.axes[0],
            -1.0,
            0.0,
            0.0,
            "opening direction when closed",
        );
        close(closed.axes[1], 0.0, -1.0, 0.0, "outward when closed");
        close(closed.axes[2], 0.0, 0.0, 1.0, "upward");
        let square = geometry.handle(0.32 * std::f64::consts::FRAC_PI_2);
        close(square.position_m, 0.43, 0.17, 0.60, "handle at 90 degrees");
        close(
            square.axes[0],
            0.0,
            1.0,
            0.0,
            "opening direction at 90 degrees",
        );
        close(
            square.orientation * Vector3::z(),
            0.0,
            -1.0,
            0.0,
            "tool z at 90 degrees",
        );
    }

    #[test]
    fn slope_is_the_derivative_of_the_handles_position() {
        let world = World::load("door2").unwrap();
        let geometry = Geometry::new(&world.joint, world.path);
        for x in [0.0, 0.1, 0.4, 0.69] {
            let h = 1e-6;
            let difference =
                (geometry.handle(x + h).position_m - geometry.handle(x - h).position_m) / (2.0 * h);
            let frame = geometry.handle(x);
            let error = (difference - frame.base(&frame.slope)).norm();
            assert!(error < 1e-8, "at {x} m the slope is off by {error}");
        }
    }
}
