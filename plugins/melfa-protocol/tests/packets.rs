//! Packets worked out by hand, byte by byte.

#![allow(clippy::unwrap_used)]

use std::f32::consts::PI;

use pubs_melfa_protocol::monitor::{self, Value};
use pubs_melfa_protocol::mxt::{Command, Data, DataType, Io, Reply, Request};
use pubs_melfa_protocol::{PACKET_LEN, PacketError, Pose};

/// A packet of zeros but for these bytes, each run at its offset.
fn packet(runs: &[(usize, &[u8])]) -> [u8; PACKET_LEN] {
    let mut bytes = [0; PACKET_LEN];
    for (at, run) in runs {
        bytes[*at..at + run.len()].copy_from_slice(run);
    }
    bytes
}

#[track_caller]
fn same(found: &[u8; PACKET_LEN], wanted: &[u8; PACKET_LEN]) {
    let first = (0..PACKET_LEN).find(|&at| found[at] != wanted[at]);
    if let Some(at) = first {
        panic!(
            "byte {at:#x} is {:#04x}, not {:#04x}",
            found[at], wanted[at]
        );
    }
}

const MONITORS: [DataType; 4] = [
    DataType::FeedbackPose,
    DataType::FeedbackJoint,
    DataType::FilteredPose,
    DataType::FeedbackCurrent,
];

/// RecvType of slots 1 to 3: 8, 4, 11.
const MONITOR_TYPES: [(usize, &[u8]); 3] = [(0x40, &[8]), (0x6c, &[4]), (0x98, &[11])];

fn target() -> Pose {
    Pose {
        position_mm: [450.0, -25.5, 380.25],
        angles_rad: [PI, 0.0, PI],
        extra: [0.0; 2],
        posture: 7,
        turns: 0,
    }
}

/// 450.0, -25.5, 380.25, pi, 0, pi, 0, 0 as floats, then 7 and 0.
const TARGET: &[u8] = &[
    0x00, 0x00, 0xe1, 0x43, 0x00, 0x00, 0xcc, 0xc1, 0x00, 0x20, 0xbe, 0x43, 0xdb, 0x0f, 0x49, 0x40,
    0, 0, 0, 0, 0xdb, 0x0f, 0x49, 0x40, 0, 0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0,
];

/// 449.98, -25.49, 380.24 and the same angles and flags.
const FEEDBACK: &[u8] = &[
    0x71, 0xfd, 0xe0, 0x43, 0x85, 0xeb, 0xcb, 0xc1, 0xb8, 0x1e, 0xbe, 0x43, 0xdb, 0x0f, 0x49, 0x40,
    0, 0, 0, 0, 0xdb, 0x0f, 0x49, 0x40, 0, 0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0,
];

fn feedback() -> Pose {
    Pose {
        position_mm: [449.98, -25.49, 380.24],
        ..target()
    }
}

#[test]
fn null_request_asks_and_commands_nothing() {
    let request = Request {
        receive: MONITORS,
        ..Request::default()
    };
    let mut runs = vec![(4, &[7u8][..])];
    runs.extend(MONITOR_TYPES);
    same(&request.encode(), &packet(&runs));
    assert_eq!(Request::decode(&packet(&runs)).unwrap(), request);
}

#[test]
fn move_request_has_its_target_in_the_first_slot() {
    let request = Request {
        command: Command::Move,
        send: DataType::CommandPose,
        data: Data::Pose(target()),
        receive: MONITORS,
        count: 1,
        ..Request::default()
    };
    let mut runs = vec![(0, &[1u8, 0, 1, 0, 7][..]), (8, TARGET), (60, &[1])];
    runs.extend(MONITOR_TYPES);
    same(&request.encode(), &packet(&runs));
    assert_eq!(Request::decode(&packet(&runs)).unwrap(), request);
}

#[test]
fn reply_has_what_was_asked_for() {
    let joints = [
        -0.056_548_666,
        0.350_811_18,
        1.666_789_4,
        0.0,
        1.123_992,
        -0.056_548_666,
        0.0,
        0.0,
    ];
    let mut joint_bytes = vec![];
    for joint in joints {
        joint_bytes.extend(f32::to_le_bytes(joint));
    }
    let reply = Reply {
        command: 1,
        data: [
            (DataType::FeedbackPose, Data::Pose(feedback())),
            (DataType::FeedbackJoint, Data::Joint(joints)),
            (DataType::FilteredPose, Data::Pose(target())),
            (
                DataType::FeedbackCurrent,
                Data::Current([4, -7, 12, 0, 3, 0, 0, 0]),
            ),
        ],
        count: 2,
        ..Reply::default()
    };
    let current = [
        4, 0, 0, 0, 0xf9, 0xff, 0xff, 0xff, 12, 0, 0, 0, 0, 0, 0, 0, 3,
    ];
    let mut runs = vec![
        (0, &[1u8, 0, 7, 0, 7][..]),
        (8, FEEDBACK),
        (60, &[2]),
        (0x44, &joint_bytes),
        (0x70, TARGET),
        (0x9c, &current),
    ];
    runs.extend(MONITOR_TYPES);
    // The first and third joint, as bytes.
    assert_eq!(joint_bytes[..4], [0x93, 0x9f, 0x67, 0xbd]);
    assert_eq!(joint_bytes[8..12], [0x5b, 0x59, 0xd5, 0x3f]);
    same(&reply.encode(), &packet(&runs));
    assert_eq!(Reply::decode(&packet(&runs)).unwrap(), reply);
    let found = reply.get(DataType::FilteredPose);
    assert_eq!(found, Some(&Data::Pose(target())));
    assert_eq!(reply.get(DataType::CommandJoint), None);
}

#[test]
fn reply_may_name_its_first_type_in_one_field_alone() {
    for at in [2, 4] {
        let reply = Reply::decode(&packet(&[(at, &[7]), (8, FEEDBACK)])).unwrap();
        assert_eq!(
            reply.data[0],
            (DataType::FeedbackPose, Data::Pose(feedback())),
            "type in byte {at}"
        );
    }
}

#[test]
fn end_request_is_its_command_alone() {
    let request = Request {
        command: Command::End,
        ..Request::default()
    };
    same(&request.encode(), &packet(&[(0, &[255])]));
    assert_eq!(Request::decode(&packet(&[(0, &[255])])).unwrap(), request);
}

#[test]
fn signals_and_counters_stand_in_their_places() {
    let reply = Reply {
        io: Io {
            send: 2,
            receive: 0,
            first_bit: 900,
            mask: 0,
            data: 0xabcd,
        },
        timeout_count: 0x1234,
        count: 0x0102_0304,
        ..Reply::default()
    };
    let runs: [(usize, &[u8]); 5] = [
        (48, &[2]),
        (52, &[0x84, 0x03]),
        (56, &[0xcd, 0xab]),
        (58, &[0x34, 0x12]),
        (60, &[4, 3, 2, 1]),
    ];
    same(&reply.encode(), &packet(&runs));
    let request = Request {
        io: Io {
            send: 1,
            receive: 2,
            first_bit: 16,
            mask: 0xff00,
            data: 0x5500,
        },
        ..Request::default()
    };
    let runs: [(usize, &[u8]); 5] = [
        (48, &[1]),
        (50, &[2]),
        (52, &[16]),
        (54, &[0, 0xff]),
        (56, &[0, 0x55]),
    ];
    same(&request.encode(), &packet(&runs));
    assert_eq!(Request::decode(&packet(&runs)).unwrap(), request);
}

#[test]
fn what_is_no_packet_is_refused() {
    for length in [0, 4, 195, 197, 392] {
        let found = Request::decode(&vec![0; length]);
        assert_eq!(found, Err(PacketError::Length { found: length }));
    }
    let found = Request::decode(&packet(&[(0, &[2])]));
    assert_eq!(found, Err(PacketError::Command { found: 2 }));
    for at in [2, 4, 0x40, 0x6c, 0x98] {
        let found = Request::decode(&packet(&[(at, &[12])]));
        assert_eq!(found, Err(PacketError::DataType { found: 12, at }));
    }
    let found = Reply::decode(&packet(&[(0x98, &[0, 1])]));
    let wanted = PacketError::DataType {
        found: 256,
        at: 0x98,
    };
    assert_eq!(found, Err(wanted));
    assert!(Reply::decode(&[0; 100]).is_err());
    assert!(monitor::Reply::decode(&[0; 100], 101).is_err());
    assert!(monitor::Request::decode(&packet(&[(0, &[2])])).is_err());
}

#[test]
fn monitor_requests_start_and_end_a_stream() {
    let start = monitor::Request::start([monitor::FORCE, monitor::FEEDBACK_POSE, 0, 0]);
    let bytes = packet(&[(0, &[1, 0, 0, 0, 0x65]), (0x40, &[0xef, 0x03])]);
    same(&start.encode(), &bytes);
    assert_eq!(monitor::Request::decode(&bytes).unwrap(), start);
    let end = packet(&[(0, &[0xff])]);
    same(&monitor::Request::End.encode(), &end);
    assert_eq!(
        monitor::Request::decode(&end).unwrap(),
        monitor::Request::End
    );
}

#[test]
fn monitor_reply_has_force_where_its_id_is() {
    let force: &[u8] = &[
        0x00, 0x00, 0xa0, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x40, 0x41, 0x8f, 0xc2, 0xf5,
        0x3c, 0xcd, 0xcc, 0xcc, 0xbd, 0, 0, 0, 0,
    ];
    let bytes = packet(&[
        (0, &[1, 0, 0, 0, 0x65]),
        (8, force),
        (60, &[0xd2, 0x04]),
        (0x40, &[0xef, 0x03]),
        (0x44, FEEDBACK),
    ]);
    let reply = monitor::Reply {
        slots: [
            (
                101,
                Value::Force {
                    force_n: [1.25, -0.5, 12.0],
                    torque_nm: [0.03, -0.1, 0.0],
                },
            ),
            (1007, Value::Pose(feedback())),
            (0, Value::None),
            (0, Value::None),
        ],
        inputs: 0,
        outputs: 0,
        count: 1234,
    };
    same(&reply.encode(), &bytes);
    assert_eq!(monitor::Reply::decode(&bytes, 101).unwrap(), reply);
    let elsewhere = monitor::Reply::decode(&bytes, 102).unwrap();
    assert!(
        matches!(elsewhere.get(101), Some(Value::Other(_))),
        "id 101 is no force where the sensor has id 102: {:?}",
        elsewhere.get(101)
    );
}
