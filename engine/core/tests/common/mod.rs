//! A task that needs no object file.
#![allow(dead_code, reason = "each test file uses its own part")]

use nalgebra::Vector3;
use pubs_core::belief::BeliefSettings;
use pubs_core::controller::Control;
use pubs_core::joint::Geometry;
use pubs_core::reward::{Reward, Shape};
use pubs_core::shield::Shield;
use pubs_core::task::{ObservationTable, PolicySettings};
use pubs_core::{Action, Joint, JointKind, Mode, Motion, Task};

/// Numbers of a small door: 0 to 2 rad, radius 0.5 m.
pub fn door(particles: usize) -> Task {
    let geometry = Geometry {
        opening_direction: Vector3::new(0.0, 0.0, -1.0),
        up_direction: Vector3::new(0.0, 1.0, 0.0),
        motion_threshold_m: 0.0005,
    };
    let kind = JointKind::Revolute {
        radius_m: 0.5,
        geometry,
        hinge_direction: Vector3::new(1.0, 0.0, 0.0),
    };
    let moving = |name: &str, mode, displacement| Action {
        name: name.to_owned(),
        motion: Motion::Move {
            mode,
            displacement,
            observations: 3,
        },
    };
    Task {
        name: "test door".to_owned(),
        sensor: None,
        joint: Joint {
            kind,
            lower: 0.0,
            upper: 2.0,
            start: (0.0, 2.0),
        },
        default_goal: None,
        actions: vec![
            Action {
                name: "stop".to_owned(),
                motion: Motion::Stop,
            },
            moving("safe_open", Mode::Safe, 0.01),
            moving("safe_close", Mode::Safe, -0.01),
            moving("high_open", Mode::HighForce, 0.03),
            moving("high_close", Mode::HighForce, -0.03),
        ],
        stop: 0,
        control: Some(control()),
        belief: BeliefSettings {
            particles,
            rate_hz: 30.0,
            tempering: 1.0,
            reading_spacing: 0.0,
            force_bias: None,
        },
        policy: PolicySettings {
            rate_hz: 10.0,
            layers: vec![64, 64, 64],
            shield: Shield {
                mass: 0.001,
                flattening: 0.3,
            },
        },
        reward: Reward {
            shape: Shape::Proximity,
            goal_tolerance: 0.1,
            goal: 1.0,
            failed_stop: -1.0,
            safety_violation: -1.0,
            time: -0.001,
            discount: 0.99,
        },
        driver: None,
        observation: ObservationTable {
            model: "test".to_owned(),
            bias_sd_n: 0.0,
            correlation: 0.0,
            table: serde_json::Value::Null,
        },
    }
}

pub fn control() -> Control {
    Control {
        rate_hz: 100.0,
        safe_speed_m_s: 0.05,
        high_speed_m_s: 0.15,
        force_threshold_n: 15.0,
        force_limit_n: 60.0,
        acceleration_m_s2: 1.0,
        stop_deceleration_m_s2: 5.0,
        contact_stiffness_n_per_m: 5000.0,
    }
}
