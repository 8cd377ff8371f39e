//! World files: the shipped ones are valid, and each fault is named.

#![allow(clippy::unwrap_used)]

use pubs_virtual_arm::world::World;

const DOOR2: &str = include_str!("../worlds/door2.toml");

#[test]
fn every_shipped_world_is_built_in_and_named_after_its_file() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/worlds")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(World::load(name).unwrap().name, name);
        assert_eq!(
            World::load(path.to_str().unwrap()).unwrap().name,
            name,
            "read from its path"
        );
    }
}

#[test]
fn door2_is_as_stiff_as_its_object_file_allows() {
    let world = World::load("door2").unwrap();
    let (grasp, stop) = (
        world.grasp.stiffness_n_per_m.x,
        world.resistance.stop.stiffness_n_per_m,
    );
    let combined = grasp * stop / (grasp + stop);
    assert!(
        combined <= 5000.0,
        "grasp and stop in series have {combined} N/m"
    );
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
