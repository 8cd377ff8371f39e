//! The tables of a world file, key by key.

use serde::Deserialize;

/// A whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WorldFile {
    pub schema: u32,
    pub name: String,
    pub joint: JointTable,
    pub friction: FrictionTable,
    pub catch: Option<BumpTable>,
    pub seal: Option<BumpTable>,
    pub spring_hinge: Option<SpringHingeTable>,
    pub closing_spring: Option<ClosingSpringTable>,
    pub stop: StopTable,
    pub grasp: GraspTable,
    #[serde(default)]
    pub path: PathTable,
    pub arm: ArmTable,
    pub sensor: SensorTable,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum JointKind {
    Revolute,
    Prismatic,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointTable {
    pub r#type: JointKind,
    pub limits_deg: Option<[f64; 2]>,
    pub limits_m: Option<[f64; 2]>,
    pub radius_m: Option<f64>,
    pub inertia_kg_m2: Option<f64>,
    pub mass_kg: Option<f64>,
    pub opening_direction: [f64; 3],
    pub hinge_direction: Option<[f64; 3]>,
    pub up_direction: [f64; 3],
    pub closed_position_m: [f64; 3],
    pub closed_orientation_xyzw: [f64; 4],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FrictionTable {
    pub coulomb_n: f64,
    #[serde(default)]
    pub viscous_n_s_per_m: f64,
    #[serde(default)]
    pub ripple_n: f64,
    pub ripple_period_deg: Option<f64>,
    pub ripple_period_m: Option<f64>,
    #[serde(default)]
    pub ripple_phase_deg: f64,
}

/// A catch or a seal.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BumpTable {
    pub force_n: f64,
    pub width_deg: Option<f64>,
    pub width_m: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpringHingeTable {
    pub force_n: f64,
    pub middle_deg: Option<f64>,
    pub middle_m: Option<f64>,
    pub slope_deg: Option<f64>,
    pub slope_m: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClosingSpringTable {
    pub force_n: f64,
    #[serde(default)]
    pub stiffness_n_per_m: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StopTable {
    pub stiffness_n_per_m: f64,
    pub damping_n_s_per_m: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GraspTable {
    pub stiffness_n_per_m: [f64; 3],
    pub damping_n_s_per_m: [f64; 3],
    #[serde(default)]
    pub rotation_nm_per_rad: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PathTable {
    pub lateral: Option<DeviationTable>,
    pub vertical: Option<DeviationTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeviationTable {
    #[serde(default)]
    pub mean_m: f64,
    pub amplitude_m: f64,
    pub period_deg: Option<f64>,
    pub period_m: Option<f64>,
    #[serde(default)]
    pub phase_deg: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ArmTable {
    pub lag_s: f64,
    pub acceleration_m_s2: f64,
    #[serde(default)]
    pub position_noise_m: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SensorTable {
    #[serde(default)]
    pub white_n: f64,
    #[serde(default)]
    pub correlated_n: f64,
    pub correlation_m: Option<f64>,
    pub correlation_s: Option<f64>,
    #[serde(default)]
    pub bias_sd_n: f64,
    #[serde(default)]
    pub drift_n_per_minute: f64,
    #[serde(default)]
    pub quantum_n: f64,
    pub bandwidth_hz: Option<f64>,
    #[serde(default)]
    pub torque_white_nm: f64,
}
