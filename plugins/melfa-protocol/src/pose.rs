//! Position data: three lengths, three angles, two extra axes and two words of flags.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Nearer than this to B = ±90°, where A and C turn about the same axis, A is taken as 0. The
/// rounding of a packet is less, so that a tool which points level keeps its A and C in packets.
const AT_RIGHT_ANGLE: f64 = 1e-6;

/// A pose as the controller has it, its numbers in the units and precision of the packets.
///
/// The orientation is `Rz(C) · Ry(B) · Rx(A)`: turns about the fixed axes X, Y, Z in this order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// X, Y, Z in mm.
    pub position_mm: [f32; 3],
    /// A, B, C in rad.
    pub angles_rad: [f32; 3],
    /// L1, L2: extra axes, mm or rad.
    pub extra: [f32; 2],
    /// First word of flags: which of the arm's postures; see [`crate::arm::posture`].
    pub posture: u32,
    /// Second word of flags: turns of each axis; see [`crate::arm::turns`].
    pub turns: u32,
}

impl Pose {
    /// From metres and a quaternion; extra axes and flags are zero.
    pub fn new(position_m: &Vector3<f64>, orientation: &UnitQuaternion<f64>) -> Self {
        Self {
            position_mm: (position_m * 1000.0).data.0[0].map(|value| value as f32),
            angles_rad: angles_of(orientation).map(|value| value as f32),
            ..Self::default()
        }
    }

    /// From a transform, with the flags given.
    pub fn from_isometry(pose: &Isometry3<f64>, posture: u32, turns: u32) -> Self {
        Self {
            posture,
            turns,
            ..Self::new(&pose.translation.vector, &pose.rotation)
        }
    }

    /// Position in m.
    pub fn position_m(&self) -> Vector3<f64> {
        Vector3::from(self.position_mm.map(f64::from)) / 1000.0
    }

    /// Orientation as a quaternion.
    pub fn orientation(&self) -> UnitQuaternion<f64> {
        quaternion_of(&self.angles_rad.map(f64::from))
    }

    /// Both as a transform, metres.
    pub fn isometry(&self) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::from(self.position_m()), self.orientation())
    }

    /// Whether no number in it is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        let numbers = [&self.position_mm[..], &self.angles_rad, &self.extra];
        numbers.concat().iter().all(|value| value.is_finite())
    }
}

/// A, B, C (rad) of an orientation: B in ±90°, A and C in ±180°. At B = ±90° only a sum of A and
/// C is determined, and A is 0.
pub fn angles_of(orientation: &UnitQuaternion<f64>) -> [f64; 3] {
    let matrix = orientation.to_rotation_matrix();
    let level = matrix[(0, 0)].hypot(matrix[(1, 0)]);
    let b = (-matrix[(2, 0)]).atan2(level);
    if level < AT_RIGHT_ANGLE {
        let b = FRAC_PI_2.copysign(b);
        return [0.0, b, (-matrix[(0, 1)]).atan2(matrix[(1, 1)])];
    }
    let a = matrix[(2, 1)].atan2(matrix[(2, 2)]);
    let c = matrix[(1, 0)].atan2(matrix[(0, 0)]);
    [a, b, c]
}

/// The orientation `Rz(C) · Ry(B) · Rx(A)` of A, B, C (rad).
pub fn quaternion_of(angles_rad: &[f64; 3]) -> UnitQuaternion<f64> {
    let [a, b, c] = *angles_rad;
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), c)
        * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), b)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Tool axes in the base, by hand: what R = Rz(C) Ry(B) Rx(A) does to x, y, z.
    #[test]
    fn angles_turn_about_fixed_x_then_y_then_z() {
        let cases = [
            ([FRAC_PI_2, 0.0, 0.0], [1, 0, 0], [0, 0, 1], [0, -1, 0]),
            ([0.0, FRAC_PI_2, 0.0], [0, 0, -1], [0, 1, 0], [1, 0, 0]),
            ([0.0, 0.0, FRAC_PI_2], [0, 1, 0], [-1, 0, 0], [0, 0, 1]),
            // The usual "tool looks down" of a MELFA: A = C = 180 degrees.
            ([PI, 0.0, PI], [-1, 0, 0], [0, 1, 0], [0, 0, -1]),
            // First x to x, y to z; then about z: x to y.
            ([FRAC_PI_2, 0.0, FRAC_PI_2], [0, 1, 0], [0, 0, 1], [1, 0, 0]),
        ];
        for (angles, x, y, z) in cases {
            let turn = quaternion_of(&angles);
            for (axis, image) in [(Vector3::x(), x), (Vector3::y(), y), (Vector3::z(), z)] {
                let found = turn * axis;
                let wanted = Vector3::from(image.map(f64::from));
                assert!(
                    (found - wanted).norm() < 1e-12,
                    "A, B, C = {angles:?}: {axis:?} goes to {found:?}, not {wanted:?}"
                );
            }
        }
    }

    #[test]
    fn angles_and_back_give_the_same_orientation_also_at_the_right_angle() {
        let mut cases = vec![];
        for a in [-3.0, -1.0, 0.0, 0.4, PI] {
            for b in [-FRAC_PI_2, -1.2, 0.0, 0.7, FRAC_PI_2, FRAC_PI_2 - 1e-7] {
                for c in [-2.5, 0.0, 1.5, PI] {
                    cases.push([a, b, c]);
                }
            }
        }
        for angles in cases {
            let orientation = quaternion_of(&angles);
            let found = angles_of(&orientation);
            let error = orientation.angle_to(&quaternion_of(&found));
            assert!(
                error < 2e-7,
                "{angles:?} came back as {found:?}, {error} rad off"
            );
            assert!(
                found[1].abs() <= FRAC_PI_2,
                "B = {} is beyond 90°",
                found[1]
            );
        }
    }

    #[test]
    fn right_angle_leaves_a_at_zero() {
        // Only C - A is determined at B = 90 degrees: 0.9 - 0.2.
        let found = angles_of(&quaternion_of(&[0.2, FRAC_PI_2, 0.9]));
        assert_eq!(found[0], 0.0, "A");
        assert!((found[2] - 0.7).abs() < 1e-9, "C = {}", found[2]);
    }

    #[test]
    fn angles_at_the_right_angle_stay_the_same_from_packet_to_packet() {
        let level = quaternion_of(&[0.0, -FRAC_PI_2, 2.618]);
        let first = Pose::new(&Vector3::zeros(), &level);
        let second = Pose::new(&Vector3::zeros(), &first.orientation());
        for (a, b) in first.angles_rad.iter().zip(second.angles_rad) {
            assert!((a - b).abs() < 1e-6, "{first:?} became {second:?}");
        }
    }

    #[test]
    fn metres_become_millimetres_and_come_back() {
        let position = Vector3::new(0.45, -0.0255, 0.38025);
        let orientation = quaternion_of(&[PI, 0.0, PI]);
        let pose = Pose::new(&position, &orientation);
        assert_eq!(pose.position_mm, [450.0, -25.5, 380.25]);
        assert!((pose.position_m() - position).norm() < 1e-7);
        assert!(pose.orientation().angle_to(&orientation) < 1e-6);
    }
}
