//! The driver in motion, against a controller of these tests' own.
#![allow(clippy::unwrap_used, missing_docs)]

mod peer;

use std::time::{Duration, Instant};

use melfa::Melfa;
use melfa::motion::Phase;
use melfa::system::monotonic_ns;
use peer::{Peer, START, Seen, State};
use pubs_plugin::{Driver, DriverStatus, PluginError, Twist};
use serde_json::json;

const CYCLE_S: f64 = 0.0035;
const SPEED: f64 = 0.05;

fn along_x(speed: f64) -> Twist {
    Twist {
        linear_m_s: [speed, 0.0, 0.0],
        angular_rad_s: [0.0; 3],
    }
}

/// Commands at 100 Hz as the engine does, each lasting 50 ms; ends with the first error.
fn drive(arm: &mut Melfa, twist: Twist, seconds: f64) -> Result<(), PluginError> {
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    while Instant::now() < end {
        arm.read()?;
        arm.command(twist, monotonic_ns() + 50_000_000)?;
        std::thread::sleep(Duration::from_millis(10));
    }
    Ok(())
}

fn opened(peer: &Peer) -> Melfa {
    Melfa::open(&peer.setup(json!({}))).unwrap_or_else(|error| panic!("{error}"))
}

fn wait(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}

/// Steps of x between targets, m.
fn steps(moves: &[Seen]) -> Vec<f64> {
    let x = |seen: &Seen| f64::from(seen.target.mm[0]) * 1e-3;
    moves
        .windows(2)
        .map(|pair| x(&pair[1]) - x(&pair[0]))
        .collect()
}

/// Quanta of 1e-3 mm make steps uncertain by one, and rates of change by two, per cycle.
const QUANTUM_M: f64 = 1e-6;

/// Greatest change of the step, as an acceleration. Where the machine kept the driver waiting for a
/// cycle the arm has slowed down meanwhile, and the driver goes on from there: not counted.
fn greatest_acceleration(moves: &[Seen]) -> f64 {
    let mut greatest: f64 = 0.0;
    for triple in moves.windows(3) {
        let waited = (triple[2].at - triple[1].at).max(triple[1].at - triple[0].at);
        if waited.as_secs_f64() < 1.9 * CYCLE_S {
            let steps = steps(triple);
            greatest = greatest.max((steps[1] - steps[0]).abs());
        }
    }
    (greatest - 2.0 * QUANTUM_M).max(0.0) / (CYCLE_S * CYCLE_S)
}

#[test]
fn a_command_moves_the_arm_within_its_limits_and_runs_out() {
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
}

#[test]
fn a_stop_and_a_close_ramp_down() {
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
}

#[test]
fn turning_goes_beyond_half_a_turn_without_a_jump() {
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
}

#[test]
fn lost_late_repeated_and_foreign_packets_do_not_stop_the_arm() {
    let lossy = |losses: u32| {
        move |state: &mut State| (state.lose_replies, state.lose_requests) = (losses, losses)
    };
    let one_in_a_hundred = lossy(3);
    let repeated = |state: &mut State| state.copies = 3;
    let garbage = |state: &mut State| state.garbage = true;
    let delayed = |state: &mut State| state.delay = Duration::from_millis(2);
    let cases: [(&str, &dyn Fn(&mut State)); 4] = [
        ("1 in 100 lost", &one_in_a_hundred),
        ("repeated", &repeated),
        ("strangers and short ones", &garbage),
        ("delayed", &delayed),
    ];
    for (name, change) in cases {
        let peer = Peer::start(State::default());
        let mut arm = opened(&peer);
        change(&mut peer.state());
        drive(&mut arm, along_x(SPEED), 0.6).unwrap_or_else(|error| panic!("{name}: {error}"));
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
}

#[test]
fn one_packet_in_five_lost_slows_the_arm_but_makes_no_jump() {
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
}

#[test]
fn a_lost_link_is_made_again_without_a_jump_and_without_a_motion_of_its_own() {
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
}

/// What stops the arm for good: name, the change, what the reason must hold.
type SafetyStop = (&'static str, fn(&mut State), &'static str);

#[test]
fn nothing_resumes_after_a_safety_stop() {
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
            (state.run, state.stop, state.error) = (as_it_was.run, as_it_was.stop, as_it_was.error);
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
}

#[test]
fn force_that_stops_coming_stops_the_arm_until_a_new_command() {
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
}

#[test]
fn a_closed_r3_is_connected_again_or_ends_the_session() {
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
}

#[test]
fn an_arm_that_does_not_follow_is_not_run_away_from() {
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
}

#[test]
fn a_tare_takes_the_resting_force_for_zero_and_refuses_motion() {
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
}

#[test]
fn a_twist_that_is_no_number_is_refused() {
    let peer = Peer::start(State::default());
    let mut arm = opened(&peer);
    let refused = arm
        .command(along_x(f64::NAN), u64::MAX)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("not finite"), "{refused}");
    wait(50);
    assert!(peer.moves().is_empty());
}
