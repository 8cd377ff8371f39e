//! Rules between keys.

use super::{Case, DOOR, DRAWER, LIGHT_DARK, check_cases};

#[test]
fn limits_start_goal_and_tolerance() {
    check_cases(&[
        Case {
            base: DOOR,
            change: ("[0.0, 90.0]", "[90.0, 0.0]"),
            at: (7, "joint.limits_deg"),
            message: &["from 90 to 0"],
            help: &["[0, 90]"],
        },
        Case {
            base: DRAWER,
            change: ("[0.0, 0.3]", "[0.3, 0.3]"),
            at: (7, "joint.limits_m"),
            message: &["must be larger"],
            help: &[],
        },
        Case {
            base: DRAWER,
            change: ("0.02", "0.15"),
            at: (11, "reward.goal_tolerance_m"),
            message: &["is 0.15", "half the range is 0.15"],
            help: &["below 0.15"],
        },
        Case {
            base: LIGHT_DARK,
            change: ("[-30.0, 30.0]", "[-70.0, 30.0]"),
            at: (6, "joint.start"),
            message: &["from -70 to 30", "[-60, 60]"],
            help: &[],
        },
        Case {
            base: LIGHT_DARK,
            change: ("[-30.0, 30.0]", "[-30.5, 30.0]"),
            at: (6, "joint.start"),
            message: &["whole numbers"],
            help: &[],
        },
        Case {
            base: LIGHT_DARK,
            change: ("goal = 0.0", "goal = 61.0"),
            at: (8, "joint.goal"),
            message: &["is 61", "[-60, 60]"],
            help: &[],
        },
    ]);
}

#[test]
fn directions() {
    check_cases(&[
        Case {
            base: DOOR,
            change: ("[0.0, 1.0, 0.0]", "[0.0, 0.0, 0.0]"),
            at: (11, "joint.up_direction"),
            message: &["points nowhere"],
            help: &[],
        },
        Case {
            // 10 degrees off the line of motion: tan 10° = 0.1763
            base: DOOR,
            change: ("[0.0, 1.0, 0.0]", "[0.0, 0.1763, 1.0]"),
            at: (11, "joint.up_direction"),
            message: &["10.0° from the line of motion"],
            help: &["[0.0, 1.0, 0.0]"],
        },
        Case {
            base: DRAWER,
            change: ("[0.0, 1.0, 0.0]", "[0.0, 0.0, 2.0]"),
            at: (9, "joint.up_direction"),
            message: &["0.0° from the line of motion"],
            help: &["up_direction = ["],
        },
        Case {
            // 10 degrees off a right angle
            base: DOOR,
            change: ("[1.0, 0.0, 0.0]", "[1.0, 0.0, 0.1763]"),
            at: (10, "joint.hinge_direction"),
            message: &["100.0°", "90°"],
            help: &["hinge_direction = [1.0, 0.0, 0.0]"],
        },
        Case {
            base: DOOR,
            change: ("[1.0, 0.0, 0.0]", "[0.0, 0.0, -3.0]"),
            at: (10, "joint.hinge_direction"),
            message: &["0.0°"],
            help: &["hinge_direction = ["],
        },
    ]);
}

#[test]
fn directions_within_their_bounds_pass() {
    // up 21 degrees from the motion (tan 21° = 0.384), hinge 4 degrees off (tan 4° = 0.0699)
    let text = DOOR
        .replace(
            "up_direction = [0.0, 1.0, 0.0]",
            "up_direction = [0.0, 0.384, 1.0]",
        )
        .replace(
            "hinge_direction = [1.0, 0.0, 0.0]",
            "hinge_direction = [1e-3, 0.0, 6.99e-5]",
        );
    if let Err(faults) = super::load(&text) {
        panic!("{}", crate::object::render(&faults, false));
    }
}

#[test]
fn rates_speeds_and_forces() {
    check_cases(&[
        Case {
            base: DOOR,
            change: ("[reward]", "[belief]\nrate_hz = 25\n[reward]"),
            at: (13, "belief.rate_hz"),
            message: &["2.50 filter updates to each policy step"],
            help: &["20 or 30"],
        },
        Case {
            base: DOOR,
            change: ("[reward]", "[belief]\nrate_hz = 110\n[reward]"),
            at: (13, "belief.rate_hz"),
            message: &["is 110, above `control.rate_hz`, 100"],
            help: &["at most 100"],
        },
        Case {
            base: DOOR,
            change: ("[reward]", "[policy]\nrate_hz = 60\n[reward]"),
            at: (13, "policy.rate_hz"),
            message: &["is 60, above `belief.rate_hz`, 30"],
            help: &[],
        },
        Case {
            base: DOOR,
            change: ("[reward]", "[control]\nsafe_speed_m_s = 0.2\n[reward]"),
            at: (13, "control.safe_speed_m_s"),
            message: &["is 0.2, above `control.high_speed_m_s`, 0.15"],
            help: &[],
        },
        Case {
            base: DOOR,
            change: ("[reward]", "[control]\nforce_threshold_n = 60\n[reward]"),
            at: (13, "control.force_threshold_n"),
            message: &["is 60 N, not below force_limit_n, 60 N"],
            help: &["below 60"],
        },
        Case {
            base: DOOR,
            change: ("\"assumed\"", "\"measured\""),
            at: (3, "source.sensor"),
            message: &["missing"],
            help: &["sensor"],
        },
    ]);
}

#[test]
fn the_force_of_the_worst_stop() {
    check_cases(&[Case {
        // 20000 · (0.05 · 0.02 + 0.05² / 10) = 25; 15 + 25 = 40 > 38. High-force mode, at the
        // same speed, would have to stop at 38 − 25 = 13 N: its own fault, silenced by 0.04.
        base: DOOR,
        change: (
            "[reward]",
            "[control]\nforce_limit_n = 70\nhigh_speed_m_s = 0.25\n[reward]",
        ),
        // 5000 · (0.25 · 0.02 + 0.0625 / 10) = 56.25; 70 − 56.25 = 13.75 <= 15.
        // v² / 10 + 0.02 v = 55 / 5000  =>  v = −0.1 + √(0.01 + 0.11) = 0.2464
        at: (14, "control.high_speed_m_s"),
        message: &[
            "13.8 N",
            "15 N",
            "5000 N/m",
            "0.25 m/s · 2 / 100 Hz",
            "56.2 N",
        ],
        help: &["high_speed_m_s = 0.246 or less"],
    }]);
    let text = DOOR.replace(
        "[reward]",
        "[control]\nforce_limit_n = 39\nsafe_speed_m_s = 0.15\nhigh_speed_m_s = 0.15\n[reward]",
    );
    // 5000 · (0.15 · 0.02 + 0.0225 / 10) = 26.25: safe mode presses with 41.25 N > 39 N, and
    // high-force mode begins at 12.75 N <= 15 N. v = −0.1 + √(0.01 + 24 / 500) = 0.1408
    let faults = super::faults_of(&text);
    let found: Vec<_> = faults
        .iter()
        .map(|fault| (fault.line, fault.key.as_str()))
        .collect();
    assert_eq!(
        found,
        [
            (Some(14), "control.safe_speed_m_s"),
            (Some(15), "control.high_speed_m_s")
        ]
    );
    for (fault, worst) in faults.iter().zip(["41.2 N", "12.8 N"]) {
        assert!(
            fault.message.contains(worst),
            "{worst} not in {}",
            fault.message
        );
        assert!(fault.help.contains("0.14 or less"), "{}", fault.help);
    }
}

#[test]
fn the_speed_that_the_cure_names_passes_and_the_next_does_not() {
    for (speed, passes) in [("0.216", true), ("0.217", false)] {
        let overrides = super::set(&[
            &format!("control.high_speed_m_s={speed}"),
            "control.safe_speed_m_s=0.05",
        ]);
        let loaded = super::load_with(DOOR, &overrides);
        assert_eq!(loaded.is_ok(), passes, "high_speed_m_s = {speed}");
    }
}

#[test]
fn actions_of_an_abstract_joint() {
    check_cases(&[
        Case {
            base: LIGHT_DARK,
            change: ("stop = true", "move = 2.0"),
            at: (9, "action"),
            message: &["no action is the stop action"],
            help: &["stop = true"],
        },
        Case {
            base: LIGHT_DARK,
            change: ("move = -1.0\nhigh_force = true", "stop = true"),
            at: (18, "action.2.stop"),
            message: &["second stop action", "`stop`"],
            help: &["one action"],
        },
        Case {
            base: LIGHT_DARK,
            change: ("\"left_1\"", "\"right_10\""),
            at: (17, "action.2.name"),
            message: &["two actions", "`right_10`"],
            help: &["another name"],
        },
        Case {
            base: LIGHT_DARK,
            change: ("move = 10.0", "move = 15.0"),
            at: (14, "action.1.move"),
            message: &["15 in 10 sub-moves of 1.5", "whole numbers"],
            help: &["multiple"],
        },
        Case {
            base: LIGHT_DARK,
            change: ("move = 10.0", "move = 200.0"),
            at: (14, "action.1.move"),
            message: &["200", "120"],
            help: &[],
        },
        Case {
            base: LIGHT_DARK,
            change: ("move = -1.0\n", ""),
            at: (16, "action.2.move"),
            message: &["is missing"],
            help: &["signed displacement"],
        },
        Case {
            base: LIGHT_DARK,
            change: ("stop = true", "stop = true\nmove = 1.0"),
            at: (12, "action.0.move"),
            message: &["the stop action has `move`"],
            help: &["remove"],
        },
    ]);
}
