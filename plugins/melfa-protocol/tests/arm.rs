//! The arm against poses worked out by hand, and its maps against each other.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};
use pubs_melfa_protocol::arm::{
    RANGE_RAD, ReachError, Singularity, forward, inverse, inverse_with_posture, jacobian, posture,
};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Flange position and where its z axis points.
#[test]
fn flange_is_where_the_drawing_has_it() {
    let q = FRAC_PI_2;
    let cases = [
        ([0.0; 6], [0.0, 0.0, 1.289], [0, 0, 1]),
        ([0.0, q, 0.0, 0.0, 0.0, 0.0], [1.035, 0.0, 0.254], [1, 0, 0]),
        ([0.0, 0.0, q, 0.0, q, 0.0], [0.5, 0.0, 0.539], [0, 0, -1]),
        ([q, 0.0, q, 0.0, q, 0.0], [0.0, 0.5, 0.539], [0, 0, -1]),
        ([0.0, 0.0, q, q, q, 0.0], [0.5, 0.125, 0.664], [0, 1, 0]),
        ([0.0, 0.0, q, 0.0, 0.0, 1.0], [0.625, 0.0, 0.664], [1, 0, 0]),
        ([-q, 0.0, -q, 0.0, 0.0, 0.0], [0.0, 0.625, 0.664], [0, 1, 0]),
    ];
    for (joints, position, axis) in cases {
        let flange = forward(&joints);
        let error = (flange.translation.vector - Vector3::from(position)).norm();
        assert!(error < 1e-12, "{joints:?}: {}", flange.translation);
        let found = flange.rotation * Vector3::z();
        let error = (found - Vector3::from(axis.map(f64::from))).norm();
        assert!(error < 1e-12, "{joints:?}: z axis along {found}");
    }
}

/// With J6 alone turned by 90 degrees, the flange's x axis goes to y.
#[test]
fn last_joint_turns_the_flange() {
    let x = forward(&[0.0, 0.0, 0.0, 0.0, 0.0, FRAC_PI_2]).rotation * Vector3::x();
    assert!((x - Vector3::y()).norm() < 1e-12, "x axis along {x}");
}

fn draw(source: &mut Xoshiro256PlusPlus) -> [f64; 6] {
    RANGE_RAD.map(|range| source.random_range(-range..range))
}

fn is_regular(joints: &[f64; 6]) -> bool {
    let reach = 0.41 * joints[1].sin() + 0.5 * (joints[1] + joints[2]).sin();
    reach.abs() > 0.01 && joints[2].sin().abs() > 0.02 && joints[4].sin().abs() > 0.02
}

#[test]
fn inverse_of_forward_gives_the_joints_back() {
    let mut source = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut tried = 0;
    while tried < 5000 {
        let joints = draw(&mut source);
        if !is_regular(&joints) {
            continue;
        }
        tried += 1;
        let near = joints.map(|joint| joint + source.random_range(-0.002..0.002));
        let flange = forward(&joints);
        for found in [
            inverse(&flange, &near),
            inverse_with_posture(&flange, &near, posture(&joints)),
        ] {
            let found = found.unwrap();
            let error = (0..6)
                .map(|i| (found[i] - joints[i]).abs())
                .fold(0.0, f64::max);
            assert!(error < 1e-8, "{joints:?} came back as {found:?}");
        }
    }
}

#[test]
fn every_posture_found_puts_the_flange_on_its_target() {
    let flange = forward(&[0.3, 0.4, 1.2, 0.5, 0.9, -0.4]);
    let mut found_postures = vec![];
    for wanted in 0..8 {
        match inverse_with_posture(&flange, &[0.0; 6], wanted) {
            Ok(joints) => {
                let error = (forward(&joints).translation.vector - flange.translation.vector)
                    .norm()
                    + forward(&joints).rotation.angle_to(&flange.rotation);
                assert!(error < 1e-7, "posture {wanted}: off by {error}");
                assert_eq!(posture(&joints), wanted);
                found_postures.push(wanted);
            }
            Err(error) => assert!(
                matches!(error, ReachError::OutOfRange { .. }),
                "posture {wanted}: {error}"
            ),
        }
    }
    assert!(found_postures.contains(&7) && found_postures.contains(&6));
}

#[test]
fn jacobian_is_the_derivative_of_forward() {
    let mut source = Xoshiro256PlusPlus::seed_from_u64(6);
    let h = 1e-6;
    for _ in 0..200 {
        let joints = draw(&mut source);
        let matrix = jacobian(&joints);
        for index in 0..6 {
            let moved = |by: f64| {
                let mut moved = joints;
                moved[index] += by;
                forward(&moved)
            };
            let (after, before) = (moved(h), moved(-h));
            let linear = (after.translation.vector - before.translation.vector) / (2.0 * h);
            let angular = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
            let found = Vector6::from_iterator(linear.iter().chain(&angular).copied());
            let error = (found - matrix.column(index)).norm();
            assert!(error < 1e-8, "J{} at {joints:?}: off by {error}", index + 1);
        }
    }
}

fn at(x: f64, y: f64, z: f64, turn: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), turn)
}

#[test]
fn what_cannot_be_reached_is_refused() {
    let near = [0.0, 0.0, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0];
    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), PI);
    let refused = |target| inverse(&target, &near).unwrap_err();
    let far = refused(at(1.2, 0.0, 0.3, down));
    assert!(matches!(far, ReachError::OutOfReach { .. }), "{far}");
    let not_a_number = refused(at(f64::NAN, 0.0, 0.3, down));
    assert!(
        matches!(not_a_number, ReachError::OutOfReach { .. }),
        "{not_a_number}"
    );
    let cases = [
        (at(0.0, 0.0, 0.4, down), Singularity::Shoulder),
        (
            forward(&[0.0, 1.0, 1e-5, 0.0, 1.0, 0.0]),
            Singularity::Elbow,
        ),
        (
            forward(&[0.0, 0.0, 1.5, 0.3, 1e-5, 0.2]),
            Singularity::Wrist,
        ),
    ];
    for (target, singularity) in cases {
        assert_eq!(refused(target), ReachError::Singular(singularity));
    }
    // 130 degrees of J5 are beyond its 120, and the flipped hand needs as many.
    let bent = forward(&[0.0, 0.2, 0.8, 0.1, 130f64.to_radians(), 0.0]);
    let error = inverse_with_posture(&bent, &near, 7).unwrap_err();
    let ReachError::OutOfRange { joint, angle_deg } = error else {
        panic!("{error}");
    };
    assert_eq!(joint, 5);
    assert!((angle_deg - 130.0).abs() < 1e-6, "{angle_deg}");
}
