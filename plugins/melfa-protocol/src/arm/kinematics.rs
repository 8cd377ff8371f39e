//! From joints to the flange, and how fast it goes.

use nalgebra::{Isometry3, Matrix6, Translation3, UnitQuaternion, Vector3};

use super::{FOREARM_M, HAND_M, SHOULDER_M, UPPER_ARM_M};

/// Position and axis of each joint, base frame, and the flange.
struct Chain {
    joints: [(Vector3<f64>, Vector3<f64>); 6],
    flange: Isometry3<f64>,
}

fn chain(joints: &[f64; 6]) -> Chain {
    let up = |length: f64| Translation3::new(0.0, 0.0, length);
    let links = [
        (0.0, Vector3::z_axis()),
        (SHOULDER_M, Vector3::y_axis()),
        (UPPER_ARM_M, Vector3::y_axis()),
        (0.0, Vector3::z_axis()),
        (FOREARM_M, Vector3::y_axis()),
        (HAND_M, Vector3::z_axis()),
    ];
    let mut frame = Isometry3::identity();
    let mut found = [(Vector3::zeros(), Vector3::zeros()); 6];
    for ((entry, (length, axis)), angle) in found.iter_mut().zip(links).zip(joints) {
        frame *= up(length);
        *entry = (frame.translation.vector, frame.rotation * axis.into_inner());
        frame *= UnitQuaternion::from_axis_angle(&axis, *angle);
    }
    Chain {
        joints: found,
        flange: frame,
    }
}

/// The flange in the base frame (m) with the joints at these angles (rad).
pub fn forward(joints: &[f64; 6]) -> Isometry3<f64> {
    chain(joints).flange
}

/// Velocity of the flange per velocity of the joints: rows are the linear (m/s) and the angular
/// (rad/s) velocity in base axes at the flange's origin, columns J1 to J6 (rad/s).
pub fn jacobian(joints: &[f64; 6]) -> Matrix6<f64> {
    let Chain { joints, flange } = chain(joints);
    let mut matrix = Matrix6::zeros();
    for (index, (origin, axis)) in joints.iter().enumerate() {
        let arm = flange.translation.vector - origin;
        matrix
            .fixed_view_mut::<3, 1>(0, index)
            .copy_from(&axis.cross(&arm));
        matrix.fixed_view_mut::<3, 1>(3, index).copy_from(axis);
    }
    matrix
}
