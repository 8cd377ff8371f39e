//! Interrupted links and stops of the controller's own, against a controller of these tests' own.
#![allow(clippy::unwrap_used, missing_docs)]

mod peer;

use std::time::Duration;

use melfa::Melfa;
use melfa::motion::Phase;
use melfa::system::monotonic_ns;
use peer::drive::{
    CYCLE_S, QUANTUM_M, SPEED, along_x, drive, greatest_acceleration, opened, steps, wait,
};
use peer::steady::steadily;
use peer::{Peer, State};
use pubs_plugin::{Driver, DriverStatus};
use serde_json::json;

/// Name, and what it does to the controller.
type Disturbance<'a> = (&'static str, &'a dyn Fn(&mut State));

#[test]
fn lost_late_repeated_and_foreign_packets_do_not_stop_the_arm() {
    steadily(
        "lost_late_repeated_and_foreign_packets_do_not_stop_the_arm",
        || {
            let lossy = |losses: u32| {
                move |state: &mut State| {
                    (state.lose_replies, state.lose_requests) = (losses, losses)
                }
            };
            let one_in_a_hundred = lossy(3);
            let repeated = |state: &mut State| state.copies = 3;
            let garbage = |state: &mut State| state.garbage = true;
            let delayed = |state: &mut State| state.delay = Duration::from_millis(2);
            let cases: [Disturbance; 4] = [
                ("1 in 100 lost", &one_in_a_hundred),
                ("repeated", &repeated),
                ("strangers and short ones", &garbage),
                ("delayed", &delayed),
            ];
            for (name, change) in cases {
                let peer = Peer::start(State::default());
                let mut arm = opened(&peer);
                change(&mut peer.state());
                drive(&mut arm, along_x(SPEED), 0.6)
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                wait(200);
                let reading = arm.read().unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(reading.status, DriverStatus::Stopped, "{name}");
                let travelled = reading.position_m[0] - 0.5;
                assert!(travelled > 0.02, "{name}: travelled {travelled} m");
                let greatest = steps(&peer.moves()).into_iter().fold(0.0, f64::max);
                assert!(
                    greatest <= 2.0 * SPEED * CYCLE_S + 2.0 * QUANTUM_M,
                    "{name}: a step of {greatest} m"
                );
                let acceleration = greatest_acceleration(&peer.moves());
                assert!(
                    acceleration <= SPEED / CYCLE_S,
                    "{name}: {acceleration} m/s²"
                );
            }
        },
    );
}

#[test]
fn one_packet_in_five_lost_slows_the_arm_but_makes_no_jump() {
    steadily(
        "one_packet_in_five_lost_slows_the_arm_but_makes_no_jump",
        || {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            (peer.state().lose_replies, peer.state().lose_requests) = (51, 51);
            // It may find a reading too old at times; the guard would stop then.
            for _ in 0..10 {
                let _ = drive(&mut arm, along_x(0.15), 0.1);
            }
            wait(300);
            (peer.state().lose_replies, peer.state().lose_requests) = (0, 0);
            wait(300);
            assert_eq!(arm.read().unwrap().status, DriverStatus::Stopped);
            let greatest = steps(&peer.moves()).into_iter().fold(0.0, f64::max);
            assert!(
                greatest <= 0.15 * CYCLE_S + 2.0 * QUANTUM_M,
                "a step of {greatest} m: what was not sent must not be caught up"
            );
            let acceleration = greatest_acceleration(&peer.moves());
            assert!(acceleration <= 5.0 * 1.001, "{acceleration} m/s²");
        },
    );
}

#[test]
fn a_lost_link_is_made_again_without_a_jump_and_without_a_motion_of_its_own() {
    steadily(
        "a_lost_link_is_made_again_without_a_jump_and_without_a_motion_of_its_own",
        || {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            drive(&mut arm, along_x(SPEED), 0.3).unwrap();
            peer.state().mxt_answers = false;
            let reason = drive(&mut arm, along_x(SPEED), 1.0)
                .unwrap_err()
                .to_string();
            assert!(reason.contains("the newest pose is"), "{reason}");
            wait(300);
            assert_eq!(arm.phase(), Phase::Lost);
            assert!(
                arm.command(along_x(SPEED), monotonic_ns() + 50_000_000)
                    .is_err(),
                "taken into a lost link"
            );
            let commanded = peer.moves().len();
            // Somebody moved the arm meanwhile.
            {
                let mut state = peer.state();
                state.feedback.mm[0] += 30.0;
                state.target = state.feedback;
                state.mxt_answers = true;
            }
            wait(300);
            let reading = arm.read().unwrap();
            assert_eq!(reading.status, DriverStatus::Stopped);
            assert_eq!(peer.moves().len(), commanded, "it moved by itself");
            drive(&mut arm, along_x(SPEED), 0.2).unwrap();
            let moves = peer.moves();
            let first = f64::from(moves[commanded].target.mm[0]) * 1e-3;
            assert!(
                (first - reading.position_m[0]).abs() < 1e-4,
                "the first target {first} m, the arm at {} m",
                reading.position_m[0]
            );
            assert_eq!(arm.close().relinks, 1);
        },
    );
}

/// What stops the arm for good: name, the change, what the reason must hold.
type SafetyStop = (&'static str, fn(&mut State), &'static str);

#[test]
fn nothing_resumes_after_a_safety_stop() {
    steadily("nothing_resumes_after_a_safety_stop", || {
        let cases: [SafetyStop; 5] = [
            (
                "alarm",
                |state| state.error = 2140,
                "alarm 2140 (servo amplifier overheated)",
            ),
            (
                "emergency stop",
                |state| state.stop |= 0x01,
                "emergency stop",
            ),
            ("servo off", |state| state.run &= !0x20, "servo is off"),
            // A contact stop, as far as is known: the program stops, and nothing else is said.
            ("contact stop", |state| state.run &= !0x40, "does not run"),
            ("mode", |state| state.run |= 0x08, "AUTOMATIC"),
        ];
        for (name, change, words) in cases {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            drive(&mut arm, along_x(SPEED), 0.2).unwrap();
            let as_it_was = peer.state().clone();
            change(&mut peer.state());
            assert!(
                drive(&mut arm, along_x(SPEED), 1.0).is_err(),
                "{name}: drove on"
            );
            wait(300);
            let reason = arm.read().unwrap_err().to_string();
            assert!(reason.contains(words), "{name}: {reason}");
            // The cause is gone, the program runs again: still nothing moves.
            let seen = {
                let mut state = peer.state();
                (state.run, state.stop, state.error) =
                    (as_it_was.run, as_it_was.stop, as_it_was.error);
                state.log.len()
            };
            assert!(
                arm.command(along_x(SPEED), monotonic_ns() + 50_000_000)
                    .is_err(),
                "{name}"
            );
            wait(300);
            let after: Vec<u16> = peer.state().log[seen..]
                .iter()
                .map(|seen| seen.command)
                .collect();
            assert!(after.is_empty(), "{name}: sent {after:?} after the stop");
            assert_eq!(
                arm.read().unwrap_err().to_string(),
                reason,
                "{name}: the first reason stays"
            );
        }
    });
}

#[test]
fn force_that_stops_coming_stops_the_arm_until_a_new_command() {
    steadily(
        "force_that_stops_coming_stops_the_arm_until_a_new_command",
        || {
            let peer = Peer::start(State::default());
            let mut arm = opened(&peer);
            drive(&mut arm, along_x(SPEED), 0.2).unwrap();
            peer.state().streams = false;
            let reason = drive(&mut arm, along_x(SPEED), 1.0)
                .unwrap_err()
                .to_string();
            assert!(reason.contains("the newest force reading is"), "{reason}");
            wait(200);
            let refused = arm
                .command(along_x(SPEED), monotonic_ns() + 50_000_000)
                .unwrap_err();
            assert!(
                refused.to_string().contains("no force reading"),
                "{refused}"
            );
            assert!(greatest_acceleration(&peer.moves()) <= 5.0 * 1.001);
            assert!(
                steps(&peer.moves()).last().unwrap().abs() < 1e-9,
                "still moving"
            );
            peer.state().streams = true;
            wait(300);
            assert_eq!(
                arm.read().unwrap().status,
                DriverStatus::Stopped,
                "it is well again, and rests"
            );
            let before = peer.state().feedback.mm[0];
            drive(&mut arm, along_x(SPEED), 0.2).unwrap();
            assert!(
                peer.state().feedback.mm[0] > before + 3.0,
                "a new command moves it"
            );
        },
    );
}

#[test]
fn a_closed_r3_is_connected_again_or_ends_the_session() {
    steadily("a_closed_r3_is_connected_again_or_ends_the_session", || {
        let peer = Peer::start(State::default());
        let params = json!({ "r3_lost_ms": 500.0, "r3_reconnect_s": 1.0 });
        let mut arm = Melfa::open(&peer.setup(params)).unwrap();
        drive(&mut arm, along_x(SPEED), 0.2).unwrap();
        // For a moment: the arm does not even slow down.
        peer.state().r3_cut = true;
        wait(50);
        peer.state().r3_cut = false;
        drive(&mut arm, along_x(SPEED), 0.8).unwrap();
        // For longer: it comes to rest, since nobody looks after it.
        peer.state().r3_cut = true;
        let reason = drive(&mut arm, along_x(SPEED), 1.0)
            .unwrap_err()
            .to_string();
        assert!(reason.contains("R3 does not answer"), "{reason}");
        wait(100);
        assert!(
            steps(&peer.moves()).last().unwrap().abs() < 1e-9,
            "still moving"
        );
        assert!(greatest_acceleration(&peer.moves()) <= 5.0 * 1.001);
        // For good.
        wait(1500);
        let reason = arm.read().unwrap_err().to_string();
        assert!(reason.contains("could not be connected again"), "{reason}");
    });
}
