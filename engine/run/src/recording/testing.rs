//! A recording by hand, for tests.

use pubs_plugin::{DriverStatus, JointType, Reading};

use super::{FORMAT_VERSION, Frame, Header};

pub fn header() -> Header {
    Header {
        format: FORMAT_VERSION,
        engine: "0.1.0".to_owned(),
        object: "door2".to_owned(),
        joint: JointType::Revolute,
        sensor: "virtual-arm".to_owned(),
        actions: ["stop", "safe_open"].map(str::to_owned).to_vec(),
        rate_hz: 100.0,
        seed: 7,
    }
}

/// Number `index` of a steady pull.
pub fn frame(index: u64) -> Frame {
    Frame {
        reading: Reading {
            time_ns: 1_000_000_000 + index * 10_000_000,
            position_m: [0.5, 0.0, 0.0005 * index as f64],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            force_n: [0.1, 0.2, 3.0],
            torque_nm: [0.0; 3],
            status: DriverStatus::Ready,
        },
        action: 1,
        demonstration: 1,
        speed_m_s: 0.05,
        settled: true,
        truth: None,
    }
}
