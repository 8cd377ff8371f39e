//! A general object for plugins that need no parameters of their own.

use pubs_plugin::{
    ActionSetup, BeliefSetup, ControlSetup, DriverSetup, JointSetup, JointType, Mode, ModelSetup,
};
use serde_json::json;

/// Hinge axis to handle, m.
const RADIUS_M: f64 = 0.32;
const SAFE_SPEED_M_S: f64 = 0.05;
const HIGH_SPEED_M_S: f64 = 0.15;
const POLICY_RATE_HZ: f64 = 10.0;
const PARTICLES: u32 = 300;

/// A door of 0 to 125 degrees, for an observation model called `model`.
pub fn door(model: &str) -> ModelSetup {
    let joint = joint();
    let spacing = (joint.upper - joint.lower) / f64::from(PARTICLES - 1);
    ModelSetup {
        joint,
        actions: actions(),
        control: Some(control()),
        belief: BeliefSetup {
            particles: PARTICLES,
            spacing,
        },
        observation: json!({ "model": model, "bias_sd_n": 0.0, "correlation_m": 0.0 }),
        seed: 1,
    }
}

/// The same door, for a driver called `driver`.
pub fn door_driver(driver: &str) -> DriverSetup {
    DriverSetup {
        joint: joint(),
        actions: actions(),
        control: control(),
        driver: json!({ "plugin": driver }),
        seed: 1,
    }
}

fn joint() -> JointSetup {
    JointSetup {
        r#type: JointType::Revolute,
        lower: 0.0,
        upper: 125_f64.to_radians(),
        integer: false,
        radius_m: Some(RADIUS_M),
        opening_direction: Some([0.0, 0.0, -1.0]),
        hinge_direction: Some([1.0, 0.0, 0.0]),
        up_direction: Some([0.0, 1.0, 0.0]),
        motion_threshold_m: Some(0.0005),
    }
}

fn actions() -> Vec<ActionSetup> {
    let action = |name: &str, mode, speed_m_s: f64| ActionSetup {
        name: name.to_owned(),
        stop: speed_m_s == 0.0,
        mode,
        displacement: speed_m_s / POLICY_RATE_HZ / RADIUS_M,
        observations: 3,
    };
    vec![
        action("stop", Mode::Safe, 0.0),
        action("safe_open", Mode::Safe, SAFE_SPEED_M_S),
        action("safe_close", Mode::Safe, -SAFE_SPEED_M_S),
        action("high_open", Mode::HighForce, HIGH_SPEED_M_S),
        action("high_close", Mode::HighForce, -HIGH_SPEED_M_S),
    ]
}

fn control() -> ControlSetup {
    ControlSetup {
        rate_hz: 100.0,
        safe_speed_m_s: SAFE_SPEED_M_S,
        high_speed_m_s: HIGH_SPEED_M_S,
        force_threshold_n: 15.0,
        force_limit_n: 60.0,
        acceleration_m_s2: 1.0,
        stop_deceleration_m_s2: 5.0,
        contact_stiffness_n_per_m: 5000.0,
    }
}
