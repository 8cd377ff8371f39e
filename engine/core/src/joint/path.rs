//! The line or arc along which the handle can move, fixed in the base frame at the grasp.

use nalgebra::{Rotation3, Unit, Vector3};

use super::{Joint, JointKind, MotionFrame, Pose};

/// How fast a tool that is off the arc is drawn back to it: with a time constant of 0.2 s, slow
/// beside the sway of the grasp, so that the two do not excite each other.
const ARC_CORRECTION_PER_S: f64 = 5.0;

/// Below this speed the correction fades out, so that a resting arm rests.
const FULL_CORRECTION_SPEED_M_S: f64 = 0.02;

/// Which way along the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Towards s_max.
    Opening,
    /// Towards s_min.
    Closing,
}

impl Direction {
    /// +1 or −1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Opening => 1.0,
            Self::Closing => -1.0,
        }
    }

    /// The direction of a signed number; opening for 0.
    pub fn of(signed: f64) -> Self {
        if signed < 0.0 {
            Self::Closing
        } else {
            Self::Opening
        }
    }
}

#[derive(Debug, Clone)]
enum Shape {
    Line {
        opening: Vector3<f64>,
    },
    Arc {
        centre: Vector3<f64>,
        axis: Unit<Vector3<f64>>,
        radius_m: f64,
    },
}

/// The path of the handle, θ of eq. (12): for a hinge the axis and the centre of rotation, for a
/// slide the opening direction. Where on the path the grasp happened is what nobody knows.
#[derive(Debug, Clone)]
pub struct Path {
    shape: Shape,
    grasp: Vector3<f64>,
    up: Vector3<f64>,
}

impl Path {
    /// The path through the pose at the grasp; `None` for an abstract joint.
    ///
    /// axis = opening × hinge direction, centre = handle + radius · hinge direction.
    pub fn at_grasp(joint: &Joint, pose: &Pose) -> Option<Self> {
        let geometry = joint.geometry()?;
        let opening = pose.orientation * geometry.opening_direction;
        let shape = match &joint.kind {
            JointKind::Revolute {
                radius_m,
                hinge_direction,
                ..
            } => {
                let hinge = pose.orientation * hinge_direction;
                Shape::Arc {
                    centre: pose.position + hinge * *radius_m,
                    axis: Unit::new_normalize(opening.cross(&hinge)),
                    radius_m: *radius_m,
                }
            }
            JointKind::Prismatic { .. } => Shape::Line { opening },
            JointKind::Abstract { .. } => return None,
        };
        let up = pose.orientation * geometry.up_direction;
        Some(Self {
            shape,
            grasp: pose.position,
            up,
        })
    }

    /// Joint displacement from the grasp to `pose`, signed (rad or m): the change of angle about
    /// the centre, or the travel along the line.
    pub fn displacement(&self, pose: &Pose) -> f64 {
        match &self.shape {
            Shape::Line { opening } => opening.dot(&(pose.position - self.grasp)),
            Shape::Arc { centre, axis, .. } => {
                let from = self.grasp - centre;
                let to = pose.position - centre;
                axis.dot(&from.cross(&to))
                    .atan2(from.dot(&to) - axis.dot(&from) * axis.dot(&to))
            }
        }
    }

    /// How far the tool is off the line or arc, m.
    pub fn deviation_m(&self, pose: &Pose) -> f64 {
        match &self.shape {
            Shape::Line { opening } => {
                let travelled = pose.position - self.grasp;
                (travelled - opening * opening.dot(&travelled)).norm()
            }
            Shape::Arc {
                centre,
                axis,
                radius_m,
            } => {
                let arm = pose.position - centre;
                let height = axis.dot(&arm);
                let radial = (arm - axis.into_inner() * height).norm() - radius_m;
                radial.hypot(height)
            }
        }
    }

    /// Unit direction of motion at `pose`, base frame.
    pub fn tangent(&self, pose: &Pose, direction: Direction) -> Vector3<f64> {
        let opening = match &self.shape {
            Shape::Line { opening } => *opening,
            Shape::Arc { centre, axis, .. } => axis.cross(&(pose.position - centre)).normalize(),
        };
        opening * direction.sign()
    }

    /// The frame in which forces are told apart while moving in `direction`.
    pub fn frame(&self, pose: &Pose, direction: Direction) -> MotionFrame {
        MotionFrame::new(self.tangent(pose, direction), self.up)
    }

    /// Linear (m/s) and angular (rad/s) velocity of the tool for a signed speed along the path,
    /// positive towards open, held for `period_s`: the velocity ξ of eq. (12).
    ///
    /// On an arc the direction is that of the middle of the step, so that holding it stays on the
    /// arc to second order, and the tool is drawn back to the arc where it has left it.
    pub fn velocity(
        &self,
        pose: &Pose,
        speed_m_s: f64,
        period_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        match &self.shape {
            Shape::Line { opening } => (opening * speed_m_s, Vector3::zeros()),
            Shape::Arc {
                centre,
                axis,
                radius_m,
            } => {
                let arm = pose.position - centre;
                let level = arm - axis.into_inner() * axis.dot(&arm);
                let turn = speed_m_s / radius_m;
                let tangent = axis.cross(&level).normalize();
                let midway = Rotation3::from_axis_angle(axis, 0.5 * turn * period_s) * tangent;
                let off_arc = level.normalize() * (level.norm() - radius_m)
                    + axis.into_inner() * axis.dot(&arm);
                let moving = (speed_m_s.abs() / FULL_CORRECTION_SPEED_M_S).min(1.0);
                let linear = midway * speed_m_s - off_arc * (ARC_CORRECTION_PER_S * moving);
                (linear, axis.into_inner() * turn)
            }
        }
    }
}
