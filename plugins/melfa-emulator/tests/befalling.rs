//! What befalls the arm, the object and the sensor.

#![allow(clippy::unwrap_used)]

mod bench;

use bench::{Bench, ahead, to_pose};
use nalgebra::Vector3;
use pubs_melfa_emulator::alarm;
use pubs_melfa_protocol::monitor::{self, FEEDBACK_JOINT, FEEDBACK_POSE, FORCE, Value};
use serde_json::Value as Json;

const DRAWER: &[&str] = &[
    "--world",
    "drawer1",
    "--start",
    "0.3",
    "--sensor-bias",
    "0,0,0",
];

fn drawer() -> Bench {
    Bench::ready(DRAWER, "Mxt 1,0,10")
}

/// Force that the sensor shows along the opening direction: away from where the tool points.
fn pull_n(bench: &Bench) -> f64 {
    -bench.machine.controller.scene.shown().force.z
}

fn mean_pull_n(bench: &mut Bench, cycles: u32) -> f64 {
    let sum: f64 = (0..cycles)
        .map(|_| {
            bench.cycles(1);
            pull_n(bench)
        })
        .sum();
    sum / f64::from(cycles)
}

fn number(report: &Json, key: &str) -> f64 {
    report.pointer(key).and_then(Json::as_f64).unwrap()
}

#[test]
fn pulling_the_drawer_open_takes_its_friction_and_moves_it() {
    let mut bench = drawer();
    let before = number(&bench.state(), "/object/joint_state");
    let from = bench.handshake();
    let direction = bench.opening();
    bench.go(from, direction, 0.05, 400);
    let way = (bench.tool_m() - from.position_m()).norm();
    let report = bench.state();
    let moved = number(&report, "/object/joint_state") - before;
    assert!(
        (moved - way).abs() < 0.002,
        "the drawer went {moved} m, the tool {way} m"
    );
    let pull = pull_n(&bench);
    assert!((1.0..12.0).contains(&pull), "{pull} N");
    let true_pull = -report["force_n"][2].as_f64().unwrap();
    assert!(
        (pull - true_pull).abs() < 2.0,
        "{pull} N shown, {true_pull} N true"
    );
    assert!((number(&report, "/peaks/tool_speed_m_s") - 0.05).abs() < 1e-4);
}

#[test]
fn drawer_moves_as_in_the_virtual_arm() {
    use pubs_virtual_arm::arm::Velocity;
    use pubs_virtual_arm::plant::{Plant, STEP_S};
    use pubs_virtual_arm::world::World;

    let mut bench = Bench::ready(DRAWER, "Mxt 1,0,0");
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.1, 400);
    for _ in 0..200 {
        bench.send(&to_pose(target)).unwrap();
    }
    // The same way of the same tool, in the world's own frame.
    let world = World::load("drawer1").unwrap();
    let mut plant = Plant::new(&world, 0.3 * world.joint.upper, 5.0);
    let opening = world.joint.closed_orientation * world.joint.opening;
    let start_m = plant.arm.position_m;
    let cycle_s = 0.0035;
    let steps = 16;
    let (mut speed, mut way) = (0.0f64, 0.0);
    for cycle in 0..600 {
        speed = if cycle < 400 {
            (speed + cycle_s).min(0.1)
        } else {
            0.0
        };
        for step in 0..steps {
            let within = speed * cycle_s * f64::from(step) / f64::from(steps);
            plant.arm.position_m = start_m + opening * (way + within);
            plant.arm.velocity = Velocity {
                linear: opening * speed,
                angular: Vector3::zeros(),
            };
            plant.step_object(cycle_s / f64::from(steps));
            assert!(cycle_s / f64::from(steps) <= STEP_S);
        }
        way += speed * cycle_s;
    }
    let (found, wanted) = (
        bench.machine.controller.scene.joint_state(),
        plant.joint_state(),
    );
    assert!((found - wanted).abs() < 1e-5, "{found} m, not {wanted} m");
}

#[test]
fn handle_that_slips_is_felt_no_more_until_it_is_held_again() {
    let mut bench = drawer();
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.05, 200);
    bench.control(r#"{"do":"slip"}"#);
    bench.cycles(60);
    let pull = mean_pull_n(&mut bench, 200);
    assert!(pull.abs() < 1.0, "{pull} N of nothing");
    assert_eq!(bench.state()["object"]["held"], false);
    assert_eq!(bench.r3("1;1;OUT900"), "QoK0000");
    bench.send(&to_pose(target)).unwrap();
    assert_eq!(bench.r3("1;1;OUT=900;0001"), "QoK");
    assert_eq!(bench.state()["object"]["held"], true);
    bench.control(r#"{"do":"slip"}"#);
    bench.go(target, direction, 0.05, 200);
    bench.control(r#"{"do":"grasp"}"#);
    assert_eq!(
        bench.state()["object"]["held"],
        false,
        "fingers that miss hold nothing"
    );
}

#[test]
fn jammed_object_stands_and_the_force_grows() {
    let mut bench = drawer();
    let from = bench.handshake();
    let direction = bench.opening();
    bench.control(r#"{"do":"jam","seconds":1.0}"#);
    let before = number(&bench.state(), "/object/joint_state");
    bench.go(from, direction, 0.02, 200);
    let report = bench.state();
    assert_eq!(number(&report, "/object/joint_state"), before);
    let pull = pull_n(&bench);
    assert!(pull > 20.0, "{pull} N on a jammed drawer");
    bench.cycles(300);
    let pull = mean_pull_n(&mut bench, 100);
    assert!(pull < 10.0, "{pull} N after it came free");
}

#[test]
fn somebody_pulling_is_felt_the_other_way_for_as_long() {
    let mut bench = drawer();
    let before = mean_pull_n(&mut bench, 100);
    bench.control(r#"{"do":"pull","force_n":30.0,"seconds":0.7}"#);
    bench.cycles(100);
    let pulled = mean_pull_n(&mut bench, 90);
    assert!(
        pulled < before - 15.0,
        "{pulled} N while 30 N pull, {before} N before"
    );
    bench.cycles(100);
    let after = mean_pull_n(&mut bench, 100);
    assert!(
        (after - before).abs() < 12.0,
        "{after} N after, {before} N before"
    );
}

#[test]
fn sensor_shows_bias_steps_drifts_and_its_limit() {
    let mut bench = drawer();
    let before = mean_pull_n(&mut bench, 100);
    bench.control(r#"{"do":"bias_step","force_n":[0.0,0.0,-4.0]}"#);
    let stepped = mean_pull_n(&mut bench, 100);
    assert!(
        (stepped - before - 4.0).abs() < 0.3,
        "{stepped} N, {before} N before"
    );
    bench.control(r#"{"do":"bias_rate","force_n_per_s":[0.0,0.0,-10.0]}"#);
    bench.cycles(286);
    let drifted = pull_n(&bench);
    assert!(
        (drifted - before - 14.0).abs() < 1.5,
        "{drifted} N after 1 s at 10 N/s"
    );
    bench.control(r#"{"do":"saturate","limit_n":5.0}"#);
    assert!(pull_n(&bench) <= 5.0);
    bench.control(r#"{"do":"clear"}"#);
    let cleared = mean_pull_n(&mut bench, 100);
    assert!(
        (cleared - before).abs() < 0.4,
        "{cleared} N, {before} N at first"
    );
}

#[test]
fn sensor_has_its_bias_and_axes() {
    let shown = |words: &[&str]| {
        let words = [&["--world", "drawer1", "--start", "0.3"], words].concat();
        let mut bench = Bench::new(&words);
        let mut sum = Vector3::zeros();
        for _ in 0..300 {
            bench.cycles(1);
            sum += bench.machine.controller.scene.shown().force;
        }
        sum / 300.0
    };
    let plain = shown(&["--sensor-bias", "0,0,0"]);
    let biased = shown(&["--sensor-bias", "1,-2,30"]);
    let difference = biased - plain - Vector3::new(1.0, -2.0, 30.0);
    assert!(difference.norm() < 1e-9, "off by {difference:?}");
    let turned = shown(&["--sensor-bias", "0,0,0", "--sensor-axes", "-z,x,y"]);
    let wanted = Vector3::new(-plain.z, plain.x, plain.y);
    assert!((turned - wanted).norm() < 1e-9, "{turned:?} of {plain:?}");
}

#[test]
fn fingers_close_as_the_arm_begins_to_move() {
    let words = [DRAWER, &["--grasp", "on-motion"]].concat();
    let mut bench = Bench::ready(&words, "Mxt 1,0,10");
    assert_eq!(bench.state()["object"]["held"], false);
    let open = mean_pull_n(&mut bench, 200);
    assert!(open.abs() < 1.0, "{open} N in open fingers");
    let from = bench.handshake();
    let direction = bench.opening();
    let before = number(&bench.state(), "/object/joint_state");
    bench.go(from, direction, 0.05, 200);
    let report = bench.state();
    assert_eq!(report["object"]["held"], true);
    assert!(number(&report, "/object/joint_state") > before + 0.02);
}

#[test]
fn stops_bring_the_arm_to_rest_within_its_accelerations() {
    let cases = [
        (r#"{"do":"emergency_stop"}"#, alarm::EMERGENCY_STOP),
        (r#"{"do":"contact_stop"}"#, alarm::CONTACT),
        (
            r#"{"do":"alarm","number":1234,"text":"Something else"}"#,
            1234,
        ),
    ];
    for (line, alarm) in cases {
        let mut bench = drawer();
        let from = bench.handshake();
        let direction = bench.opening();
        let target = bench.go(from, direction, 0.15, 250);
        bench.control(r#"{"do":"reset_peaks"}"#);
        bench.control(line);
        assert!(bench.send(&to_pose(target)).is_none(), "{line}: a reply");
        assert!(
            bench.state()["rest_after_fault_s"].is_null(),
            "{line}: at rest at once"
        );
        bench.cycles(60);
        let report = bench.state();
        assert_eq!(bench.alarm(), alarm, "{line}");
        assert_eq!(report["at_rest"], true, "{line}");
        assert_eq!(report["servo"], "off", "{line}");
        let after_s = number(&report, "/rest_after_fault_s");
        assert!(
            (0.005..0.1).contains(&after_s),
            "{line}: at rest after {after_s} s"
        );
        let most = number(&report, "/peaks/tool_acceleration_m_s2");
        assert!(most < 8.0, "{line}: {most} m/s² in the stop");
    }
}

#[test]
fn arm_that_hears_nothing_more_stops_where_it_was_sent() {
    let mut bench = drawer();
    let from = bench.handshake();
    let direction = bench.opening();
    let target = bench.go(from, direction, 0.1, 200);
    bench.cycles(100);
    assert!(bench.machine.controller.measure.at_rest);
    let error = (bench.tool_m() - target.position_m()).norm();
    assert!(error < 1e-7, "{error} m from its target");
    let next = ahead(&target, direction * 1e-4);
    assert!(
        bench.send(&to_pose(next)).is_some(),
        "and it goes on from there"
    );
}

#[test]
fn arm_and_object_can_be_put_to_another_start_between_runs() {
    let mut bench = drawer();
    let from = bench.handshake();
    let direction = bench.opening();
    bench.go(from, direction, 0.05, 100);
    let refused = bench.machine.command(r#"{"do":"place","start":0.8}"#);
    assert_eq!(refused["ok"], false, "placed while the program runs");
    bench.r3("1;1;STOP");
    bench.cycles(50);
    bench.control(r#"{"do":"place","start":0.8,"seed":3}"#);
    let report = bench.state();
    let found = number(&report, "/object/joint_state");
    assert!(
        (found - 0.8 * 0.25).abs() < 0.002,
        "the drawer is at {found} m"
    );
    assert_eq!(report["at_rest"], true);
    assert_eq!(report["servo"], "on", "the controller's state stays");
    bench.start();
    let from = bench.handshake();
    bench.go(from, -direction, 0.05, 100);
    let moved = found - number(&bench.state(), "/object/joint_state");
    assert!((0.005..0.02).contains(&moved), "it moved by {moved} m");
    for line in [
        r#"{"do":"place","start":2}"#,
        r#"{"do":"place","begin":0.1}"#,
    ] {
        assert_eq!(bench.machine.command(line)["ok"], false, "{line}");
    }
}

#[test]
fn monitor_streams_what_was_asked_for() {
    let words = [DRAWER, &["--sensor-id", "202"]].concat();
    let mut bench = Bench::new(&words);
    let listener = "127.0.0.1:40000".parse().unwrap();
    let start = monitor::Request::start([202, FEEDBACK_POSE, FEEDBACK_JOINT, 555]);
    bench.machine.monitor.hear(&start.encode()[..100], listener);
    assert!(
        bench.machine.monitor_packets().is_empty(),
        "a short packet subscribes nobody"
    );
    bench.machine.monitor.hear(&start.encode(), listener);
    for count in 1..=3 {
        bench.cycles(1);
        let packets = bench.machine.monitor_packets();
        let [(to, bytes)] = packets.as_slice() else {
            panic!("{} packets", packets.len());
        };
        assert_eq!(*to, listener);
        let reply = monitor::Reply::decode(bytes, 202).unwrap();
        assert_eq!(reply.count, count);
        let views = bench.machine.controller.views();
        assert_eq!(
            reply.get(FEEDBACK_POSE),
            Some(&Value::Pose(views.feedback_pose()))
        );
        assert_eq!(
            reply.get(FEEDBACK_JOINT),
            Some(&Value::Joint(views.feedback_joint()))
        );
        assert_eq!(reply.get(555), Some(&Value::Other([0; 40])), "zeros");
        let Some(Value::Force { force_n, torque_nm }) = reply.get(202) else {
            panic!("{reply:?}");
        };
        let shown = bench.machine.controller.scene.shown();
        assert_eq!(f64::from(force_n[2]) as f32, shown.force.z as f32);
        assert_eq!(torque_nm[0], shown.torque.x as f32);
    }
    let other = "127.0.0.1:40001".parse().unwrap();
    bench
        .machine
        .monitor
        .hear(&monitor::Request::start([FORCE, 0, 0, 0]).encode(), other);
    assert_eq!(bench.machine.monitor_packets().len(), 2);
    bench
        .machine
        .monitor
        .hear(&monitor::Request::End.encode(), listener);
    let packets = bench.machine.monitor_packets();
    assert_eq!(packets.len(), 1);
    assert_eq!(packets[0].0, other);
}
