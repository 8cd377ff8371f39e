//! What the driver asks of a controller before anything moves, and what it says where it may not.
#![allow(clippy::unwrap_used, missing_docs)]

mod peer;

use melfa::Melfa;
use peer::{Peer, START, State};
use pubs_plugin::{Driver, DriverStatus};
use serde_json::{Value, json};

#[test]
fn a_ready_controller_is_opened_and_nothing_moves() {
    let peer = Peer::start(State::default());
    let mut arm =
        Melfa::open(&peer.setup(json!({ "zero": "given", "force_offset_n": [1.0, -2.0, 2.0] })))
            .unwrap();
    assert_eq!(arm.sensor(), "1f-fs001-w200");
    std::thread::sleep(std::time::Duration::from_millis(100));
    let reading = arm.read().unwrap();
    assert_eq!(reading.status, DriverStatus::Stopped);
    for (found, expected) in reading.position_m.iter().zip([0.5, 0.0, 0.539]) {
        assert!((found - expected).abs() < 1e-6, "{reading:?}");
    }
    for (found, expected) in reading.force_n.iter().zip([0.0, 0.0, 1.0]) {
        assert!(
            (found - expected).abs() < 1e-6,
            "offset taken off: {reading:?}"
        );
    }
    assert!(
        peer.moves().is_empty(),
        "a target was sent without a command"
    );
    drop(arm);
    let state = peer.state();
    assert!(state.log.len() > 10 && state.log.last().unwrap().command == 255);
    assert!(
        state.log[..state.log.len() - 1]
            .iter()
            .all(|seen| seen.command == 0)
    );
    assert_eq!(state.feedback, START);
    let order: Vec<&str> = [
        "CNTLON",
        "SRVON",
        "CNTLOFF",
        "SLOTINIT",
        "RUNPUBS;1",
        "STOP",
        "CLOSE",
    ]
    .into_iter()
    .filter(|wanted| {
        state
            .requests
            .iter()
            .any(|request| request.ends_with(wanted))
    })
    .collect();
    assert_eq!(order.len(), 7, "{:?}", state.requests);
}

#[test]
fn a_program_that_is_missing_is_written() {
    let missing = State {
        has_program: false,
        ..State::default()
    };
    let peer = Peer::start(missing.clone());
    let never = peer.setup(json!({ "upload_program": "never" }));
    let refusal = Melfa::open(&never).unwrap_err().to_string();
    assert!(
        refusal.contains("`PUBS` cannot be started") && refusal.contains("101"),
        "{refusal}"
    );
    drop(peer);
    let peer = Peer::start(missing);
    drop(Melfa::open(&peer.setup(json!({ "filter_ms": 12.0 }))).unwrap());
    let state = peer.state();
    let lines = state
        .requests
        .iter()
        .find(|request| request.contains("EMDAT"))
        .unwrap();
    assert_eq!(
        lines,
        "1;9;EMDAT1 Open \"ENET:127.0.0.1\" As #1\u{b}2 Mxt 1,0,12\u{b}3 Hlt\u{b}4 End"
    );
}

/// A controller that is not ready: what is wrong, the parameters, what the refusal must hold.
fn unready() -> Vec<(State, Value, &'static [&'static str])> {
    let state = State::default;
    vec![
        (
            State {
                run: 0x8a,
                ..state()
            },
            json!({}),
            &["mode", "AUTOMATIC", "teach pendant"],
        ),
        (
            State {
                stop: 0x01,
                ..state()
            },
            json!({}),
            &["emergency stop", "pressed"],
        ),
        (
            State {
                error: 2140,
                ..state()
            },
            json!({}),
            &["alarm 2140", "servo amplifier overheated", "reset_alarm"],
        ),
        (
            State {
                refused: vec!["CNTLON"],
                ..state()
            },
            json!({}),
            &["servo", "CNTLON", "operation right"],
        ),
        (
            state(),
            json!({ "servo_on": false }),
            &["servo: off", "servo_on=true"],
        ),
        (
            State {
                run: 0xa2,
                ..state()
            },
            json!({ "start_program": false }),
            &["program: no program runs"],
        ),
        (
            State {
                streams: false,
                ..state()
            },
            json!({}),
            &["force: no packet", "monitor_port"],
        ),
        (
            State {
                streams: false,
                ..state()
            },
            json!({ "monitor_port": 1 }),
            &["force: the port is closed", "UDP"],
        ),
        (
            State {
                drift_n_per_packet: 0.012,
                ..state()
            },
            json!({}),
            &["drifts by", "baseline_drift_n_s"],
        ),
        (
            State {
                force_n: [199.0, 0.0, 0.0],
                ..state()
            },
            json!({}),
            &["saturated", "200 N"],
        ),
        (
            State {
                mxt_answers: false,
                ..state()
            },
            json!({}),
            &["mxt: no reply", "ENET line"],
        ),
        (
            State {
                r3_cut: true,
                ..state()
            },
            json!({}),
            &["controller: R3 at 127.0.0.1", "subnet"],
        ),
        (
            state(),
            json!({ "acceleration_m_s2": 2.0 }),
            &["stop", "5 m/s²", "2 m/s²"],
        ),
        (
            state(),
            json!({ "host": "no.such.host.invalid" }),
            &["address", "no known name"],
        ),
        (
            state(),
            json!({ "singularity_deg": 45.0, "cycle_ms": 0.1 }),
            &["cycle_ms = 0.1"],
        ),
    ]
}

#[test]
fn what_is_missing_is_named_with_its_cure() {
    for (state, params, words) in unready() {
        let peer = Peer::start(state.clone());
        let refusal = match Melfa::open(&peer.setup(params.clone())) {
            Ok(_) => panic!("opened although {words:?}"),
            Err(error) => error.to_string(),
        };
        for word in words {
            assert!(refusal.contains(word), "`{refusal}` should hold `{word}`");
        }
        assert!(peer.moves().is_empty(), "{words:?}: something moved");
    }
}

#[test]
fn an_alarm_is_reset_where_that_is_wanted_and_never_an_emergency_stop() {
    let alarm = State {
        error: 2140,
        ..State::default()
    };
    let wanted = json!({ "reset_alarm": true });
    let peer = Peer::start(alarm.clone());
    drop(Melfa::open(&peer.setup(wanted.clone())).unwrap());
    drop(peer);
    let pressed = State {
        stop: 0x01,
        ..alarm
    };
    let peer = Peer::start(pressed);
    assert!(Melfa::open(&peer.setup(wanted)).is_err());
    let reset = peer
        .state()
        .requests
        .iter()
        .any(|request| request.contains("RSTALRM"));
    assert!(!reset, "an alarm was reset under an emergency stop");
}

#[test]
fn force_can_be_read_over_r3_or_not_at_all() {
    let quiet = State {
        streams: false,
        ..State::default()
    };
    for (source, force) in [("r3", [1.0, -2.0, 3.0]), ("none", [0.0; 3])] {
        let peer = Peer::start(quiet.clone());
        let mut arm =
            Melfa::open(&peer.setup(json!({ "force_source": source, "zero": "given" }))).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(200));
        assert_eq!(arm.read().unwrap().force_n, force, "{source}");
    }
}
