//! From the flange to the joints, in closed form: the last three axes meet in the wrist.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::{
    FOREARM_M, HAND_M, RANGE_RAD, SHOULDER_M, SPEED_RAD_S, UPPER_ARM_M, out_of_range, posture,
};

/// The wrist nearer than this to the axis of J1 leaves J1 undetermined, m.
const SHOULDER_LIMIT_M: f64 = 0.001;

/// J5 nearer than this to zero leaves J4 and J6 undetermined; J3 nearer to it, the arm is
/// stretched and has no way left outwards. Sines.
const ANGLE_LIMIT: f64 = 0.001;

/// Where a pose determines no joints, or joints no way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singularity {
    /// The wrist is on the axis of J1.
    Shoulder,
    /// The arm is stretched.
    Elbow,
    /// J4 and J6 are in line.
    Wrist,
}

/// Why no joints were found.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ReachError {
    /// The wrist would be farther out, or farther in, than the arm can hold it.
    #[error("out of reach: the wrist would be {distance_m:.3} m from the shoulder")]
    OutOfReach {
        /// Wrist to shoulder, m.
        distance_m: f64,
    },
    /// Every solution has a joint beyond its range; this is of the nearest.
    #[error("joint {joint} would be at {angle_deg:.1} degrees, beyond its range")]
    OutOfRange {
        /// Number of the joint, from 1.
        joint: usize,
        /// Where it would be.
        angle_deg: f64,
    },
    /// At a singularity.
    #[error("singular: {}", match .0 {
        Singularity::Shoulder => "the wrist is on the axis of J1",
        Singularity::Elbow => "the arm is stretched",
        Singularity::Wrist => "J5 is near zero, J4 and J6 in line",
    })]
    Singular(Singularity),
    /// No solution has this posture.
    #[error("no solution has posture {0}")]
    Posture(u32),
}

/// The joints (rad) that put the flange at `target` (base frame, m): of all solutions within the
/// ranges the one that is soonest reached from `near`, every joint at its greatest speed.
pub fn inverse(target: &Isometry3<f64>, near: &[f64; 6]) -> Result<[f64; 6], ReachError> {
    nearest(solutions(target, near)?, near)
}

/// As [`inverse`], among the solutions of one posture (see [`posture`]).
pub fn inverse_with_posture(
    target: &Isometry3<f64>,
    near: &[f64; 6],
    wanted: u32,
) -> Result<[f64; 6], ReachError> {
    let mut found = solutions(target, near)?;
    found.retain(|joints| posture(joints) == wanted);
    if found.is_empty() {
        return Err(ReachError::Posture(wanted));
    }
    nearest(found, near)
}

fn nearest(solutions: Vec<[f64; 6]>, near: &[f64; 6]) -> Result<[f64; 6], ReachError> {
    let duration = |joints: &[f64; 6]| {
        let times = (0..6).map(|index| (joints[index] - near[index]).abs() / SPEED_RAD_S[index]);
        times.fold(0.0, f64::max)
    };
    let (within, beyond): (Vec<_>, Vec<_>) = solutions
        .into_iter()
        .partition(|joints| out_of_range(joints).is_none());
    let least = |candidates: Vec<[f64; 6]>| {
        candidates
            .into_iter()
            .min_by(|a, b| duration(a).total_cmp(&duration(b)))
    };
    if let Some(joints) = least(within) {
        return Ok(joints);
    }
    let joints = least(beyond).unwrap_or(*near);
    let joint = out_of_range(&joints).unwrap_or(0);
    Err(ReachError::OutOfRange {
        joint: joint + 1,
        angle_deg: joints[joint].to_degrees(),
    })
}

/// The eight solutions, each joint turned to the side of `near`.
fn solutions(target: &Isometry3<f64>, near: &[f64; 6]) -> Result<Vec<[f64; 6]>, ReachError> {
    let wrist = target.translation.vector - target.rotation * Vector3::z() * HAND_M;
    let (reach, height) = (wrist.x.hypot(wrist.y), wrist.z - SHOULDER_M);
    let distance = reach.hypot(height);
    let bend = (distance * distance - UPPER_ARM_M * UPPER_ARM_M - FOREARM_M * FOREARM_M)
        / (2.0 * UPPER_ARM_M * FOREARM_M);
    // Also where a number of the target is NaN.
    if !(-1.0..=1.0).contains(&bend) {
        return Err(ReachError::OutOfReach {
            distance_m: distance,
        });
    }
    if reach < SHOULDER_LIMIT_M {
        return Err(ReachError::Singular(Singularity::Shoulder));
    }
    let elbow = bend.acos();
    if elbow.sin() < ANGLE_LIMIT {
        return Err(ReachError::Singular(Singularity::Elbow));
    }
    let heading = wrist.y.atan2(wrist.x);
    let mut found = Vec::with_capacity(8);
    for (j1, reach) in [(heading, reach), (heading + PI, -reach)] {
        for j3 in [elbow, -elbow] {
            let inner = (FOREARM_M * j3.sin()).atan2(UPPER_ARM_M + FOREARM_M * j3.cos());
            let j2 = reach.atan2(height) - inner;
            for hand in hands(&target.rotation, j1, j2 + j3)? {
                found.push(beside([j1, j2, j3, hand[0], hand[1], hand[2]], near));
            }
        }
    }
    Ok(found)
}

/// The two settings of J4, J5, J6 on a forearm turned by `j1` and leaning by `lean`.
fn hands(
    orientation: &UnitQuaternion<f64>,
    j1: f64,
    lean: f64,
) -> Result<[[f64; 3]; 2], ReachError> {
    let forearm = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), j1)
        * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), lean);
    let hand = (forearm.inverse() * orientation).to_rotation_matrix();
    // The hand is Rz(J4) Ry(J5) Rz(J6): its z axis has J4 and J5, its lowest row J5 and J6.
    let sine = hand[(0, 2)].hypot(hand[(1, 2)]);
    if sine < ANGLE_LIMIT {
        return Err(ReachError::Singular(Singularity::Wrist));
    }
    let j4 = hand[(1, 2)].atan2(hand[(0, 2)]);
    let j5 = sine.atan2(hand[(2, 2)]);
    let j6 = hand[(2, 1)].atan2(-hand[(2, 0)]);
    Ok([[j4, j5, j6], [j4 + PI, -j5, j6 + PI]])
}

/// Adds full turns, so that each joint is as near as can be to where it was, within its range.
fn beside(mut joints: [f64; 6], near: &[f64; 6]) -> [f64; 6] {
    for (index, joint) in joints.iter_mut().enumerate() {
        *joint += ((near[index] - *joint) / TAU).round() * TAU;
        if joint.abs() > RANGE_RAD[index] {
            let other = *joint - TAU * joint.signum();
            if other.abs() <= RANGE_RAD[index] {
                *joint = other;
            }
        }
    }
    joints
}
