//! Messages as they are written; [`topic`](super::topic) has their schemas.

use pubs_plugin::{DriverStatus, Reading};
use serde::{Deserialize, Serialize};

use super::{Done, Frame, Observation};
use crate::report::LatenessReport;

const NS_PER_SECOND: u64 = 1_000_000_000;

#[derive(Serialize, Deserialize)]
pub(super) struct Time {
    sec: u64,
    nsec: u64,
}

impl From<u64> for Time {
    fn from(time_ns: u64) -> Self {
        Self {
            sec: time_ns / NS_PER_SECOND,
            nsec: time_ns % NS_PER_SECOND,
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

impl Time {
    pub fn ns(&self) -> u64 {
        self.sec
            .saturating_mul(NS_PER_SECOND)
            .saturating_add(self.nsec)
    }
}

impl From<[f64; 3]> for Xyz {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

#[derive(Serialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Serialize)]
struct PoseBody {
    position: Xyz,
    orientation: Quaternion,
}

#[derive(Serialize)]
pub(super) struct PoseMessage {
    timestamp: Time,
    frame_id: &'static str,
    pose: PoseBody,
}

impl From<&Reading> for PoseMessage {
    fn from(reading: &Reading) -> Self {
        let [x, y, z, w] = reading.orientation_xyzw;
        Self {
            timestamp: reading.time_ns.into(),
            frame_id: "base",
            pose: PoseBody {
                position: reading.position_m.into(),
                orientation: Quaternion { x, y, z, w },
            },
        }
    }
}

#[derive(Serialize)]
pub(super) struct WrenchMessage {
    timestamp: Time,
    frame_id: &'static str,
    force: Xyz,
    torque: Xyz,
}

impl From<&Reading> for WrenchMessage {
    fn from(reading: &Reading) -> Self {
        Self {
            timestamp: reading.time_ns.into(),
            frame_id: "tool",
            force: reading.force_n.into(),
            torque: reading.torque_nm.into(),
        }
    }
}

#[derive(Serialize)]
pub(super) struct ActionMessage<'a> {
    timestamp: Time,
    action: &'a str,
    demonstration: u32,
    speed_m_s: f64,
    settled: bool,
    status: &'static str,
}

impl<'a> ActionMessage<'a> {
    pub fn new(frame: &Frame, action: &'a str) -> Self {
        Self {
            timestamp: frame.reading.time_ns.into(),
            action,
            demonstration: frame.demonstration,
            speed_m_s: frame.speed_m_s,
            settled: frame.settled,
            status: status_name(frame.reading.status),
        }
    }
}

#[derive(Serialize)]
pub(super) struct ObservationMessage {
    timestamp: Time,
    displacement: f64,
    f_d: f64,
    f_z: f64,
    f_n: f64,
}

impl ObservationMessage {
    pub fn new(time_ns: u64, observation: &Observation) -> Self {
        let [f_d, f_z, f_n] = observation.forces_n;
        Self {
            timestamp: time_ns.into(),
            displacement: observation.displacement,
            f_d,
            f_z,
            f_n,
        }
    }
}

#[derive(Serialize)]
pub(super) struct TruthMessage {
    pub timestamp: Time,
    pub joint_state: f64,
}

#[derive(Serialize)]
pub(super) struct DemonstrationMessage<'a> {
    timestamp: Time,
    action: &'a str,
    demonstration: u32,
}

impl<'a> DemonstrationMessage<'a> {
    pub fn new(time_ns: u64, done: &'a Done) -> Self {
        Self {
            timestamp: time_ns.into(),
            action: &done.action,
            demonstration: done.demonstration,
        }
    }
}

#[derive(Serialize)]
pub(super) struct GuardMessage<'a> {
    pub timestamp: Time,
    pub reason: &'a str,
}

#[derive(Serialize)]
pub(super) struct TimingMessage<'a> {
    pub timestamp: Time,
    #[serde(flatten)]
    pub lateness: &'a LatenessReport,
}

/// A driver's status, as files spell it.
pub fn status_name(status: DriverStatus) -> &'static str {
    match status {
        DriverStatus::Ready => "ready",
        DriverStatus::Stopped => "stopped",
        DriverStatus::Fault => "fault",
    }
}

/// The status of that name.
pub fn status_named(name: &str) -> Option<DriverStatus> {
    [
        DriverStatus::Ready,
        DriverStatus::Stopped,
        DriverStatus::Fault,
    ]
    .into_iter()
    .find(|&status| status_name(status) == name)
}
