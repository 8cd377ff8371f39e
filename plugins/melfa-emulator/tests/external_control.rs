//! MXT, rule by rule.

#![allow(clippy::unwrap_used)]

mod bench;

use bench::{Bench, RECEIVE, ahead, joints, null, pose, to_joints, to_pose};
use nalgebra::Vector3;
use pubs_melfa_emulator::alarm;
use pubs_melfa_protocol::arm::{self, ACCELERATION_RAD_S2};
use pubs_melfa_protocol::mxt::{Command, Data, DataType, Io, Request};
use pubs_melfa_protocol::r3::State;

const DRAWER: &[&str] = &["--world", "drawer1", "--start", "0.3"];

fn drawer(mxt: &str) -> Bench {
    Bench::ready(DRAWER, mxt)
}

/// DSTATE's bytes, without the error and what follows.
fn status(bench: &mut Bench) -> State {
    bench.r3("1;1;DSTATE")[3..].parse().unwrap()
}

#[test]
fn handshake_tells_where_the_arm_is() {
    let mut bench = drawer("Mxt 1,0,10");
    let reply = bench.send(&null()).unwrap();
    let found = pose(&reply, DataType::FeedbackPose);
    let held = joints(&reply, DataType::FeedbackJoint);
    let flange = arm::forward(&std::array::from_fn(|joint| f64::from(held[joint])));
    let error = (found.position_m() - flange.translation.vector).norm();
    assert!(error < 1e-6, "pose and joints are {error} m apart");
    let error = found.orientation().angle_to(&flange.rotation);
    assert!(error < 1e-5, "pose and joints are {error} rad apart");
    assert_eq!(found.posture, 7);
    assert_eq!(pose(&reply, DataType::CommandPose), found, "no target yet");
    assert_eq!(reply.data.map(|(data_type, _)| data_type), RECEIVE);
    assert_eq!((reply.count, reply.timeout_count), (1, 0));
}

/// Every way to begin wrongly: no reply, this alarm, program stopped.
#[test]
fn wrong_beginnings_raise_alarms() {
    let target = |bench: &Bench| bench.machine.controller.views().feedback_pose();
    type Wrong = fn(&mut Bench, pubs_melfa_protocol::Pose) -> Option<Request>;
    let cases: [(&str, &str, bool, Wrong, u32); 8] = [
        (
            "no handshake",
            "Mxt 1,0",
            false,
            |_, at| Some(to_pose(at)),
            alarm::NO_HANDSHAKE,
        ),
        (
            "joints for poses",
            "Mxt 1,0",
            true,
            |_, _| Some(to_joints([0.0; 8])),
            alarm::WRONG_TYPE,
        ),
        (
            "poses for joints",
            "Mxt 1,1",
            true,
            |_, at| Some(to_pose(at)),
            alarm::WRONG_TYPE,
        ),
        (
            "no type",
            "Mxt 1,0",
            true,
            |_, _| {
                Some(Request {
                    command: Command::Move,
                    ..Request::default()
                })
            },
            alarm::WRONG_TYPE,
        ),
        (
            "servo off",
            "Mxt 1,0",
            true,
            |bench, at| {
                bench.machine.controller.servo = pubs_melfa_emulator::controller::Servo::Off;
                Some(to_pose(at))
            },
            alarm::SERVO_OFF,
        ),
        (
            "NaN",
            "Mxt 1,0",
            true,
            |_, mut at| {
                at.position_mm[1] = f32::NAN;
                Some(to_pose(at))
            },
            alarm::NOT_FINITE,
        ),
        (
            "other posture",
            "Mxt 1,0",
            true,
            |_, mut at| {
                at.posture = 6;
                Some(to_pose(at))
            },
            alarm::OTHER_POSTURE,
        ),
        (
            "no file",
            "Mxt 2,0",
            false,
            |_, _| None,
            alarm::FILE_NOT_OPEN,
        ),
    ];
    for (name, mxt, handshake, wrong, number) in cases {
        let mut bench = drawer(mxt);
        if handshake {
            bench.handshake();
        }
        let at = target(&bench);
        if let Some(request) = wrong(&mut bench, at) {
            assert!(bench.send(&request).is_none(), "{name}: a reply");
        }
        assert_eq!(bench.alarm(), number, "{name}");
        let state = status(&mut bench);
        assert!(
            !state.run.running && state.stop.stop && state.stop.wait,
            "{name}: {state:?}"
        );
        assert_eq!(state.error, number, "{name}");
        assert!(bench.r3("1;1;DSTATE").starts_with("Qok"), "{name}");
        assert!(
            bench.send(&null()).is_none(),
            "{name}: a reply after the alarm"
        );
    }
}

#[test]
fn after_an_alarm_everything_begins_anew() {
    let mut bench = drawer("Mxt 1,0,10");
    let at = bench.machine.controller.views().feedback_pose();
    assert!(bench.send(&to_pose(at)).is_none());
    assert!(
        bench.r3("1;1;RUNPUBS;1").starts_with("Qer"),
        "started in alarm"
    );
    assert!(
        bench.r3("1;1;SRVON").starts_with("Qer"),
        "servo on in alarm"
    );
    assert_eq!(bench.r3("1;1;RSTALRM"), "QoK");
    bench.start();
    assert!(
        bench.send(&to_pose(at)).is_none(),
        "no handshake since the start"
    );
    assert_eq!(bench.alarm(), alarm::NO_HANDSHAKE);
    bench.r3("1;1;RSTALRM");
    bench.start();
    let at = bench.handshake();
    assert!(bench.send(&to_pose(at)).is_some());
}

#[test]
fn arm_goes_to_absolute_targets_with_the_filters_lag_and_holds_them() {
    let mut bench = drawer("Mxt 1,0,35");
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.05, 200);
    // A first-order filter of time constant T follows a ramp T behind: 35 ms of 50 mm/s, less half
    // a cycle since the filter steps at the end of a cycle.
    let lag = (target.position_m() - bench.tool_m()).norm();
    assert!((lag - 0.05 * 0.0333).abs() < 2e-5, "{lag} m behind");
    bench.cycles(200);
    let left = (target.position_m() - bench.tool_m()).norm();
    assert!(left < 1e-8, "{left} m from the last target");
    assert!(bench.machine.controller.measure.at_rest);
    let off_line = (bench.tool_m() - from.position_m())
        .cross(&direction)
        .norm();
    assert!(off_line < 1e-6, "{off_line} m beside the line");
}

#[test]
fn longer_cycle_moves_as_far() {
    let words = [DRAWER, &["--cycle-ms", "7.11"]].concat();
    let mut bench = Bench::ready(&words, "Mxt 1,0,35");
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.05, 100);
    let lag = (target.position_m() - bench.tool_m()).norm();
    assert!((lag - 0.05 * 0.0316).abs() < 5e-5, "{lag} m behind");
    bench.cycles(100);
    let left = (target.position_m() - bench.tool_m()).norm();
    assert!(left < 1e-7, "{left} m from the last target");
    let speed = bench.machine.controller.measure.peaks.tool_speed_m_s;
    assert!((speed - 0.05).abs() < 1e-4, "{speed} m/s");
}

#[test]
fn joint_targets_move_joints() {
    let mut bench = drawer("Mxt 1,1,10");
    let reply = bench.send(&null()).unwrap();
    let mut target = joints(&reply, DataType::FeedbackJoint);
    let from = target[5];
    for _ in 0..100 {
        target[5] += 0.001;
        assert!(bench.send(&to_joints(target)).is_some());
    }
    bench.cycles(100);
    let moved = bench.machine.controller.motion.joints()[5] - f64::from(from);
    assert!((moved - 0.1).abs() < 1e-5, "J6 moved by {moved} rad");
}

#[test]
fn pulse_targets_move_joints_too() {
    let mut bench = drawer("Mxt 1,2,10");
    bench.handshake();
    let receive = [
        DataType::FeedbackPulse,
        DataType::FeedbackJoint,
        DataType::FilteredPulse,
        DataType::FeedbackCurrent,
    ];
    let ask = |command, send, data| Request {
        command,
        send,
        data,
        receive,
        ..Request::default()
    };
    let reply = bench
        .send(&ask(Command::Null, DataType::None, Data::None))
        .unwrap();
    let Data::Pulse(mut pulses) = reply.data[0].1 else {
        panic!("{:?}", reply.data[0]);
    };
    let held = joints(&reply, DataType::FeedbackJoint);
    let expected = (f64::from(held[2]) * 100_000.0).round() as i32;
    assert!((pulses[2] - expected).abs() <= 1, "{pulses:?} for {held:?}");
    assert!(matches!(reply.data[3].1, Data::Current(_)));
    let from = pulses[5];
    for _ in 0..50 {
        pulses[5] += 100;
        let request = ask(Command::Move, DataType::CommandPulse, Data::Pulse(pulses));
        assert!(bench.send(&request).is_some());
    }
    bench.cycles(100);
    let moved = bench.machine.controller.motion.joints()[5] * 100_000.0 - f64::from(from);
    assert!((moved - 5000.0).abs() < 1.0, "J6 moved by {moved} pulses");
}

#[test]
fn jump_is_an_alarm_and_a_ramp_within_the_joints_accelerations() {
    let mut bench = drawer("Mxt 1,0,0");
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.15, 200);
    bench.control(r#"{"do":"reset_peaks"}"#);
    // 30 mm in one cycle are 8.6 m/s.
    let target = ahead(&target, direction * 0.03);
    assert!(bench.send(&to_pose(target)).is_none());
    assert_eq!(bench.alarm(), alarm::JOINT_SPEED);
    assert!(bench.r3("1;1;DSTATE").contains("8805"));
    let text = bench.r3("1;1;ERRORMES8805");
    assert!(text.starts_with("QokExcessive joint speed: J"), "{text}");
    let at = bench.tool_m();
    bench.cycles(100);
    assert!(bench.machine.controller.measure.at_rest);
    let way = (bench.tool_m() - at).norm();
    assert!((0.0005..0.01).contains(&way), "{way} m to rest");
    let peaks = bench.machine.controller.measure.peaks;
    for (joint, most) in ACCELERATION_RAD_S2.iter().enumerate() {
        let found = peaks.joint_acceleration_rad_s2[joint];
        assert!(found < most * 1.01, "J{}: {found} rad/s²", joint + 1);
    }
    assert!(
        !bench.machine.controller.servo_is_on(),
        "grave: the servo goes off"
    );
}

#[test]
fn unreachable_targets_are_alarms() {
    // Straight up, the arm ends at 1.289 m.
    let mut bench = drawer("Mxt 1,0,10");
    let from = bench.handshake();
    let mut target = from;
    let mut way = 0.0;
    let mut number = 0;
    for cycle in 0..6000 {
        way += 0.0005 * f64::min(1.0, f64::from(cycle) / 200.0);
        target.position_mm[2] = from.position_mm[2] + 1000.0 * way as f32;
        if bench.send(&to_pose(target)).is_none() {
            number = bench.alarm();
            break;
        }
    }
    let expected = [
        alarm::OUT_OF_REACH,
        alarm::JOINT_RANGE,
        alarm::SINGULAR,
        alarm::JOINT_SPEED,
    ];
    assert!(expected.contains(&number), "alarm {number} after {way} m");
}

#[test]
fn joint_beyond_its_range_is_an_alarm() {
    let mut bench = drawer("Mxt 1,1,0");
    let reply = bench.send(&null()).unwrap();
    let mut target = joints(&reply, DataType::FeedbackJoint);
    let last = loop {
        target[4] += 0.02;
        if bench.send(&to_joints(target)).is_none() {
            break target[4];
        }
    };
    assert_eq!(bench.alarm(), alarm::JOINT_RANGE);
    assert!(
        last > 120f32.to_radians() && last < 121.5f32.to_radians(),
        "{last}"
    );
}

#[test]
fn silent_cycles_are_counted_and_too_many_are_an_alarm() {
    let words = [DRAWER, &["--mxtout", "50"]].concat();
    let mut bench = Bench::ready(&words, "Mxt 1,0,10");
    bench.cycles(200);
    assert_eq!(bench.alarm(), 0, "nothing counts before the first packet");
    bench.handshake();
    bench.cycles(50);
    let reply = bench.send(&null()).unwrap();
    assert_eq!((reply.timeout_count, reply.count), (50, 2));
    bench.cycles(10);
    let reply = bench.send(&null()).unwrap();
    assert_eq!((reply.timeout_count, reply.count), (60, 3), "they add up");
    bench.cycles(50);
    assert_eq!(bench.alarm(), 0, "50 are allowed");
    bench.cycles(1);
    assert_eq!(bench.alarm(), alarm::TIMEOUT, "51 are not");
}

#[test]
fn silence_means_nothing_where_it_is_not_watched() {
    let mut bench = drawer("Mxt 1,0,10");
    bench.handshake();
    bench.cycles(3000);
    let reply = bench.send(&null()).unwrap();
    assert_eq!((reply.timeout_count, reply.count), (0, 2));
}

#[test]
fn what_is_no_packet_of_the_peers_is_passed_over() {
    let mut bench = drawer("Mxt 1,0,10");
    bench.handshake();
    let client = bench.client;
    let whole = null().encode();
    let unknown = |at: usize, value: u8| {
        let mut bytes = whole;
        bytes[at] = value;
        bytes
    };
    for bytes in [
        &whole[..195],
        &[whole.as_slice(), &[0]].concat(),
        &[],
        &unknown(0, 7),
        &unknown(4, 12),
    ] {
        assert!(
            bench.send_bytes(bytes, client).is_none(),
            "{} bytes",
            bytes.len()
        );
    }
    let stranger = "127.0.0.9:50000".parse().unwrap();
    let end = Request {
        command: Command::End,
        ..Request::default()
    };
    assert!(bench.send_bytes(&end.encode(), stranger).is_none());
    let other_port = "127.0.0.1:50001".parse().unwrap();
    assert!(
        bench.send_bytes(&whole, other_port).is_some(),
        "the address counts, not the port"
    );
    assert_eq!(bench.alarm(), 0);
    assert_eq!(bench.send(&null()).unwrap().count, 3);
}

#[test]
fn nothing_answers_without_a_program_at_its_mxt_line() {
    let mut bench = Bench::new(DRAWER);
    assert!(bench.send(&null()).is_none());
    assert_eq!(bench.alarm(), 0);
}

#[test]
fn end_lets_the_program_go_on_and_the_arm_stop() {
    let mut bench = drawer("Mxt 1,0,10");
    let from = bench.handshake();
    let direction = bench.opening();
    bench.go(from, direction, 0.05, 100);
    let end = Request {
        command: Command::End,
        ..Request::default()
    };
    assert!(bench.send(&end).is_none());
    bench.cycles(30);
    assert!(bench.machine.controller.measure.at_rest);
    let state = status(&mut bench);
    assert!(!state.run.running && state.run.servo_on, "{state:?}");
    assert_eq!((state.error, state.step), (0, 4), "it stands after Hlt");
    assert!(bench.send(&null()).is_none());
    // A start goes on with End, and the next one begins anew.
    assert_eq!(bench.r3("1;1;RUNPUBS;1"), "QoK");
    bench.cycles(2);
    assert!(status(&mut bench).stop.program_select_enabled);
    assert_eq!(bench.r3("1;1;RUNPUBS;1"), "QoK");
    bench.cycles(2);
    assert!(bench.send(&null()).is_some());
}

#[test]
fn stop_interrupts_and_a_start_needs_a_new_handshake() {
    let mut bench = drawer("Mxt 1,0,10");
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.05, 100);
    assert_eq!(bench.r3("1;1;STOP"), "QoK");
    bench.cycles(30);
    assert!(bench.machine.controller.measure.at_rest);
    assert_eq!(bench.alarm(), 0);
    assert_eq!(bench.r3("1;1;RUNPUBS;1"), "QoK");
    bench.cycles(2);
    assert!(bench.send(&to_pose(target)).is_none());
    assert_eq!(bench.alarm(), alarm::NO_HANDSHAKE);
}

#[test]
fn signals_are_written_and_read_in_the_packets() {
    let mut bench = drawer("Mxt 1,0,10");
    bench.handshake();
    let with = |io| Request { io, ..null() };
    let write = Io {
        send: 1,
        receive: 0,
        first_bit: 16,
        mask: 0x00ff,
        data: 0x1234,
    };
    assert_eq!(bench.send(&with(write)).unwrap().io.data, 0);
    let read = Io {
        send: 0,
        receive: 1,
        first_bit: 18,
        ..Io::default()
    };
    let found = bench.send(&with(read)).unwrap().io;
    assert_eq!((found.send, found.first_bit, found.data), (1, 18, 0x000d));
    assert_eq!(bench.r3("1;1;IN=100;0005"), "QoK");
    let read = Io {
        receive: 2,
        first_bit: 100,
        ..Io::default()
    };
    assert_eq!(bench.send(&with(read)).unwrap().io.data, 5);
}

#[test]
fn posture_flags_may_be_ignored() {
    let words = [DRAWER, &["--posture", "ignore"]].concat();
    let mut bench = Bench::ready(&words, "Mxt 1,0,10");
    let mut at = bench.handshake();
    at.posture = 0;
    assert!(bench.send(&to_pose(at)).is_some());
}

#[test]
fn poses_are_those_of_the_tool() {
    let words = [DRAWER, &["--tool", "0,0,100,0,0,90"]].concat();
    let mut bench = Bench::ready(&words, "Mxt 1,0,10");
    let plain = Bench::new(DRAWER);
    let error = (bench.tool_m() - plain.tool_m()).norm();
    assert!(error < 1e-6, "the same handle, {error} m apart");
    let reply = bench.send(&null()).unwrap();
    let held = joints(&reply, DataType::FeedbackJoint);
    let flange = arm::forward(&std::array::from_fn(|joint| f64::from(held[joint])));
    let tool = flange * nalgebra::Point3::from(Vector3::new(0.0, 0.0, 0.1));
    assert!((tool.coords - bench.tool_m()).norm() < 1e-6);
    let listed = bench.r3("1;1;VALP_Tool;P");
    assert_eq!(listed, "QoKP_Tool=(0.00,0.00,100.00,0.00,0.00,90.00)(0,0)");
}
