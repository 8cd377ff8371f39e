//! The object file as it is written: one struct per table, in the file's own units.
//!
//! Nothing here is checked; [`load`](super::load) hands out only what has passed the schema
//! ([`keys`](super::keys)) and the rules between keys. Keys that a joint type does not have are
//! `None`; keys it must have are `Some` after loading.

use pubs_plugin::JointType;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A whole object file, with the engine's defaults and the user's overrides merged in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectFile {
    /// Version of the file format; always 1.
    pub schema: u32,
    /// Name of the object; policies are named after it.
    pub name: String,
    /// Where the numbers come from; always given for revolute and prismatic joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
    /// The joint.
    pub joint: Joint,
    /// The actions of an abstract joint, in index order; empty for an arm, which has its five.
    #[serde(default, rename = "action", skip_serializing_if = "Vec::is_empty")]
    pub actions: Vec<Action>,
    /// The controller; `None` for abstract joints only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub control: Option<Control>,
    /// The particle filter.
    pub belief: Belief,
    /// The policy and how often it acts.
    pub policy: Policy,
    /// The reward, eqs. (1) and (2).
    pub reward: Reward,
    /// The driver; `None` where the object cannot be run on an arm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driver: Option<Driver>,
    /// The observation model.
    pub observation: Observation,
}

/// `[source]`: where the numbers of the file come from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// How they were obtained.
    pub kind: SourceKind,
    /// The force sensor they were obtained with; always given unless assumed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// How the numbers of a file were obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SourceKind {
    /// From demonstrations on the real object.
    Measured,
    /// From a virtual world.
    Virtual,
    /// By judgement.
    Assumed,
}

/// `[joint]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Kind of the joint.
    pub r#type: JointType,
    /// Closed and open limit, degrees (revolute).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits_deg: Option<[f64; 2]>,
    /// Closed and open limit, m (prismatic).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits_m: Option<[f64; 2]>,
    /// Lower and upper limit, plain numbers (abstract).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
    /// Hinge axis to handle, m (revolute).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// Where the handle goes when the joint opens; tool frame at the grasp, not yet normalised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening_direction: Option<[f64; 3]>,
    /// From the handle towards the hinge axis; tool frame at the grasp, not yet normalised
    /// (revolute).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hinge_direction: Option<[f64; 3]>,
    /// Up; tool frame at the grasp, not yet normalised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up_direction: Option<[f64; 3]>,
    /// m_p is 1 where the handle moved more than this between two filter updates, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion_threshold_m: Option<f64>,
    /// Where the state may be at first (abstract); the limits where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<[f64; 2]>,
    /// Whether states are whole numbers (abstract).
    #[serde(default)]
    pub integer: bool,
    /// The goal where none is asked for, in the joint's own unit (abstract).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<f64>,
}

/// `[[action]]`: one action of an abstract joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Action {
    /// Its name, unique in the file.
    pub name: String,
    /// Whether it ends the episode; exactly one action does.
    #[serde(default)]
    pub stop: bool,
    /// Displacement in the joint's own unit; 0 for the stop action.
    #[serde(default)]
    pub r#move: f64,
    /// Sub-moves, each with an observation and a weight update.
    #[serde(default = "one")]
    pub observations: u32,
    /// Whether it can violate safety.
    #[serde(default)]
    pub high_force: bool,
}

fn one() -> u32 {
    1
}

/// `[control]`: the controller, eqs. (12) and (13).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Control {
    /// Rate of commands, Hz.
    pub rate_hz: f64,
    /// Speed of the handle in safe mode, m/s.
    pub safe_speed_m_s: f64,
    /// Speed of the handle in high-force mode, m/s.
    pub high_speed_m_s: f64,
    /// F_t of (13), N.
    pub force_threshold_n: f64,
    /// Any mode stops above it, N.
    pub force_limit_n: f64,
    /// Bound on speeding up, m/s².
    pub acceleration_m_s2: f64,
    /// Deceleration of every stop, m/s².
    pub stop_deceleration_m_s2: f64,
    /// Stiffness of grasp and object at a hard stop, N/m.
    pub contact_stiffness_n_per_m: f64,
}

/// `[belief]`: the particle filter, §III-B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    /// Which filter.
    pub filter: Filter,
    /// N.
    pub particles: u32,
    /// Filter updates per second, Hz; `None` for abstract joints only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Exponent on the likelihood of each counted force reading.
    pub tempering: f64,
    /// One force reading counts per this much travel or reversal, m; 0: every update.
    #[serde(default)]
    pub reading_spacing_m: f64,
    /// Standard deviation of the offset that a tare leaves, N; for `rao_blackwell` alone.
    #[serde(default)]
    pub offset_sd_n: f64,
    /// Standard deviation of its change from one counted reading to the next, N.
    #[serde(default)]
    pub offset_walk_n: f64,
    /// Standard deviation of the friction against what it was at calibration, N.
    #[serde(default)]
    pub friction_sd_n: f64,
}

/// The filters that an object file may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Sequential importance sampling without resampling, eqs. (6) to (10).
    Sis,
    /// The same, and each particle estimates what readings are off by.
    RaoBlackwell,
}

/// `[policy]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Policy {
    /// Actions chosen per second, Hz; `None` for abstract joints only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Width of each hidden layer, of the policy and of the value network alike.
    pub layers: Vec<u32>,
    /// When high-force actions are masked.
    pub shield: Shield,
}

/// `policy.shield`: a high-force action is masked where weights^flattening put more than `mass`
/// within one such step and the margin (`shield::margin`) of the limit it moves towards.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Shield {
    /// Probability that is still accepted.
    pub mass: f64,
    /// Exponent on the weights.
    pub flattening: f64,
}

/// `[reward]`, eqs. (1) and (2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reward {
    /// Shape inside the goal region.
    pub shape: RewardShape,
    /// ε_g, degrees (revolute).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_tolerance_deg: Option<f64>,
    /// ε_g, m (prismatic).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_tolerance_m: Option<f64>,
    /// ε_g, plain (abstract).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_tolerance: Option<f64>,
    /// Reward of stopping at the goal.
    pub goal: f64,
    /// Reward, not positive, of stopping outside the goal region.
    pub failed_stop: f64,
    /// Reward, not positive, of a safety violation.
    pub safety_violation: f64,
    /// Reward, not positive, of each policy step.
    pub time: f64,
    /// γ.
    pub discount: f64,
}

/// Shape of the goal reward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RewardShape {
    /// Falls linearly from the goal to the edge of the goal region, eq. (2).
    Proximity,
    /// Full reward inside the goal region.
    Flat,
}

/// `[driver]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Driver {
    /// Name of a driver plugin.
    pub plugin: String,
    /// The plugin's own parameters; its schema checks them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub params: Option<Value>,
}

/// `[observation]`. Serialised, it is the table that the plugin's schema checks, less the four
/// keys of the engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Name of an observation-model plugin.
    pub model: String,
    /// The trainer's simulator draws a force bias of this standard deviation per episode, N.
    #[serde(default)]
    pub bias_sd_n: f64,
    /// And noise correlated over this much travel, m; 0: independent.
    #[serde(default)]
    pub correlation_m: f64,
    /// The plugin's own parameters; its schema checks them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub params: Option<Value>,
    /// The calibration segments; the schema of the plugin `segments` checks them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub segment: Option<Value>,
}
