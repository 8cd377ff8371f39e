//! Frames and signs of the design, on poses worked out by hand.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use nalgebra::Vector3;
use pubs_core::joint::{Direction, Geometry, Path, Pose};
use pubs_core::observation::ArmObservation;
use pubs_core::{Joint, JointKind, controller};

const QUARTER: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn close(found: Vector3<f64>, expected: [f64; 3], what: &str) {
    assert!(
        (found - Vector3::from(expected)).norm() < 1e-9,
        "{what}: {found:?}, expected {expected:?}"
    );
}

/// The tool at (1, 2, 3), turned 90° about x: tool y is base z (up), tool z is base −y, tool x is
/// base x. So the door opens (tool −z) along base +y, and its hinge lies 0.5 m along base +x.
fn grasp() -> Pose {
    Pose::new([1.0, 2.0, 3.0], [QUARTER, 0.0, 0.0, QUARTER])
}

#[test]
fn a_hinge_at_the_grasp() {
    let path = Path::at_grasp(&common::door(2).joint, &grasp()).unwrap();
    let pose = grasp();
    close(
        path.tangent(&pose, Direction::Opening),
        [0.0, 1.0, 0.0],
        "opening",
    );
    close(
        path.tangent(&pose, Direction::Closing),
        [0.0, -1.0, 0.0],
        "closing",
    );
    let frame = path.frame(&pose, Direction::Opening);
    close(frame.up, [0.0, 0.0, 1.0], "up");
    // n = z × d = (0,0,1) × (0,1,0) = (−1, 0, 0): away from the hinge.
    close(frame.normal, [-1.0, 0.0, 0.0], "normal while opening");
    close(
        path.frame(&pose, Direction::Closing).normal,
        [1.0, 0.0, 0.0],
        "normal while closing",
    );
    // axis = opening × hinge = (0,1,0) × (1,0,0) = (0, 0, −1).
    let (linear, angular) = path.velocity(&pose, 0.1, 0.0);
    close(linear, [0.0, 0.1, 0.0], "linear velocity");
    close(angular, [0.0, 0.0, -0.2], "angular velocity");
}

#[test]
fn a_hinge_a_quarter_turn_later() {
    let path = Path::at_grasp(&common::door(2).joint, &grasp()).unwrap();
    // About the centre (1.5, 2, 3) by −90° around z the handle comes from −x to +y.
    let later = Pose::new([1.5, 2.5, 3.0], [QUARTER, 0.0, 0.0, QUARTER]);
    let displacement = path.displacement(&later);
    assert!(
        (displacement - std::f64::consts::FRAC_PI_2).abs() < 1e-12,
        "{displacement}"
    );
    close(
        path.tangent(&later, Direction::Opening),
        [1.0, 0.0, 0.0],
        "opening after 90°",
    );
    assert!(path.deviation_m(&later) < 1e-12);
    let off = Pose::new([1.5, 2.53, 3.04], [QUARTER, 0.0, 0.0, QUARTER]);
    assert!(
        (path.deviation_m(&off) - 0.05).abs() < 1e-12,
        "3 cm out and 4 cm up are 5 cm off"
    );
}

#[test]
fn resistance_is_positive_both_ways() {
    let path = Path::at_grasp(&common::door(2).joint, &grasp()).unwrap();
    let pose = grasp();
    // By the tool on the object, 7 N along base +y (opening) is tool (0, 0, −7); 2 N up is tool +y;
    // 3 N towards the hinge is tool +x.
    let force = [3.0, 2.0, -7.0];
    let cases = [
        (Direction::Opening, [7.0, 2.0, -3.0]),
        (Direction::Closing, [-7.0, 2.0, 3.0]),
    ];
    for (direction, [f_d, f_z, f_n]) in cases {
        let found = ArmObservation::new(&path, &pose, direction, force, true);
        for (name, found, expected) in [
            ("f_d", found.f_d, f_d),
            ("f_z", found.f_z, f_z),
            ("f_n", found.f_n, f_n),
        ] {
            assert!(
                (found - expected).abs() < 1e-9,
                "{direction:?}: {name} {found}, expected {expected}"
            );
        }
    }
    let task = common::door(2);
    let along = controller::force_along(&path, &pose, &task.actions[2], force);
    assert!(
        (along + 7.0).abs() < 1e-9,
        "closing against an opening pull: {along}"
    );
}

#[test]
fn a_slide() {
    let geometry = Geometry {
        opening_direction: Vector3::new(0.0, 0.0, -1.0),
        up_direction: Vector3::new(0.0, 1.0, 0.2),
        motion_threshold_m: 0.0005,
    };
    let joint = Joint {
        kind: JointKind::Prismatic { geometry },
        lower: 0.0,
        upper: 0.3,
        start: (0.0, 0.3),
    };
    let path = Path::at_grasp(&joint, &grasp()).unwrap();
    let later = Pose::new([1.0, 2.1, 3.0], [QUARTER, 0.0, 0.0, QUARTER]);
    assert!((path.displacement(&later) - 0.1).abs() < 1e-12);
    let off = Pose::new([1.03, 2.1, 3.04], [QUARTER, 0.0, 0.0, QUARTER]);
    assert!((path.displacement(&off) - 0.1).abs() < 1e-12);
    assert!((path.deviation_m(&off) - 0.05).abs() < 1e-12);
    let (linear, angular) = path.velocity(&later, -0.2, 0.01);
    close(linear, [0.0, -0.2, 0.0], "closing");
    close(angular, [0.0, 0.0, 0.0], "a slide does not turn");
    // Up was given askew, tool (0, 1, 0.2); made orthogonal to the motion it is base z.
    close(
        path.frame(&later, Direction::Opening).up,
        [0.0, 0.0, 1.0],
        "up",
    );
}

#[test]
fn steps_of_the_controller_stay_on_the_arc() {
    let path = Path::at_grasp(&common::door(2).joint, &grasp()).unwrap();
    let mut pose = grasp();
    for _ in 0..660 {
        let (linear, _) = path.velocity(&pose, 0.15, 0.01);
        pose.position += linear * 0.01;
    }
    let deviation = path.deviation_m(&pose);
    assert!(deviation < 2e-5, "{deviation} m off the arc after 0.99 m");
    let displacement = path.displacement(&pose);
    assert!(
        (displacement - 1.98).abs() < 1e-3,
        "{displacement} rad after 0.99 m on a radius of 0.5 m"
    );
}

#[test]
fn speeds_follow_equation_13() {
    let task = common::door(2);
    let control = common::control();
    let cases = [
        (0, 0.0, 0.0),
        (0, 99.0, 0.0),
        (1, 15.0, 0.05),
        (1, 15.01, 0.0),
        (2, 14.0, -0.05),
        (2, 16.0, 0.0),
        (3, 59.0, 0.15),
        (4, 59.0, -0.15),
    ];
    for (action, force, expected) in cases {
        let found = control.speed(&task.actions[action], force);
        assert_eq!(
            found, expected,
            "{} at {force} N",
            task.actions[action].name
        );
    }
}

#[test]
fn ramps_are_bounded() {
    let control = common::control();
    let cases = [
        (0.0, 0.15, 0.01),
        (0.145, 0.15, 0.15),
        (0.15, 0.0, 0.10),
        // Slowing down to go on, by the acceleration.
        (0.15, 0.05, 0.14),
        (0.02, 0.0, 0.0),
        (0.05, -0.05, 0.0),
        (0.15, -0.05, 0.10),
        (0.0, -0.05, -0.01),
        (-0.15, 0.0, -0.10),
    ];
    for (speed, target, expected) in cases {
        let found = control.ramp(speed, target);
        assert!(
            (found - expected).abs() < 1e-12,
            "{speed} towards {target}: {found}, expected {expected}"
        );
    }
    // From 0.05 to rest at 5 m/s², on to 0.15 the other way at 1 m/s², and 0.1 s of sway.
    let unsteady = [
        (0.0, 0.0, 0.0),
        (0.0, 0.15, 0.25),
        (0.15, 0.05, 0.20),
        (0.05, -0.15, 0.26),
    ];
    for (speed, target, expected) in unsteady {
        let found = control.unsteady_s(speed, target);
        assert!(
            (found - expected).abs() < 1e-12,
            "{speed} to {target} is unsteady for {found} s, expected {expected}"
        );
    }
    // 5000 · (0.15 · 0.02 + 0.15²/10) = 15 + 11.25
    assert!((control.stop_overshoot_n(0.15) - 26.25).abs() < 1e-9);
}
