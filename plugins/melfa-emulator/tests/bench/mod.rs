//! The machine without sockets and clocks: cycle by cycle, so that every test is exact.

#![allow(dead_code, clippy::unwrap_used)]

use std::net::SocketAddr;

use nalgebra::Vector3;
use pubs_melfa_emulator::machine::Machine;
use pubs_melfa_emulator::{Options, build, command};
use pubs_melfa_protocol::Pose;
use pubs_melfa_protocol::mxt::{Command, Data, DataType, Reply, Request};
use serde_json::Value;

pub const RECEIVE: [DataType; 4] = [
    DataType::FeedbackPose,
    DataType::FeedbackJoint,
    DataType::FilteredPose,
    DataType::CommandPose,
];

pub struct Bench {
    pub machine: Machine,
    pub client: SocketAddr,
}

impl Bench {
    /// Options beside the defaults.
    pub fn new(words: &[&str]) -> Self {
        let options = Options::from_words(words).unwrap();
        let (machine, warning) = build(&options).unwrap();
        assert_eq!(warning, None);
        Self {
            machine,
            client: "127.0.0.1:50000".parse().unwrap(),
        }
    }

    /// As a client would be ready to move: servo on, a program at its `Mxt` line.
    pub fn ready(words: &[&str], mxt: &str) -> Self {
        let mut bench = Self::new(words);
        bench.upload(mxt);
        bench.start();
        bench
    }

    pub fn upload(&mut self, mxt: &str) {
        let lines = format!("1 Open \"ENET:127.0.0.1\" As #1\u{b}2 {mxt}\u{b}3 Hlt\u{b}4 End");
        for request in ["1;1;NEW", "1;1;LOAD=PUBS", "1;9;ECLR"] {
            assert_eq!(self.r3(request), "QoK");
        }
        assert_eq!(self.r3(&format!("1;9;EMDAT{lines}")), "QoK");
        assert_eq!(self.r3("1;1;SAVE"), "QoK");
    }

    pub fn start(&mut self) {
        assert_eq!(self.r3("1;1;CNTLON"), "QoK");
        assert_eq!(self.r3("1;1;SRVON"), "QoK");
        self.cycles(100);
        assert_eq!(self.r3("1;1;SLOTINIT"), "QoK");
        assert_eq!(self.r3("1;1;RUNPUBS;1"), "QoK");
        self.cycles(2);
    }

    /// Answer to a request of connection 1.
    pub fn r3(&mut self, text: &str) -> String {
        self.r3_as(1, text)
    }

    pub fn r3_as(&mut self, connection: u64, text: &str) -> String {
        command::answer(&mut self.machine.controller, text, connection).to_string()
    }

    /// Answer to a line of the control socket.
    pub fn control(&mut self, line: &str) -> Value {
        let answer = self.machine.command(line);
        assert_eq!(answer["ok"], true, "{line}: {answer}");
        answer
    }

    pub fn state(&mut self) -> Value {
        self.control(r#"{"do":"state"}"#)
    }

    /// Number of the present alarm, 0 without.
    pub fn alarm(&self) -> u32 {
        let alarm = self.machine.controller.alarm.as_ref();
        alarm.map_or(0, |alarm| alarm.number)
    }

    pub fn cycles(&mut self, count: u32) {
        for _ in 0..count {
            self.machine.cycle(&[]);
        }
    }

    /// A cycle with this packet; its reply.
    pub fn send(&mut self, request: &Request) -> Option<Reply> {
        self.send_bytes(&request.encode(), self.client)
    }

    pub fn send_bytes(&mut self, bytes: &[u8], from: SocketAddr) -> Option<Reply> {
        let replies = self.machine.cycle(&[(from, bytes.to_vec())]);
        assert!(replies.len() <= 1, "one reply to one packet");
        let (to, bytes) = replies.first()?;
        assert_eq!(*to, from);
        Some(Reply::decode(bytes).unwrap())
    }

    /// The handshake; where the tool is.
    pub fn handshake(&mut self) -> Pose {
        let reply = self.send(&null()).expect("a reply to the handshake");
        pose(&reply, DataType::FeedbackPose)
    }

    /// Where the tool is, m, base frame.
    pub fn tool_m(&self) -> Vector3<f64> {
        self.machine.controller.views().feedback_pose().position_m()
    }

    /// Opening direction of the object in the base frame: away from where the tool points.
    pub fn opening(&self) -> Vector3<f64> {
        let tool = self.machine.controller.views().feedback_pose();
        tool.orientation() * -Vector3::z()
    }

    /// Moves the target along a line, `speed_m_s` reached at 1 m/s², for this many cycles; where
    /// the target is at last.
    pub fn go(&mut self, from: Pose, direction: Vector3<f64>, speed_m_s: f64, cycles: u32) -> Pose {
        let cycle_s = self.machine.controller.cycle_s();
        let (mut speed, mut way) = (0.0f64, 0.0);
        let mut target = from;
        for _ in 0..cycles {
            speed = (speed + cycle_s).min(speed_m_s);
            way += speed * cycle_s;
            target = ahead(&from, direction * way);
            assert!(
                self.send(&to_pose(target)).is_some(),
                "no reply: {:?}",
                self.machine.controller.alarm
            );
        }
        target
    }
}

/// The pose displaced by this, m.
pub fn ahead(from: &Pose, way: Vector3<f64>) -> Pose {
    let moved = (from.position_m() + way) * 1000.0;
    Pose {
        position_mm: moved.map(|value| value as f32).into(),
        ..*from
    }
}

pub fn null() -> Request {
    Request {
        receive: RECEIVE,
        ..Request::default()
    }
}

pub fn to_pose(target: Pose) -> Request {
    Request {
        command: Command::Move,
        send: DataType::CommandPose,
        data: Data::Pose(target),
        receive: RECEIVE,
        ..Request::default()
    }
}

pub fn to_joints(target: [f32; 8]) -> Request {
    Request {
        command: Command::Move,
        send: DataType::CommandJoint,
        data: Data::Joint(target),
        receive: RECEIVE,
        ..Request::default()
    }
}

#[track_caller]
pub fn pose(reply: &Reply, data_type: DataType) -> Pose {
    match reply.get(data_type) {
        Some(Data::Pose(pose)) => *pose,
        other => panic!("no pose of {data_type:?} but {other:?}"),
    }
}

#[track_caller]
pub fn joints(reply: &Reply, data_type: DataType) -> [f32; 8] {
    match reply.get(data_type) {
        Some(Data::Joint(joints)) => *joints,
        other => panic!("no joints of {data_type:?} but {other:?}"),
    }
}
