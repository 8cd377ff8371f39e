//! The driver as the engine uses it: frames and signs, time, expiry, repeatability, refusals.

#![allow(clippy::unwrap_used)]

use pubs_plugin::{
    ControlSetup, Driver, DriverSetup, DriverStatus, JointSetup, JointType, Reading, Twist,
};
use pubs_virtual_arm::VirtualArm;
use serde_json::{Value, json};

const MS: u64 = 1_000_000;

fn setup(params: Value, seed: u64) -> DriverSetup {
    DriverSetup {
        joint: JointSetup {
            r#type: JointType::Revolute,
            lower: 0.0,
            upper: 125f64.to_radians(),
            integer: false,
            radius_m: Some(0.32),
            opening_direction: Some([0.0, 0.0, -1.0]),
            hinge_direction: Some([1.0, 0.0, 0.0]),
            up_direction: Some([0.0, 1.0, 0.0]),
            motion_threshold_m: Some(0.0005),
        },
        actions: Vec::new(),
        control: ControlSetup {
            rate_hz: 100.0,
            safe_speed_m_s: 0.05,
            high_speed_m_s: 0.15,
            force_threshold_n: 15.0,
            force_limit_n: 60.0,
            acceleration_m_s2: 1.0,
            stop_deceleration_m_s2: 5.0,
            contact_stiffness_n_per_m: 5000.0,
        },
        driver: json!({ "plugin": "virtual-arm", "params": params }),
        seed,
    }
}

fn door2(start: f64, seed: u64) -> VirtualArm {
    VirtualArm::open(&setup(json!({ "world": "door2", "start": start }), seed)).unwrap()
}

/// Moves along base x.
fn along_x(speed_m_s: f64) -> Twist {
    Twist {
        linear_m_s: [speed_m_s, 0.0, 0.0],
        angular_rad_s: [0.0; 3],
    }
}

fn refusal(params: Value) -> String {
    VirtualArm::open(&setup(params, 1))
        .err()
        .unwrap()
        .to_string()
}

/// Every bit of a reading.
fn bytes(reading: &Reading) -> Vec<u64> {
    let numbers = reading.position_m.iter().chain(&reading.orientation_xyzw);
    let numbers = numbers.chain(&reading.force_n).chain(&reading.torque_nm);
    numbers
        .map(|number| number.to_bits())
        .chain([reading.time_ns, reading.status as u64])
        .collect()
}

#[test]
fn closed_door_is_where_the_world_puts_it() {
    let mut arm = door2(0.0, 1);
    arm.advance_to(0).unwrap();
    let reading = arm.read().unwrap();
    for (found, expected) in reading.position_m.iter().zip([0.75, -0.15, 0.60]) {
        assert!(
            (found - expected).abs() < 1e-4,
            "tool at {:?}",
            reading.position_m
        );
    }
    assert_eq!(reading.orientation_xyzw, [0.5; 4]);
    assert!(arm.truth().unwrap().abs() < 1e-4, "closed is 0 rad");
    assert_eq!(reading.status, DriverStatus::Stopped);
}

#[test]
fn half_open_door_stands_62_5_degrees_round_its_hinge() {
    let mut arm = door2(0.5, 1);
    arm.advance_to(0).unwrap();
    let reading = arm.read().unwrap();
    // Hinge at (0.75, 0.17); the handle swings from base -y towards base -x.
    let (sine, cosine) = 62.5f64.to_radians().sin_cos();
    let expected = [0.75 - 0.32 * sine, 0.17 - 0.32 * cosine, 0.60];
    for (found, expected) in reading.position_m.iter().zip(expected) {
        assert!(
            (found - expected).abs() < 1e-4,
            "tool at {:?}, not {expected}",
            reading.position_m
        );
    }
}

#[test]
fn pulling_open_is_a_force_along_the_opening_direction_of_the_tool() {
    let mut arm = door2(0.0, 1);
    arm.advance_to(0).unwrap();
    arm.command(along_x(-0.02), 200 * MS).unwrap();
    arm.advance_to(150 * MS).unwrap();
    let opening = -arm.read().unwrap().force_n[2];
    assert!(
        opening > 8.0,
        "resistance of the catch to opening is positive, found {opening} N"
    );

    let mut arm = door2(0.0, 1);
    arm.advance_to(0).unwrap();
    arm.command(along_x(0.02), 200 * MS).unwrap();
    arm.advance_to(150 * MS).unwrap();
    let closing = arm.read().unwrap().force_n[2];
    assert!(
        closing > 6.0,
        "resistance of the stop to closing is positive, found {closing} N"
    );
}

#[test]
fn lifting_the_handle_is_a_force_up_in_tool_y() {
    let mut arm = door2(0.5, 1);
    arm.advance_to(0).unwrap();
    let before = arm.read().unwrap().force_n[1];
    let up = Twist {
        linear_m_s: [0.0, 0.0, 0.02],
        angular_rad_s: [0.0; 3],
    };
    arm.command(up, 100 * MS).unwrap();
    arm.advance_to(200 * MS).unwrap();
    let gained = arm.read().unwrap().force_n[1] - before;
    assert!(
        (gained - 6.0).abs() < 1.5,
        "2 mm on 3000 N/m are 6 N upwards, found {gained}"
    );
}

/// Sets a motion going that ends at 300 ms.
type End = fn(&mut VirtualArm);

#[test]
fn expiry_and_stop_end_in_a_ramp() {
    let ends: [(&str, End); 2] = [
        ("expiry", |arm| {
            arm.command(along_x(-0.15), 300 * MS).unwrap()
        }),
        ("stop", |arm| {
            arm.command(along_x(-0.15), 900 * MS).unwrap();
            arm.advance_to(300 * MS).unwrap();
            arm.stop().unwrap();
        }),
    ];
    for (name, begin) in ends {
        let mut arm = door2(0.4, 2);
        arm.advance_to(0).unwrap();
        begin(&mut arm);
        let mut at = |ms: u64| {
            arm.advance_to(ms * MS).unwrap();
            arm.read().unwrap()
        };
        let (start, end, later) = (at(301), at(332), at(600));
        let way = start.position_m[0] - end.position_m[0];
        assert!(
            (0.0015..0.0024).contains(&way),
            "{name}: v²/2a = 2.25 mm, went {way} m"
        );
        let creep = (later.position_m[0] - end.position_m[0]).abs();
        assert!(
            creep < 1e-4,
            "{name}: at rest after v/a = 30 ms, yet went {creep} m on"
        );
        assert_eq!(later.status, DriverStatus::Stopped, "{name}");
        arm.command(along_x(0.05), 700 * MS).unwrap();
        arm.advance_to(650 * MS).unwrap();
        assert_eq!(
            arm.read().unwrap().status,
            DriverStatus::Ready,
            "{name}: a command resumes"
        );
    }
}

#[test]
fn same_seed_and_calls_give_the_same_bytes() {
    let record = |seed: u64, warm_up: bool| {
        let mut arm = VirtualArm::open(&setup(json!({ "world": "door2" }), seed)).unwrap();
        if warm_up {
            arm.read().unwrap();
            arm.tare().unwrap();
        }
        arm.advance_to(5 * MS).unwrap();
        let mut all = Vec::new();
        for step in 0..100 {
            arm.command(along_x(-0.03), (5 + step * 10 + 50) * MS)
                .unwrap();
            arm.advance_to((5 + (step + 1) * 10) * MS).unwrap();
            all.extend(bytes(&arm.read().unwrap()));
            all.push(arm.truth().unwrap().to_bits());
        }
        all
    };
    assert!(record(7, false) == record(7, false), "the same seed");
    assert!(
        record(7, false) == record(7, true),
        "what was done in real time before leaves no trace"
    );
    assert!(record(7, false) != record(8, false), "another seed");
}

#[test]
fn reading_at_odd_times_changes_nothing() {
    let end = |times: &[u64]| {
        let mut arm = door2(0.3, 4);
        arm.advance_to(0).unwrap();
        arm.command(along_x(-0.04), 250 * MS).unwrap();
        for &time in times {
            arm.advance_to(time).unwrap();
            arm.read().unwrap();
        }
        arm.advance_to(400 * MS).unwrap();
        bytes(&arm.read().unwrap())
    };
    let odd = [
        1,
        777,
        3_333_333,
        3_333_334,
        16_666_667,
        99_999_999,
        100_000_001,
        250_000_000,
        399_999_999,
    ];
    assert_eq!(end(&[]), end(&odd));
}

#[test]
fn starts_cover_the_range() {
    let mut seen = [0u32; 5];
    for seed in 0..100 {
        let mut arm = VirtualArm::open(&setup(json!({ "world": "door2" }), seed)).unwrap();
        arm.advance_to(0).unwrap();
        let fraction = arm.truth().unwrap() / 125f64.to_radians();
        seen[((fraction * 5.0).max(0.0) as usize).min(4)] += 1;
    }
    assert!(
        seen.iter().all(|&count| count >= 8),
        "100 starts in five equal parts: {seen:?}"
    );
}

#[test]
fn paused_process_finds_the_arm_stopped_where_the_command_expired() {
    let mut arm = door2(0.5, 1);
    let start = arm.read().unwrap();
    arm.command(along_x(-0.05), start.time_ns + 40 * MS)
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(120));
    let end = arm.read().unwrap();
    assert_eq!(end.status, DriverStatus::Stopped);
    let way = start.position_m[0] - end.position_m[0];
    assert!(
        way < 0.0023,
        "at most 40 ms at 0.05 m/s and a ramp, went {way} m"
    );
    assert!(end.time_ns >= start.time_ns + 110 * MS, "time goes on");
}

#[test]
fn misuse_is_refused_in_words() {
    let mut arm = door2(0.5, 1);
    arm.advance_to(10 * MS).unwrap();
    let message = arm.advance_to(9 * MS).unwrap_err().to_string();
    assert!(message.contains("cannot go back"), "{message}");
    let message = arm
        .command(along_x(f64::NAN), 20 * MS)
        .unwrap_err()
        .to_string();
    assert!(message.contains("not finite"), "{message}");
    arm.command(along_x(-0.05), 100 * MS).unwrap();
    arm.advance_to(30 * MS).unwrap();
    let message = arm.tare().unwrap_err().to_string();
    assert!(message.contains("at rest"), "{message}");

    let mut arm = door2(0.5, 1);
    arm.command(along_x(0.0), 0).unwrap();
    let message = arm.advance_to(0).unwrap_err().to_string();
    assert!(message.contains("real time"), "{message}");
}

#[test]
fn faulty_params_are_named() {
    let cases = [
        (json!({}), "missing field `world`"),
        (json!({ "world": "door3" }), "built in: door1, door2"),
        (
            json!({ "world": "/nowhere/door.toml" }),
            "/nowhere/door.toml cannot be read",
        ),
        (
            json!({ "world": "drawer1" }),
            "has a slide, which the object's joint is not",
        ),
        (
            json!({ "world": "door2", "start": 1.5 }),
            "start = 1.5, but it must lie in 0 to 1",
        ),
        (
            json!({ "world": "door2", "sensor_offset_n": [0.0, 0.0, -101.0] }),
            "|sensor_offset_n| = 101, but it must lie in 0 to 100",
        ),
        (
            json!({ "world": "door2", "frictoin_scale": 1.0 }),
            "unknown field `frictoin_scale`",
        ),
    ];
    for (params, expected) in cases {
        let message = refusal(params.clone());
        assert!(message.contains(expected), "{params}: {message}");
    }
}

#[test]
fn an_offset_of_the_sensor_outlives_a_tare() {
    let rest = |params: Value| {
        let mut arm = VirtualArm::open(&setup(params, 1)).unwrap();
        arm.advance_to(0).unwrap();
        arm.tare().unwrap();
        arm.advance_to(100 * MS).unwrap();
        arm.read().unwrap().force_n
    };
    let plain = rest(json!({ "world": "door2", "start": 0.5 }));
    let offset = [1.0, -2.0, 3.0];
    let drifted = rest(json!({ "world": "door2", "start": 0.5, "sensor_offset_n": offset }));
    for axis in 0..3 {
        let difference = drifted[axis] - plain[axis];
        // The output comes in steps of 0.02 N.
        assert!(
            (difference - offset[axis]).abs() <= 0.021,
            "axis {axis} moved by {difference} N, not by {}",
            offset[axis]
        );
    }
}

#[test]
fn scales_change_the_forces() {
    let pull = |params: Value| {
        let mut arm = VirtualArm::open(&setup(params, 1)).unwrap();
        arm.advance_to(0).unwrap();
        arm.command(along_x(-0.02), 900 * MS).unwrap();
        arm.advance_to(800 * MS).unwrap();
        -arm.read().unwrap().force_n[2]
    };
    // 16 mm from the closed limit the catch is gone with any scale, the hinge holds 5 N.
    let held = pull(json!({ "world": "door2", "start": 0.0, "catch_scale": 10.0 }));
    let eased = pull(json!({ "world": "door2", "start": 0.0, "catch_scale": 0.0 }));
    assert!(held > 40.0, "ten times the catch still holds, {held} N");
    assert!(
        (4.0..9.0).contains(&eased),
        "without the catch only hinge and friction, {eased} N"
    );
}
