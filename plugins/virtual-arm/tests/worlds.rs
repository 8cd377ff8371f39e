//! World files: the shipped ones are valid, and each fault is named.

#![allow(clippy::unwrap_used)]

use pubs_virtual_arm::resistance::Resisting;
use pubs_virtual_arm::world::World;

const SHIPPED: [&str; 5] = ["door1", "door2", "drawer1", "drawer2", "fridge"];

const DOOR2: &str = include_str!("../worlds/door2.toml");

#[test]
fn every_shipped_world_is_built_in_and_named_after_its_file() {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/worlds")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(World::load(name).unwrap().name, name);
        assert_eq!(
            World::load(path.to_str().unwrap()).unwrap().name,
            name,
            "read from its path"
        );
        names.push(name.to_owned());
    }
    names.sort();
    assert_eq!(names, SHIPPED, "the tests below cover every file");
}

#[test]
fn shipped_worlds_have_the_ranges_of_the_paper() {
    // §IV-E: doors of 125 degrees, drawers of 25 to 28 cm.
    for (name, upper) in [
        ("door1", 125f64.to_radians()),
        ("door2", 125f64.to_radians()),
        ("drawer1", 0.25),
        ("drawer2", 0.28),
    ] {
        let joint = World::load(name).unwrap().joint;
        assert_eq!((joint.lower, joint.upper), (0.0, upper), "{name}");
    }
}

#[test]
fn forces_are_those_that_the_files_claim() {
    // State (degrees or m), force towards closed, dry friction; worked out by hand, N.
    // door1: 5.9 / (1 + e^((θ-18.5)/4)) and 1.5 + 1.2 sin(360° θ/140 + 45°).
    // drawer1: 6 x and 2.2 + 0.3 sin(360° x/0.07 - 40°).
    // drawer2: 18 exp(-(x/0.006)²/2) + 5 x and 2.8 + 0.4 sin(360° x/0.09 + 30°).
    let cases = [
        ("door1", 0.0, 5.8427, 2.3485),
        ("door1", 18.5, 2.95, 2.6988),
        ("door1", 87.5, 0.0, 0.3),
        ("door1", 125.0, 0.0, 1.6344),
        ("drawer1", 0.0, 0.0, 2.0072),
        ("drawer1", 0.1, 0.6, 2.4735),
        ("drawer1", 0.25, 1.5, 2.2740),
        ("drawer2", 0.0, 18.0, 3.0),
        ("drawer2", 0.006, 10.9476, 3.1236),
        ("drawer2", 0.1, 0.5, 3.1759),
        ("drawer2", 0.28, 1.4, 3.1759),
    ];
    for (name, state, closing, friction) in cases {
        let world = World::load(name).unwrap();
        let lever = world.joint.lever();
        let way = match world.joint.radius_m {
            Some(radius) => f64::to_radians(state) * radius,
            None => state,
        };
        let object = Resisting::new(world.resistance, 0.0, world.joint.upper * lever);
        let found = [object.closing_force_n(way), object.coulomb_n(way)];
        assert!(
            (found[0] - closing).abs() < 1e-4 && (found[1] - friction).abs() < 1e-4,
            "{name} at {state}: {closing} and {friction} N, found {found:?}"
        );
    }
}

#[test]
fn shipped_worlds_are_as_stiff_as_their_object_files_allow() {
    for name in SHIPPED {
        let world = World::load(name).unwrap();
        let (grasp, stop) = (
            world.grasp.stiffness_n_per_m.x,
            world.resistance.stop.stiffness_n_per_m,
        );
        let combined = grasp * stop / (grasp + stop);
        assert!(
            combined <= 5000.0,
            "{name}: grasp and stop in series have {combined} N/m"
        );
    }
}

#[test]
fn faults_are_named_with_their_rule() {
    let cases = [
        (
            "coulomb_n = 1.6",
            "coloumb_n = 1.6",
            "nearest valid key: `coulomb_n`",
        ),
        ("coulomb_n = 1.6", "coloumb_n = 1.6", "line 23"),
        (
            "coulomb_n = 1.6",
            "coulomb_n = -1.0",
            "friction.coulomb_n = -1, but it must be zero or more",
        ),
        (
            "coulomb_n = 1.6",
            "coulomb_n = nan",
            "friction.coulomb_n = NaN",
        ),
        ("coulomb_n = 1.6", "", "missing field `coulomb_n`"),
        (
            "limits_deg = [0.0, 125.0]",
            "limits_deg = [10.0, 5.0]",
            "closed < open",
        ),
        (
            "limits_deg = [0.0, 125.0]",
            "limits_m = [0.0, 0.4]",
            "joint.limits_m = a value, but it must be left out",
        ),
        (
            "radius_m = 0.32",
            "",
            "joint.radius_m = nothing, but it must be given",
        ),
        (
            "width_deg = 1.2",
            "width_deg = 1.2\nwidth_m = 0.01",
            "catch.width_m = 0.01, but it must be left out",
        ),
        (
            "hinge_direction = [1.0, 0.0, 0.0]",
            "hinge_direction = [0.0, 0.0, 1.0]",
            "right angle",
        ),
        (
            "up_direction = [0.0, 1.0, 0.0]",
            "up_direction = [0.0, 0.0, 1.0]",
            "off the opening direction",
        ),
        (
            "opening_direction = [0.0, 0.0, -1.0]",
            "opening_direction = [0.0, 0.0, -2.0]",
            "unit vector",
        ),
        (
            "stiffness_n_per_m = 20000.0",
            "stiffness_n_per_m = 1e9",
            "too fast for the integrator",
        ),
        ("schema = 1", "schema = 2", "schema = 2, but it must be 1"),
        (
            "type = \"revolute\"",
            "type = \"abstract\"",
            "unknown variant `abstract`",
        ),
    ];
    for (old, new, expected) in cases {
        assert!(DOOR2.contains(old), "door2.toml has no {old}");
        let message = World::parse("test", &DOOR2.replacen(old, new, 1))
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(expected),
            "{new}: expected \"{expected}\" in\n{message}"
        );
    }
}
