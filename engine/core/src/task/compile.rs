//! From a checked object file to a [`Task`]: units to SI, directions to unit vectors.

use nalgebra::Vector3;
use serde_json::Value;

use pubs_plugin::JointType;

use super::{DriverTable, ObservationTable, PolicySettings, Task};
use crate::belief::{BeliefSettings, ForceBias};
use crate::controller::Control;
use crate::joint::{Geometry, Joint, JointKind};
use crate::object::raw;
use crate::reward::{Reward, Shape};
use crate::shield::Shield;
use crate::{Action, Mode, Motion};

/// A key that the checks should have demanded; a fault of the engine, not of the user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is missing after the object file was checked; this is a bug")]
pub struct MissingKey(&'static str);

/// Compiles a file that has passed every check.
///
/// # Errors
/// [`MissingKey`] where a check has let something through.
pub fn compile(file: &raw::ObjectFile) -> Result<Task, MissingKey> {
    let joint = joint(&file.joint)?;
    let policy = PolicySettings {
        rate_hz: file.policy.rate_hz.unwrap_or(1.0),
        layers: file
            .policy
            .layers
            .iter()
            .map(|&width| width as usize)
            .collect(),
        shield: Shield {
            mass: file.policy.shield.mass,
            flattening: file.policy.shield.flattening,
        },
    };
    let control = file.control.as_ref().map(control);
    let belief = BeliefSettings {
        particles: file.belief.particles as usize,
        rate_hz: file.belief.rate_hz.unwrap_or(policy.rate_hz),
        tempering: file.belief.tempering,
        reading_spacing: file.belief.reading_spacing_m * joint.per_metre(),
        force_bias: match file.belief.filter {
            raw::Filter::Sis => None,
            raw::Filter::RaoBlackwell => Some(ForceBias {
                offset_sd_n: file.belief.offset_sd_n,
                offset_walk_n: file.belief.offset_walk_n,
                friction_sd_n: file.belief.friction_sd_n,
            }),
        },
    };
    let actions = match &control {
        Some(control) => arm_actions(&joint, control, &policy, &belief),
        None => file.actions.iter().map(abstract_action).collect(),
    };
    let stop = actions
        .iter()
        .position(Action::is_stop)
        .ok_or(MissingKey("action"))?;
    Ok(Task {
        name: file.name.clone(),
        sensor: file
            .source
            .as_ref()
            .and_then(|source| source.sensor.clone()),
        default_goal: file.joint.goal,
        actions,
        stop,
        control,
        belief,
        policy,
        reward: reward(&file.reward, &file.joint)?,
        driver: file.driver.as_ref().map(driver_table),
        observation: ObservationTable {
            model: file.observation.model.clone(),
            bias_sd_n: file.observation.bias_sd_n,
            correlation: file.observation.correlation_m * joint.per_metre(),
            table: serde_json::to_value(&file.observation).unwrap_or(Value::Null),
        },
        joint,
    })
}

fn joint(file: &raw::Joint) -> Result<Joint, MissingKey> {
    let geometry = || -> Result<Geometry, MissingKey> {
        Ok(Geometry {
            opening_direction: unit(file.opening_direction, "joint.opening_direction")?,
            up_direction: unit(file.up_direction, "joint.up_direction")?,
            motion_threshold_m: file
                .motion_threshold_m
                .ok_or(MissingKey("joint.motion_threshold_m"))?,
        })
    };
    let (kind, [lower, upper]) = match file.r#type {
        JointType::Revolute => {
            let limits = file.limits_deg.ok_or(MissingKey("joint.limits_deg"))?;
            let kind = JointKind::Revolute {
                radius_m: file.radius_m.ok_or(MissingKey("joint.radius_m"))?,
                geometry: geometry()?,
                hinge_direction: unit(file.hinge_direction, "joint.hinge_direction")?,
            };
            (kind, limits.map(f64::to_radians))
        }
        JointType::Prismatic => (
            JointKind::Prismatic {
                geometry: geometry()?,
            },
            file.limits_m.ok_or(MissingKey("joint.limits_m"))?,
        ),
        JointType::Abstract => (
            JointKind::Abstract {
                integer: file.integer,
            },
            file.limits.ok_or(MissingKey("joint.limits"))?,
        ),
    };
    let start = file.start.map_or((lower, upper), |[from, to]| (from, to));
    Ok(Joint {
        kind,
        lower,
        upper,
        start,
    })
}

fn unit(direction: Option<[f64; 3]>, key: &'static str) -> Result<Vector3<f64>, MissingKey> {
    direction
        .map(|direction| Vector3::from(direction).normalize())
        .ok_or(MissingKey(key))
}

fn control(file: &raw::Control) -> Control {
    Control {
        rate_hz: file.rate_hz,
        safe_speed_m_s: file.safe_speed_m_s,
        high_speed_m_s: file.high_speed_m_s,
        force_threshold_n: file.force_threshold_n,
        force_limit_n: file.force_limit_n,
        acceleration_m_s2: file.acceleration_m_s2,
        stop_deceleration_m_s2: file.stop_deceleration_m_s2,
        contact_stiffness_n_per_m: file.contact_stiffness_n_per_m,
    }
}

/// a0…a4 of §III-A.2; each moves for one policy period at its mode's speed.
fn arm_actions(
    joint: &Joint,
    control: &Control,
    policy: &PolicySettings,
    belief: &BeliefSettings,
) -> Vec<Action> {
    let observations = (belief.rate_hz / policy.rate_hz).round() as u32;
    let step = |mode| control.speed_m_s(mode) / policy.rate_hz * joint.per_metre();
    let moving = |name: &str, mode, sign: f64| Action {
        name: name.to_owned(),
        motion: Motion::Move {
            mode,
            displacement: sign * step(mode),
            observations,
        },
    };
    vec![
        Action {
            name: "stop".to_owned(),
            motion: Motion::Stop,
        },
        moving("safe_open", Mode::Safe, 1.0),
        moving("safe_close", Mode::Safe, -1.0),
        moving("high_open", Mode::HighForce, 1.0),
        moving("high_close", Mode::HighForce, -1.0),
    ]
}

fn abstract_action(file: &raw::Action) -> Action {
    let mode = if file.high_force {
        Mode::HighForce
    } else {
        Mode::Safe
    };
    let motion = if file.stop {
        Motion::Stop
    } else {
        Motion::Move {
            mode,
            displacement: file.r#move,
            observations: file.observations,
        }
    };
    Action {
        name: file.name.clone(),
        motion,
    }
}

fn reward(file: &raw::Reward, joint: &raw::Joint) -> Result<Reward, MissingKey> {
    let goal_tolerance = match joint.r#type {
        JointType::Revolute => file.goal_tolerance_deg.map(f64::to_radians),
        JointType::Prismatic => file.goal_tolerance_m,
        JointType::Abstract => file.goal_tolerance,
    };
    Ok(Reward {
        shape: match file.shape {
            raw::RewardShape::Proximity => Shape::Proximity,
            raw::RewardShape::Flat => Shape::Flat,
        },
        goal_tolerance: goal_tolerance.ok_or(MissingKey("reward.goal_tolerance"))?,
        goal: file.goal,
        failed_stop: file.failed_stop,
        safety_violation: file.safety_violation,
        time: file.time,
        discount: file.discount,
    })
}

fn driver_table(file: &raw::Driver) -> DriverTable {
    DriverTable {
        plugin: file.plugin.clone(),
        table: serde_json::to_value(file).unwrap_or(Value::Null),
    }
}
