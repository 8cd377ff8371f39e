//! The RV-5AS-D: its dimensions, limits and kinematics.
//!
//! Dimensions and limits as in the manufacturer's public robot description. All joint frames are
//! parallel at zero, where the arm stands straight up. Metres and radians; the flange is the last
//! frame, without any tool.

mod inverse;
mod kinematics;

pub use inverse::{ReachError, Singularity, inverse, inverse_with_posture};
pub use kinematics::{forward, jacobian};

use std::f64::consts::{PI, TAU};

/// Height of the shoulder, axis of J2, over the base, m.
pub const SHOULDER_M: f64 = 0.254;
/// Shoulder to elbow, axes of J2 and J3, m.
pub const UPPER_ARM_M: f64 = 0.410;
/// Elbow to wrist, axes of J3 and J5, m.
pub const FOREARM_M: f64 = 0.500;
/// Wrist to flange, m.
pub const HAND_M: f64 = 0.125;

/// Every joint moves within plus and minus this, rad.
pub const RANGE_RAD: [f64; 6] = [
    240.0 / 180.0 * PI,
    148.0 / 180.0 * PI,
    150.0 / 180.0 * PI,
    200.0 / 180.0 * PI,
    120.0 / 180.0 * PI,
    200.0 / 180.0 * PI,
];

/// Greatest speed of every joint, rad/s.
pub const SPEED_RAD_S: [f64; 6] = [2.16421, 2.16421, 2.16421, 3.4383, 6.21337, TAU];

/// Greatest acceleration of every joint, rad/s²: a setting of the public description, not a
/// property of the arm.
pub const ACCELERATION_RAD_S2: [f64; 6] = [6.0, 6.0, 6.0, 9.0, 18.0, 18.0];

/// The first joint out of its range, as its index from 0.
pub fn out_of_range(joints: &[f64; 6]) -> Option<usize> {
    // Written so that NaN is out of range.
    (0..6).find(|&index| !matches!(joints[index].abs(), size if size <= RANGE_RAD[index]))
}

/// Posture bit: the wrist is in front of the shoulder's axis ("right").
pub const RIGHT: u32 = 4;
/// Posture bit: the elbow is bent forwards ("above").
pub const ABOVE: u32 = 2;
/// Posture bit: J5 is not negative ("non-flip").
pub const NON_FLIP: u32 = 1;

/// First word of flags of a position: which posture the arm has. The values of the bits are known;
/// which posture each names is inferred.
pub fn posture(joints: &[f64; 6]) -> u32 {
    let reach = UPPER_ARM_M * joints[1].sin() + FOREARM_M * (joints[1] + joints[2]).sin();
    let front = reach >= 0.0;
    // Behind the shoulder's axis the same bend of the elbow looks the other way round.
    let above = (joints[2] >= 0.0) == front;
    let bit = |set: bool, value: u32| if set { value } else { 0 };
    bit(front, RIGHT) | bit(above, ABOVE) | bit(joints[4] >= 0.0, NON_FLIP)
}

/// Second word of flags: how many full turns each joint is from ±180°, a signed digit of four bits
/// per joint, J1 lowest. The arrangement is inferred.
pub fn turns(joints: &[f64; 6]) -> u32 {
    let digit = |joint: f64| (((joint + PI) / (2.0 * PI)).floor() as i32 as u32) & 0xf;
    let digits = joints.iter().enumerate();
    digits.fold(0, |word, (index, joint)| {
        word | digit(*joint) << (4 * index)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn postures_and_turns_of_known_joints() {
        let cases = [
            ([0.0, 0.0, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0], 7, 0),
            ([0.0, 0.0, FRAC_PI_2, 0.0, -FRAC_PI_2, 0.0], 6, 0),
            // Elbow down: shoulder at 90 degrees, forearm bent back up.
            ([0.0, FRAC_PI_2, -1.0, 0.0, 1.0, 0.0], 5, 0),
            // Leaning back: the mirror image of the first.
            ([0.0, 0.0, -FRAC_PI_2, 0.0, 0.5, 0.0], 3, 0),
            // J1 at 190 degrees is one turn up, J6 at -190 one down.
            (
                [
                    190f64.to_radians(),
                    0.0,
                    1.0,
                    0.0,
                    1.0,
                    -190f64.to_radians(),
                ],
                7,
                0x00f0_0001,
            ),
        ];
        for (joints, flags, turned) in cases {
            assert_eq!(posture(&joints), flags, "posture of {joints:?}");
            assert_eq!(turns(&joints), turned, "turns of {joints:?}");
        }
    }

    #[test]
    fn range_has_an_edge_and_no_room_for_nan() {
        let mut joints = [0.0; 6];
        joints[4] = 119.9f64.to_radians();
        assert_eq!(out_of_range(&joints), None);
        joints[4] = -120.1f64.to_radians();
        assert_eq!(out_of_range(&joints), Some(4));
        joints[4] = f64::NAN;
        assert_eq!(out_of_range(&joints), Some(4));
    }
}
