//! The driver in motion, against a controller of these tests' own.
#![allow(clippy::unwrap_used, missing_docs)]

mod peer;

use melfa::Melfa;
use melfa::motion::Phase;
use peer::drive::{
    CYCLE_S, QUANTUM_M, SPEED, along_x, drive, greatest_acceleration, opened, steps, wait,
};
use peer::steady::steadily;
use peer::{Peer, START, Seen, State};
use pubs_plugin::{Driver, DriverStatus, Twist};
use serde_json::json;

#[test]
fn a_command_moves_the_arm_within_its_limits_and_runs_out() {
    steadily(
        "a_command_moves_the_arm_within_its_limits_and_runs_out",
        || {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            drive(&mut arm, along_x(SPEED), 0.4).unwrap();
            assert_eq!(arm.read().unwrap().status, DriverStatus::Ready);
            wait(300);
            // Nothing was said any more: the last command ran out, and the arm came to rest by itself.
            let reading = arm.read().unwrap();
            assert_eq!(reading.status, DriverStatus::Stopped);
            assert_eq!(arm.phase(), Phase::Holding);
            let moves = peer.moves();
            let first = moves.first().unwrap();
            let jump = f64::from(first.target.mm[0] - START.mm[0]);
            assert!(
                jump.abs() < 0.1,
                "the first target is {jump} mm from the arm"
            );
            assert_eq!(first.posture, 7);
            for (sent, was) in first.target.rad.iter().zip(START.rad) {
                assert!((sent - was).abs() <= 1e-5, "{first:?}");
            }
            let steps = steps(&moves);
            let greatest = steps.iter().copied().fold(0.0, f64::max);
            assert!(
                (greatest - SPEED * CYCLE_S).abs() <= 2.0 * QUANTUM_M,
                "greatest step {greatest} m, speed times cycle {}",
                SPEED * CYCLE_S
            );
            assert!(steps.iter().all(|step| *step >= -QUANTUM_M), "it went back");
            let acceleration = greatest_acceleration(&moves);
            assert!(acceleration <= 5.0 * 1.001, "{acceleration} m/s²");
            // 0.4 s and the 0.05 s of the last command, less what the slack of sleeping took.
            let travelled = reading.position_m[0] - 0.5;
            assert!(
                (0.018..0.0235).contains(&travelled),
                "travelled {travelled} m at {SPEED} m/s"
            );
            let stats = arm.close();
            assert!(stats.sent_per_reply() < 1.1, "{stats}");
            assert!(
                stats.step_m <= stats.step_limit_m && stats.joint_share <= 0.8,
                "{stats}"
            );
        },
    );
}

#[test]
fn a_stop_and_a_close_ramp_down() {
    steadily("a_stop_and_a_close_ramp_down", || {
        for close in [false, true] {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            drive(&mut arm, along_x(SPEED), 0.3).unwrap();
            if close {
                drop(arm);
            } else {
                arm.stop().unwrap();
                wait(150);
                assert_eq!(arm.read().unwrap().status, DriverStatus::Stopped);
            }
            let moves = peer.moves();
            let steps = steps(&moves);
            assert!(
                steps.last().unwrap().abs() < 1e-9,
                "close {close}: still moving"
            );
            // From 0.05 m/s by 500 m/s³ and 5 m/s²: 20 ms, six cycles and one to begin with.
            let ramp = steps.iter().rev().skip_while(|step| **step == 0.0);
            let ramp = ramp
                .take_while(|step| **step < SPEED * CYCLE_S - 2.0 * QUANTUM_M)
                .count();
            assert!(
                (4..=7).contains(&ramp),
                "close {close}: {ramp} cycles from full speed to rest"
            );
            let acceleration = greatest_acceleration(&moves);
            assert!(
                acceleration <= 5.0 * 1.001,
                "close {close}: {acceleration} m/s²"
            );
        }
    });
}

#[test]
fn turning_goes_beyond_half_a_turn_without_a_jump() {
    steadily("turning_goes_beyond_half_a_turn_without_a_jump", || {
        let peer = Peer::start(State::default());
        let mut arm = opened(&peer);
        let twist = Twist {
            linear_m_s: [0.0; 3],
            angular_rad_s: [0.0, 0.0, 0.5],
        };
        drive(&mut arm, twist, 0.3).unwrap();
        wait(200);
        let moves = peer.moves();
        let c = |seen: &Seen| f64::from(seen.target.rad[2]);
        let turned = c(moves.last().unwrap()) - f64::from(START.rad[2]);
        assert!((0.12..0.18).contains(&turned), "turned by {turned} rad");
        for pair in moves.windows(2) {
            assert!((c(&pair[1]) - c(&pair[0])).abs() < 0.002, "{pair:?}");
        }
    });
}

#[test]
fn an_arm_that_does_not_follow_is_not_run_away_from() {
    steadily("an_arm_that_does_not_follow_is_not_run_away_from", || {
        let peer = Peer::start(State::default());
        let mut arm = opened(&peer);
        drive(&mut arm, along_x(SPEED), 0.1).unwrap();
        peer.state().follows = false;
        let reason = drive(&mut arm, along_x(SPEED), 2.0)
            .unwrap_err()
            .to_string();
        assert!(reason.contains("the arm does not follow"), "{reason}");
        wait(200);
        let moves = peer.moves();
        let ahead = moves.last().unwrap().target.mm[0] - peer.state().feedback.mm[0];
        assert!(
            (10.0..18.0).contains(&ahead),
            "the target is {ahead} mm ahead"
        );
        assert!(greatest_acceleration(&moves) <= 5.0 * 1.001);
        assert_eq!(
            peer.state().log.last().unwrap().command,
            255,
            "the session is ended"
        );
    });
}

#[test]
fn a_tare_takes_the_resting_force_for_zero_and_refuses_motion() {
    steadily(
        "a_tare_takes_the_resting_force_for_zero_and_refuses_motion",
        || {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            drive(&mut arm, along_x(SPEED), 0.1).unwrap();
            let refused = arm.tare().unwrap_err().to_string();
            assert!(refused.contains("at rest"), "{refused}");
            wait(300);
            arm.tare().unwrap();
            peer.state().force_n = [1.5, -2.0, 3.0];
            wait(50);
            let force = arm.read().unwrap().force_n;
            for (found, expected) in force.iter().zip([0.5, 0.0, 0.0]) {
                assert!((found - expected).abs() < 1e-6, "{force:?}");
            }
            // With a given zero it only looks.
            drop(arm);
            let given = json!({ "zero": "given", "force_offset_n": [1.0, 0.0, 0.0] });
            let mut arm = Melfa::open(&peer.setup(given)).unwrap();
            arm.tare().unwrap();
            assert_eq!(arm.read().unwrap().force_n, [0.5, -2.0, 3.0]);
            peer.state().drift_n_per_packet = 0.012;
            let refused = arm.tare().unwrap_err().to_string();
            assert!(refused.contains("drifts by"), "{refused}");
        },
    );
}

#[test]
fn a_twist_that_is_no_number_is_refused() {
    steadily("a_twist_that_is_no_number_is_refused", || {
        let peer = Peer::start(State::default());
        let mut arm = opened(&peer);
        let refused = arm
            .command(along_x(f64::NAN), u64::MAX)
            .unwrap_err()
            .to_string();
        assert!(refused.contains("not finite"), "{refused}");
        wait(50);
        assert!(peer.moves().is_empty());
    });
}
