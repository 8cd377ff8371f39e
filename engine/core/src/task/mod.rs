//! The task: an object file, compiled.

mod compile;
mod frequency;

pub use compile::{MissingKey, compile};
pub use frequency::FrequencyError;

use pubs_plugin::setup;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::belief::{BeliefSettings, Cloud};
use crate::controller::Control;
use crate::joint::{Joint, JointKind};
use crate::reward::{Reward, Shape};
use crate::shield::Shield;
use crate::{Action, Mode, Motion};

/// Everything that filter, controller, simulator and policy need of an object. Immutable: each of
/// them takes a `&Task`.
#[derive(Debug, Clone)]
pub struct Task {
    /// Name of the object.
    pub name: String,
    /// The force sensor its numbers were taken with; `None` where they are assumed.
    pub sensor: Option<String>,
    /// S and the geometry.
    pub joint: Joint,
    /// The goal where none is asked for (abstract joints).
    pub default_goal: Option<f64>,
    /// A, in index order.
    pub actions: Vec<Action>,
    /// Index of the stop action.
    pub stop: usize,
    /// The controller; `None` on abstract joints.
    pub control: Option<Control>,
    /// The filter.
    pub belief: BeliefSettings,
    /// The policy.
    pub policy: PolicySettings,
    /// R and γ.
    pub reward: Reward,
    /// The driver; `None` where no robot can move the object.
    pub driver: Option<DriverTable>,
    /// The observation model.
    pub observation: ObservationTable,
}

/// `[policy]`.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicySettings {
    /// Actions chosen per second (1 on abstract joints, where a step is the unit of time).
    pub rate_hz: f64,
    /// Width of each hidden layer.
    pub layers: Vec<usize>,
    /// When high-force actions are masked.
    pub shield: Shield,
}

/// `[driver]`.
#[derive(Debug, Clone, PartialEq)]
pub struct DriverTable {
    /// Name of the plugin.
    pub plugin: String,
    /// The whole table, for the plugin.
    pub table: Value,
}

/// `[observation]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationTable {
    /// Name of the plugin.
    pub model: String,
    /// The simulator draws a force bias of this standard deviation per episode, N.
    pub bias_sd_n: f64,
    /// And noise correlated over this much travel (rad, m or plain); 0: independent.
    pub correlation: f64,
    /// The whole table, for the plugin.
    pub table: Value,
}

impl Task {
    /// Filter updates in one policy step of an arm; 1 on abstract joints, whose actions say.
    pub fn updates_per_policy_step(&self) -> u32 {
        self.actions
            .iter()
            .map(Action::observations)
            .max()
            .unwrap_or(1)
    }

    /// The actions that move, with their indices.
    pub fn movements(&self) -> impl Iterator<Item = (usize, &Action)> {
        let all = self.actions.iter().enumerate();
        all.filter(|(_, action)| !action.is_stop())
    }

    /// What an observation-model plugin is created with.
    pub fn model_setup(&self, seed: u64) -> setup::ModelSetup {
        setup::ModelSetup {
            joint: self.joint_setup(),
            actions: self.action_setups(),
            control: self.control.as_ref().map(control_setup),
            belief: setup::BeliefSetup {
                particles: self.belief.particles as u32,
                spacing: Cloud::new(&self.joint, self.belief.particles).spacing(),
            },
            observation: self.observation.table.clone(),
            seed,
        }
    }

    /// What a driver plugin is opened with; `None` where the object has no driver.
    pub fn driver_setup(&self, seed: u64) -> Option<setup::DriverSetup> {
        Some(setup::DriverSetup {
            joint: self.joint_setup(),
            actions: self.action_setups(),
            control: control_setup(self.control.as_ref()?),
            driver: self.driver.as_ref()?.table.clone(),
            seed,
        })
    }

    /// What a policy on a belief was trained for: it must be the same where the policy is used.
    pub fn policy_ingredients(&self) -> Value {
        let mut ingredients = self.raw_policy_ingredients();
        if let (Some(belief), Some(filter)) = (
            ingredients["belief"].as_object_mut(),
            self.filter_ingredients().as_object(),
        ) {
            belief.extend(filter.clone());
        }
        ingredients
    }

    /// Of those, what the filter makes of observations.
    pub fn filter_ingredients(&self) -> Value {
        let mut ingredients = json!({
            "particles": self.belief.particles,
            "tempering": self.belief.tempering,
            // What the entropy is taken over: a policy learnt what its values mean.
            "entropy_of": "places",
        });
        if let Some(bias) = self.belief.force_bias {
            ingredients["force_bias"] = json!({
                "offset_sd_n": bias.offset_sd_n,
                "offset_walk_n": bias.offset_walk_n,
                "friction_sd_n": bias.friction_sd_n,
            });
        }
        ingredients
    }

    /// The rest, which is all that a policy on raw observations was trained for: `[belief]` only
    /// says which observations there are.
    pub fn raw_policy_ingredients(&self) -> Value {
        let actions: Vec<Value> = self.actions.iter().map(action_json).collect();
        json!({
            "joint": joint_json(&self.joint),
            "actions": actions,
            "control": self.control.as_ref().map(|control| json!({
                "safe_speed_m_s": control.safe_speed_m_s,
                "high_speed_m_s": control.high_speed_m_s,
                "force_threshold_n": control.force_threshold_n,
            })),
            "belief": {
                "rate_hz": self.belief.rate_hz,
                "reading_spacing": self.belief.reading_spacing,
            },
            "policy": { "rate_hz": self.policy.rate_hz },
            "reward": {
                "shape": match self.reward.shape { Shape::Proximity => "proximity", Shape::Flat => "flat" },
                "goal_tolerance": self.reward.goal_tolerance,
                "goal": self.reward.goal,
                "failed_stop": self.reward.failed_stop,
                "safety_violation": self.reward.safety_violation,
                "time": self.reward.time,
                "discount": self.reward.discount,
            },
        })
    }

    /// Hash of the observation model's table: it may differ where a policy is used, because
    /// recalibrating needs no retraining.
    pub fn observation_hash(&self) -> String {
        // Keys of a JSON map are sorted, so equal tables give equal text.
        let digest = Sha256::digest(self.observation.table.to_string().as_bytes());
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    fn joint_setup(&self) -> setup::JointSetup {
        let joint = &self.joint;
        let geometry = joint.geometry();
        let (radius_m, hinge_direction) = match &joint.kind {
            JointKind::Revolute {
                radius_m,
                hinge_direction,
                ..
            } => (Some(*radius_m), Some((*hinge_direction).into())),
            JointKind::Prismatic { .. } | JointKind::Abstract { .. } => (None, None),
        };
        setup::JointSetup {
            r#type: joint.joint_type(),
            lower: joint.lower,
            upper: joint.upper,
            integer: joint.is_integer(),
            radius_m,
            opening_direction: geometry.map(|geometry| geometry.opening_direction.into()),
            hinge_direction,
            up_direction: geometry.map(|geometry| geometry.up_direction.into()),
            motion_threshold_m: geometry.map(|geometry| geometry.motion_threshold_m),
        }
    }

    fn action_setups(&self) -> Vec<setup::ActionSetup> {
        let setup = |action: &Action| setup::ActionSetup {
            name: action.name.clone(),
            stop: action.is_stop(),
            mode: if action.is_high_force() {
                setup::Mode::HighForce
            } else {
                setup::Mode::Safe
            },
            displacement: action.displacement(),
            observations: action.observations(),
        };
        self.actions.iter().map(setup).collect()
    }
}

fn control_setup(control: &Control) -> setup::ControlSetup {
    setup::ControlSetup {
        rate_hz: control.rate_hz,
        safe_speed_m_s: control.safe_speed_m_s,
        high_speed_m_s: control.high_speed_m_s,
        force_threshold_n: control.force_threshold_n,
        force_limit_n: control.force_limit_n,
        acceleration_m_s2: control.acceleration_m_s2,
        stop_deceleration_m_s2: control.stop_deceleration_m_s2,
        contact_stiffness_n_per_m: control.contact_stiffness_n_per_m,
    }
}

fn joint_json(joint: &Joint) -> Value {
    let (kind, radius_m) = match joint.kind {
        JointKind::Revolute { radius_m, .. } => ("revolute", Some(radius_m)),
        JointKind::Prismatic { .. } => ("prismatic", None),
        JointKind::Abstract { .. } => ("abstract", None),
    };
    json!({
        "type": kind,
        "lower": joint.lower,
        "upper": joint.upper,
        "start": [joint.start.0, joint.start.1],
        "integer": joint.is_integer(),
        "radius_m": radius_m,
    })
}

fn action_json(action: &Action) -> Value {
    let mode = match action.motion {
        Motion::Stop => "stop",
        Motion::Move {
            mode: Mode::Safe, ..
        } => "safe",
        Motion::Move {
            mode: Mode::HighForce,
            ..
        } => "high_force",
    };
    json!({
        "name": action.name,
        "mode": mode,
        "displacement": action.displacement(),
        "observations": action.observations(),
    })
}
