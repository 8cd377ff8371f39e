//! What the engine tells a plugin about the object, as one JSON text.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Kind of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointType {
    /// A hinge; states in rad.
    Revolute,
    /// A slide; states in m.
    Prismatic,
    /// A benchmark; states are plain numbers.
    Abstract,
}

/// The joint as the object file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointSetup {
    /// Kind.
    pub r#type: JointType,
    /// The closed limit s_min (rad, m or plain).
    pub lower: f64,
    /// The open limit s_max (rad, m or plain).
    pub upper: f64,
    /// Whether states are whole numbers (abstract joints only).
    pub integer: bool,
    /// Hinge axis to handle, m (revolute only).
    pub radius_m: Option<f64>,
    /// Unit vector in the tool frame at the grasp along which the joint opens.
    pub opening_direction: Option<[f64; 3]>,
    /// Unit vector in the tool frame at the grasp from the handle to the hinge axis (revolute).
    pub hinge_direction: Option<[f64; 3]>,
    /// Unit vector in the tool frame at the grasp that points up.
    pub up_direction: Option<[f64; 3]>,
    /// m_p is 1 where the handle moved more than this between two filter updates, m.
    pub motion_threshold_m: Option<f64>,
}

/// Interaction mode of an action, §III-A.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Stops where the force passes the threshold.
    Safe,
    /// Goes on through resistance.
    HighForce,
}

/// One action, in index order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ActionSetup {
    /// Name in the object file.
    pub name: String,
    /// Whether it ends the episode.
    pub stop: bool,
    /// Interaction mode; safe for `stop`.
    pub mode: Mode,
    /// Joint displacement of one unhindered policy step, signed (rad, m or plain); 0 for `stop`.
    pub displacement: f64,
    /// Observations taken in one policy step.
    pub observations: u32,
}

/// The controller's numbers, `[control]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ControlSetup {
    /// Rate of commands, Hz.
    pub rate_hz: f64,
    /// Speed in safe mode, m/s.
    pub safe_speed_m_s: f64,
    /// Speed in high-force mode, m/s.
    pub high_speed_m_s: f64,
    /// F_t of eq. (13), N.
    pub force_threshold_n: f64,
    /// Any mode stops before it, N.
    pub force_limit_n: f64,
    /// Bound on speeding up, m/s².
    pub acceleration_m_s2: f64,
    /// Deceleration of every stop, m/s².
    pub stop_deceleration_m_s2: f64,
    /// Stiffness of grasp and object at a hard stop, N/m.
    pub contact_stiffness_n_per_m: f64,
}

/// How the belief will ask, so that a model can prepare.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BeliefSetup {
    /// N.
    pub particles: u32,
    /// Distance between neighbouring particles while they are on a regular grid (rad, m, plain).
    pub spacing: f64,
}

/// All that [`ObservationModel::create`](crate::ObservationModel::create) gets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelSetup {
    /// The joint.
    pub joint: JointSetup,
    /// The actions in index order.
    pub actions: Vec<ActionSetup>,
    /// The controller; absent on abstract objects.
    pub control: Option<ControlSetup>,
    /// The particles.
    pub belief: BeliefSetup,
    /// The whole `[observation]` table. Angles in it keep the unit their key names.
    pub observation: Value,
    /// Seed for a model that draws at creation.
    pub seed: u64,
}

/// All that [`Driver::open`](crate::Driver::open) gets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriverSetup {
    /// The joint as the engine believes it to be.
    pub joint: JointSetup,
    /// The actions in index order.
    pub actions: Vec<ActionSetup>,
    /// The controller.
    pub control: ControlSetup,
    /// The whole `[driver]` table.
    pub driver: Value,
    /// Seed for everything the driver draws.
    pub seed: u64,
}
