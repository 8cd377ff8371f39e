//! The rules for values of parameters. Written so that NaN breaks them.

use super::Params;

/// All that is wrong, each with the value found.
pub(super) fn faults(params: &Params) -> Vec<String> {
    let mut faults: Vec<String> = ranges(params)
        .into_iter()
        .filter(|(_, value, least, most)| !(*least..=*most).contains(value))
        .map(|(name, value, least, most)| {
            format!("{name} = {value}, but it must lie in {least} to {most}")
        })
        .collect();
    for (name, values, most) in vectors(params) {
        if !values.iter().all(|value| value.abs() <= most) {
            faults.push(format!(
                "{name} = {values:?}, but each must lie in {} to {most}",
                -most
            ));
        }
    }
    faults.extend(words(params));
    faults
}

/// Name, value, least and greatest.
fn ranges(p: &Params) -> Vec<(&'static str, f64, f64, f64)> {
    vec![
        ("cycle_ms", p.cycle_ms, 0.5, 20.0),
        ("filter_ms", p.filter_ms, 0.0, 1000.0),
        ("force_range_n", p.force_range_n, 1.0, 10_000.0),
        ("torque_range_nm", p.torque_range_nm, 0.1, 1000.0),
        ("baseline_s", p.baseline_s, 0.3, 10.0),
        ("baseline_load_n", p.baseline_load_n, 0.1, 1000.0),
        ("baseline_noise_n", p.baseline_noise_n, 0.001, 50.0),
        ("baseline_drift_n_s", p.baseline_drift_n_s, 0.001, 50.0),
        ("acceleration_m_s2", p.acceleration_m_s2, 0.05, 10.0),
        (
            "angular_acceleration_rad_s2",
            p.angular_acceleration_rad_s2,
            0.1,
            100.0,
        ),
        ("jerk_m_s3", p.jerk_m_s3, 1.0, 10_000.0),
        ("angular_jerk_rad_s3", p.angular_jerk_rad_s3, 1.0, 100_000.0),
        ("speed_limit_m_s", p.speed_limit_m_s, 0.001, 1.0),
        (
            "angular_speed_limit_rad_s",
            p.angular_speed_limit_rad_s,
            0.001,
            3.15,
        ),
        ("joint_speed_fraction", p.joint_speed_fraction, 0.01, 0.8),
        ("singularity_deg", p.singularity_deg, 0.5, 45.0),
        ("joint_margin_deg", p.joint_margin_deg, 0.1, 45.0),
        ("quantum_mm", p.quantum_mm, 1e-6, 0.1),
        ("quantum_rad", p.quantum_rad, 1e-8, 1e-3),
        ("lead_m", p.lead_m, 0.001, 0.1),
        ("lead_rad", p.lead_rad, 0.01, 1.0),
        (
            "receive_timeout_cycles",
            p.receive_timeout_cycles,
            1.0,
            20.0,
        ),
        (
            "link_lost_misses",
            f64::from(p.link_lost_misses),
            5.0,
            1000.0,
        ),
        ("relink_s", p.relink_s, 0.0, 60.0),
        ("pose_stale_ms", p.pose_stale_ms, 5.0, 1000.0),
        ("force_stale_ms", p.force_stale_ms, 5.0, 1000.0),
        ("r3_timeout_s", p.r3_timeout_s, 0.05, 30.0),
        ("handshake_s", p.handshake_s, 0.1, 60.0),
        ("r3_poll_ms", p.r3_poll_ms, 20.0, 5000.0),
        ("r3_lost_ms", p.r3_lost_ms, 100.0, 10_000.0),
        ("r3_reconnect_s", p.r3_reconnect_s, 0.0, 600.0),
        ("force_poll_ms", p.force_poll_ms, 5.0, 1000.0),
    ]
}

/// Name, values and the greatest size of each.
fn vectors(p: &Params) -> [(&'static str, &[f64; 3], f64); 8] {
    [
        ("sensor_rotation_deg", &p.sensor_rotation_deg, 360.0),
        ("sensor_position_m", &p.sensor_position_m, 1.0),
        ("force_offset_n", &p.force_offset_n, 1000.0),
        ("torque_offset_nm", &p.torque_offset_nm, 100.0),
        ("tool_position_m", &p.tool_position_m, 1.0),
        ("tool_rotation_deg", &p.tool_rotation_deg, 360.0),
        ("base_position_m", &p.base_position_m, 100.0),
        ("base_rotation_deg", &p.base_rotation_deg, 360.0),
    ]
}

fn words(p: &Params) -> Vec<String> {
    let mut faults = Vec::new();
    if p.host.trim().is_empty() {
        faults
            .push("host is missing: the controller's address, such as \"192.168.0.20\"".to_owned());
    }
    if p.sensor.is_empty() {
        faults.push("sensor is empty, but it must name the force sensor".to_owned());
    }
    let name = &p.program;
    let well_named = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    if name.is_empty() || name.len() > 12 || !name.chars().all(well_named) {
        faults.push(format!(
            "program = \"{name}\", but it must be 1 to 12 letters, digits or `_`"
        ));
    }
    let mut indices = p.sensor_axes.map(|axis| axis.index());
    indices.sort_unstable();
    if indices != [0, 1, 2] {
        faults.push(format!(
            "sensor_axes = {:?}, but each of x, y, z must stand once",
            p.sensor_axes.map(String::from)
        ));
    }
    faults
}
