//! R3, rule by rule.

#![allow(clippy::unwrap_used)]

mod bench;

use bench::Bench;
use pubs_melfa_protocol::r3::{Position, ProgramState, State, parse_joints, parse_list};

const DOOR: &[&str] = &["--world", "door2", "--start", "0.5"];

fn state(bench: &mut Bench) -> State {
    bench.r3("1;1;DSTATE")[3..].parse().unwrap()
}

/// A step of a session: what is asked, what the answer begins with.
type Step = (&'static str, &'static str);

#[track_caller]
fn session(bench: &mut Bench, steps: &[Step]) {
    for (request, wanted) in steps {
        let answer = bench.r3(request);
        assert!(
            answer.starts_with(wanted),
            "{request}: {answer}, not {wanted}"
        );
        bench.cycles(1);
    }
}

#[test]
fn operation_right_is_needed_and_is_one_connections() {
    let mut bench = Bench::new(DOOR);
    bench.upload("Mxt 1,0,10");
    let refused = "QeR8854";
    session(
        &mut bench,
        &[
            ("1;1;OPEN=ANYNAME", "QoK"),
            ("1;1;SRVON", refused),
            ("1;1;RUNPUBS;1", refused),
            ("1;1;OVRD=50", refused),
            ("1;9;EXECServo On", refused),
            // None of these needs it.
            ("1;1;OVRD", "QoK100"),
            ("1;1;STOP", "QoK"),
            ("1;1;SRVOFF", "QoK"),
            ("1;1;RSTALRM", "QoK"),
            ("1;1;SLOTINIT", "QoK"),
            ("1;1;CNTLON", "QoK"),
            ("1;1;CNTLON", "QoK"),
            ("1;1;OVRD=50", "QoK"),
            ("1;1;OVRD", "QoK50"),
            ("1;1;OVRD=0", "QeR"),
            ("1;1;OVRD=101", "QeR"),
            ("1;9;EXECServo On", "QoK"),
        ],
    );
    assert_eq!(bench.r3_as(2, "1;1;CNTLON"), "QeR5640", "busy");
    assert_eq!(bench.r3_as(2, "1;1;SRVON"), refused);
    assert_eq!(bench.r3_as(2, "1;1;CNTLOFF"), "QoK", "not his to give back");
    assert_eq!(bench.r3("1;1;SRVON"), "QoK");
    assert_eq!(bench.r3("1;1;CLOSE"), "QoK");
    assert_eq!(bench.r3_as(2, "1;1;CNTLON"), "QoK");
}

#[test]
fn bits_follow_a_session() {
    let mut bench = Bench::new(DOOR);
    bench.upload("Mxt 1,0,10");
    let bytes = |bench: &mut Bench| bench.r3("1;1;DSTATE")[..7].to_owned();
    // 0x80 operation enabled, 0x01 repeat; 0x12 stopped, a program may be selected.
    assert_eq!(bytes(&mut bench), "QoK8112");
    session(&mut bench, &[("1;1;CNTLON", "QoK"), ("1;1;SRVON", "QoK")]);
    assert!(!state(&mut bench).run.servo_on, "the servo takes its time");
    bench.cycles(90);
    assert_eq!(bytes(&mut bench), "QoKA112");
    session(&mut bench, &[("1;1;RUNPUBS;1", "QoK")]);
    bench.cycles(2);
    // Servo, running, enabled, no cycle stop; once only.
    assert_eq!(bytes(&mut bench), "QoKE200");
    session(&mut bench, &[("1;1;CSTOP", "QoK")]);
    assert_eq!(bytes(&mut bench), "QoKE000");
    session(&mut bench, &[("1;1;STOP", "QoK")]);
    // Stopped and waiting to go on.
    assert_eq!(bytes(&mut bench), "QoKA006");
    session(&mut bench, &[("1;1;RSTPRG", "QoK")]);
    assert_eq!(bytes(&mut bench), "QoKA012");
    session(&mut bench, &[("1;1;SRVOFF", "QoK")]);
    bench.cycles(1);
    assert_eq!(bytes(&mut bench), "QoK8012");
    session(&mut bench, &[("1;1;CNTLON", "QoK"), ("1;0;RUN;0", "QoK")]);
    assert_eq!(bytes(&mut bench), "QoKC300", "repeating");
}

#[test]
fn programs_are_chosen_started_and_refused() {
    let mut bench = Bench::new(DOOR);
    bench.upload("Mxt 1,0,10");
    session(
        &mut bench,
        &[
            ("1;1;LOAD=OTHER", "QoK"),
            ("1;9;EMDAT1 Hlt\u{b}2 End", "QoK"),
            ("1;1;SAVE", "QoK"),
            ("1;1;NEW", "QoK"),
            ("1;9;EMDAT3 Hlt", "QeR8861"),
            ("1;1;CNTLON", "QoK"),
            ("1;1;PRGLOAD=NONE", "QeR8860"),
            ("1;1;RUNNONE;1", "QeR8860"),
            ("1;1;RUN;1", "QeR8860"),
            ("1;1;PRGLOAD=pubs", "QoK"),
            ("1;0;RUN;-1", "QoK"),
            ("1;1;RUNPUBS;1", "QeR8858"),
            ("1;1;SLOTINIT", "QeR8858"),
            ("1;1;PRGLOAD=OTHER", "QeR8858"),
            ("1;1;LOAD=PUBS", "QeR8858"),
            ("1;1;STOP", "QoK"),
            ("1;1;PRGLOAD=OTHER", "QeR8859"),
            ("1;1;RUNOTHER;1", "QeR8859"),
            ("1;1;SLOTINIT", "QoK"),
            ("1;1;RUNOTHER;2", "QeR"),
            ("1;1;RUNOTHER;1", "QoK"),
        ],
    );
    bench.cycles(2);
    let answer = bench.r3("1;1;STATE");
    let found: ProgramState = answer[3..].parse().unwrap();
    assert_eq!(
        (found.program.as_str(), found.line),
        ("OTHER", 2),
        "{answer}"
    );
    assert!(!found.repeat && found.state.stop.wait, "{answer}");
}

#[test]
fn manual_refuses_what_commands_and_allows_to_look_and_stop() {
    let mut bench = Bench::ready(DOOR, "Mxt 1,0,10");
    bench.control(r#"{"do":"mode","mode":"manual"}"#);
    bench.cycles(2);
    let found = state(&mut bench);
    assert!(
        found.run.teach && !found.run.running && !found.run.servo_on,
        "{found:?}"
    );
    assert!(!found.run.operation_enabled);
    for request in [
        "1;1;CNTLON",
        "1;1;SRVON",
        "1;1;RUNPUBS;1",
        "1;1;SLOTINIT",
        "1;1;PRGLOAD=PUBS",
        "1;1;LOAD=PUBS",
        "1;1;RSTALRM",
    ] {
        assert_eq!(bench.r3(request), "QeR8855", "{request}");
    }
    for request in [
        "1;1;STATE",
        "1;1;PPOSF",
        "1;1;STOP",
        "1;1;SRVOFF",
        "1;1;CLOSE",
    ] {
        assert!(bench.r3(request).starts_with("QoK"), "{request}");
    }
    bench.control(r#"{"do":"mode","mode":"auto"}"#);
    assert_eq!(bench.r3("1;1;CNTLON"), "QoK");
}

#[test]
fn emergency_stop_is_told_and_must_be_released_first() {
    let mut bench = Bench::ready(DOOR, "Mxt 1,0,10");
    bench.control(r#"{"do":"emergency_stop"}"#);
    bench.cycles(2);
    let found = state(&mut bench);
    assert!(
        found.stop.emergency_stop && !found.run.servo_on,
        "{found:?}"
    );
    assert_eq!(found.error, 8812);
    session(
        &mut bench,
        &[
            ("1;1;STPSIG", "Qok00;08"),
            ("1;1;ERROR", "Qok8812;"),
            ("1;1;ERRORMES8812", "QokEmergency stop"),
            ("1;1;ERRORMESH8812", "QokEmergency stop"),
            ("1;1;RSTALRM", "Qer8857"),
            ("1;1;SRVON", "Qer8857"),
        ],
    );
    bench.control(r#"{"do":"emergency_stop","pressed":false}"#);
    session(
        &mut bench,
        &[
            ("1;1;SRVON", "Qer8856"),
            ("1;1;RSTALRM", "QoK"),
            ("1;1;ERROR", "QoK0;"),
            ("1;1;ERRORRD", "QoK8812;Emergency stop;"),
            ("1;1;SRVON", "QoK"),
        ],
    );
    assert_eq!(state(&mut bench).error, 0);
}

#[test]
fn positions_and_variables_are_told_in_millimetres_and_degrees() {
    let words = [DOOR, &["--sensor-bias", "10,-20,30"]].concat();
    let mut bench = Bench::new(&words);
    let answer = bench.r3("1;1;PPOSF");
    let position: Position = answer[3..].parse().unwrap();
    let pose = bench.machine.controller.views().feedback_pose();
    for axis in 0..3 {
        let error = position.position_mm[axis] - f64::from(pose.position_mm[axis]);
        assert!(error.abs() < 0.0051, "{answer}, not {pose:?}");
        let degrees = f64::from(pose.angles_rad[axis]).to_degrees();
        assert!(
            (position.angles_deg[axis] - degrees).abs() < 0.0051,
            "{answer}"
        );
    }
    assert_eq!((position.posture, position.turns), (7, pose.turns));
    let answer = bench.r3("1;1;JPOSF");
    let joints = parse_joints(&answer[3..]).unwrap();
    for (found, wanted) in joints.iter().zip(bench.machine.controller.motion.joints()) {
        assert!((found - wanted.to_degrees()).abs() < 0.0051, "{answer}");
    }
    let force = parse_list(&bench.r3("1;1;VALP_FsCurD;P")).unwrap();
    for (found, bias) in force.iter().zip([10.0, -20.0, 30.0]) {
        assert!((found - bias).abs() < 5.0, "{force:?}");
    }
    assert_eq!(force.len(), 6);
    let listed = parse_list(&bench.r3("1;1;VALP_Curr;P")).unwrap();
    assert!(
        (listed[0] - position.position_mm[0]).abs() < 0.02,
        "{listed:?}"
    );
    session(
        &mut bench,
        &[
            ("1;1;VALM_Spd;M", "QoKM_Spd=10000.00"),
            ("1;1;VALP_BASE", "QoKP_BASE=(0.00,0.00,0.00,0.00,0.00,0.00)"),
            ("1;1;VALM_Nothing;M", "QeR8862"),
            ("1;1;HOTPUBS;M_Mine=12", "QoK"),
            ("1;1;VALM_MINE;M", "QoKM_MINE=12"),
            ("1;1;LISTPM_Mine", "QoKM_Mine=12"),
        ],
    );
}

#[test]
fn signals_are_words_in_hex() {
    let mut bench = Bench::new(DOOR);
    session(
        &mut bench,
        &[
            ("1;1;OUT=16;00A5", "QoK"),
            ("1;1;OUT16", "QoK00A5"),
            ("1;1;OUT18", "QoK0029"),
            ("1;1;IN16", "QoK0000"),
            ("1;1;IN=16;F000", "QoK"),
            ("1;1;IN16", "QoKF000"),
            ("1;1;OUT=16;XYZ", "QeR"),
            ("1;1;OUT", "QeR"),
        ],
    );
}

#[test]
fn what_is_no_request_is_refused() {
    let mut bench = Bench::new(DOOR);
    let long = format!("1;9;EMDAT{}", "x".repeat(250));
    for request in [
        "",
        "DSTATE",
        "1;1;NONSENSE",
        "1;1;DSTATEX",
        "2;1;DSTATE",
        "1;1;CHGPRT=HC",
        "1;1;dstate",
        &long,
    ] {
        let answer = bench.r3(request);
        assert!(answer.starts_with("QeR"), "{request}: {answer}");
        assert_eq!(answer.len(), 7, "four digits: {answer}");
    }
}

#[test]
fn program_with_servo_on_needs_none_before() {
    let mut bench = Bench::new(DOOR);
    session(
        &mut bench,
        &[
            ("1;1;LOAD=S", "QoK"),
            ("1;9;EMDAT1 Servo On\u{b}2 Ovrd 10", "QoK"),
            (
                "1;9;EMDAT3 Open \"ENET:127.0.0.1\" As #1\u{b}4 Mxt 1,0,10",
                "QoK",
            ),
            ("1;1;SAVE", "QoK"),
            ("1;1;CNTLON", "QoK"),
            ("1;1;RUNS;1", "QoK"),
        ],
    );
    bench.cycles(100);
    assert_eq!(bench.r3("1;1;OVRD"), "QoK10");
    assert!(state(&mut bench).run.servo_on);
    bench.handshake();
}

#[test]
fn address_that_cannot_be_read_is_a_network_error() {
    let mut bench = Bench::new(DOOR);
    session(
        &mut bench,
        &[
            ("1;1;LOAD=S", "QoK"),
            (
                "1;9;EMDAT1 Open \"ENET:somewhere\" As #1\u{b}2 Mxt 1,0",
                "QoK",
            ),
            ("1;1;SAVE", "QoK"),
            ("1;1;CNTLON", "QoK"),
            ("1;1;RUNS;1", "QoK"),
        ],
    );
    assert_eq!(state(&mut bench).error, 6130);
}
