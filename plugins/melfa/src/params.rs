//! `[driver] params` of an object file.

mod check;
mod choices;

use pubs_plugin::PluginError;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use choices::{ControllerPose, ForceSource, SignedAxis, Terminator, Upload, Zero};

/// JSON Schema of [`Params`]: descriptions and defaults of all of them.
pub const SCHEMA: &str = include_str!("params.schema.json");

/// What can be set. `params.schema.json` describes each; names carry the unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct Params {
    pub host: String,
    pub r3_port: u16,
    pub mxt_port: u16,
    pub monitor_port: u16,
    pub local_address: String,
    pub mxt_bind_port: u16,
    pub monitor_bind_port: u16,
    pub r3_terminator: Terminator,
    pub cycle_ms: f64,
    pub filter_ms: f64,

    pub force_source: ForceSource,
    pub force_id: u16,
    pub pose_id: u16,
    pub command_id: u16,
    pub sensor: String,
    pub sensor_axes: [SignedAxis; 3],
    pub sensor_rotation_deg: [f64; 3],
    pub sensor_position_m: [f64; 3],
    pub force_offset_n: [f64; 3],
    pub torque_offset_nm: [f64; 3],
    pub force_range_n: f64,
    pub torque_range_nm: f64,
    pub zero: Zero,
    pub baseline_s: f64,
    pub baseline_load_n: f64,
    pub baseline_noise_n: f64,
    pub baseline_drift_n_s: f64,

    pub controller_pose: ControllerPose,
    pub tool_position_m: [f64; 3],
    pub tool_rotation_deg: [f64; 3],
    pub base_position_m: [f64; 3],
    pub base_rotation_deg: [f64; 3],

    pub acceleration_m_s2: f64,
    pub angular_acceleration_rad_s2: f64,
    pub jerk_m_s3: f64,
    pub angular_jerk_rad_s3: f64,
    pub speed_limit_m_s: f64,
    pub angular_speed_limit_rad_s: f64,
    pub joint_speed_fraction: f64,
    pub singularity_deg: f64,
    pub joint_margin_deg: f64,
    pub quantum_mm: f64,
    pub quantum_rad: f64,
    pub continuous_angles: bool,
    pub lead_m: f64,
    pub lead_rad: f64,

    pub receive_timeout_cycles: f64,
    pub link_lost_misses: u32,
    pub relink_s: f64,
    pub pose_stale_ms: f64,
    pub force_stale_ms: f64,

    pub program: String,
    pub upload_program: Upload,
    pub start_program: bool,
    pub servo_on: bool,
    pub take_right: bool,
    pub reset_alarm: bool,
    pub stop_program: bool,
    pub servo_off: bool,

    pub r3_timeout_s: f64,
    pub handshake_s: f64,
    pub r3_poll_ms: f64,
    pub r3_lost_ms: f64,
    pub r3_reconnect_s: f64,
    pub force_poll_ms: f64,
    pub log: bool,
}

impl Default for Params {
    fn default() -> Self {
        let axes = ["x", "y", "z"].map(|name| SignedAxis::named(name).unwrap_or_default());
        Self {
            host: String::new(),
            r3_port: 10001,
            mxt_port: 10000,
            monitor_port: 12000,
            local_address: String::new(),
            mxt_bind_port: 0,
            monitor_bind_port: 0,
            r3_terminator: Terminator::Cr,
            cycle_ms: 3.5,
            filter_ms: 10.0,
            force_source: ForceSource::Monitor,
            force_id: 101,
            pose_id: 1007,
            command_id: 1001,
            sensor: "1f-fs001-w200".to_owned(),
            sensor_axes: axes,
            sensor_rotation_deg: [0.0; 3],
            sensor_position_m: [0.0; 3],
            force_offset_n: [0.0; 3],
            torque_offset_nm: [0.0; 3],
            force_range_n: 200.0,
            torque_range_nm: 4.0,
            zero: Zero::Resting,
            baseline_s: 0.5,
            baseline_load_n: 20.0,
            baseline_noise_n: 0.75,
            baseline_drift_n_s: 2.0,
            controller_pose: ControllerPose::Tool,
            tool_position_m: [0.0; 3],
            tool_rotation_deg: [0.0; 3],
            base_position_m: [0.0; 3],
            base_rotation_deg: [0.0; 3],
            acceleration_m_s2: 5.0,
            angular_acceleration_rad_s2: 18.0,
            jerk_m_s3: 500.0,
            angular_jerk_rad_s3: 1800.0,
            speed_limit_m_s: 0.25,
            angular_speed_limit_rad_s: 1.57,
            joint_speed_fraction: 0.8,
            singularity_deg: 5.0,
            joint_margin_deg: 2.0,
            quantum_mm: 1e-3,
            quantum_rad: 1e-5,
            continuous_angles: true,
            lead_m: 0.015,
            lead_rad: 0.1,
            receive_timeout_cycles: 2.0,
            link_lost_misses: 25,
            relink_s: 5.0,
            pose_stale_ms: 40.0,
            force_stale_ms: 40.0,
            program: "PUBS".to_owned(),
            upload_program: Upload::Missing,
            start_program: true,
            servo_on: true,
            take_right: true,
            reset_alarm: false,
            stop_program: true,
            servo_off: false,
            r3_timeout_s: 2.0,
            handshake_s: 3.0,
            r3_poll_ms: 200.0,
            r3_lost_ms: 1000.0,
            r3_reconnect_s: 10.0,
            force_poll_ms: 20.0,
            log: false,
        }
    }
}

impl Params {
    /// Reads the whole `[driver]` table and checks every value.
    ///
    /// # Errors
    /// All that is wrong, by name, with the value found and the rule.
    pub fn from_driver_table(table: &Value) -> Result<Self, PluginError> {
        let params = table
            .get("params")
            .cloned()
            .unwrap_or_else(|| Value::Object(serde_json::Map::default()));
        let params: Self = serde_json::from_value(params)
            .map_err(|error| PluginError::new(format!("params: {error}")))?;
        let faults = check::faults(&params);
        if faults.is_empty() {
            return Ok(params);
        }
        Err(PluginError::new(format!("params: {}", faults.join("; "))))
    }

    /// One control cycle, s.
    pub fn cycle_s(&self) -> f64 {
        self.cycle_ms * 1e-3
    }
}

/// Milliseconds as nanoseconds.
pub(crate) fn ms_ns(ms: f64) -> u64 {
    (ms * 1e6) as u64
}

/// Seconds as nanoseconds.
pub(crate) fn s_ns(s: f64) -> u64 {
    (s * 1e9) as u64
}

#[cfg(test)]
mod tests;
