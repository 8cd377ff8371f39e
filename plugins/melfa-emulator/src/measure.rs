//! How the arm truly moves: what tests and figures are made of.

use std::collections::VecDeque;

use nalgebra::{Isometry3, Vector3};
use serde::Serialize;

/// Slower than this the tool is at rest, m/s.
const REST_M_S: f64 = 0.0005;

/// Slower than this every joint is at rest, rad/s.
const REST_RAD_S: f64 = 0.002;

/// Over this time accelerations are averaged in `smooth_acceleration_m_s2`, s.
const SMOOTHING_S: f64 = 0.020;

/// Greatest values since the last reset.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Peaks {
    /// Of the tool's origin.
    pub tool_speed_m_s: f64,
    /// Between two cycles.
    pub tool_acceleration_m_s2: f64,
    /// Over 20 ms: less of the jitter of single packets.
    pub tool_smooth_acceleration_m_s2: f64,
    /// Of one cycle.
    pub tool_step_m: f64,
    /// Of each joint.
    pub joint_speed_rad_s: [f64; 6],
    /// Of each joint, between two cycles.
    pub joint_acceleration_rad_s2: [f64; 6],
    /// True force of the tool on the object.
    pub force_n: f64,
}

/// The motion now and its peaks.
#[derive(Debug, Clone)]
pub struct Measure {
    cycle_s: f64,
    tool_m: Vector3<f64>,
    velocities: VecDeque<Vector3<f64>>,
    joints: [f64; 6],
    rates: [f64; 6],
    /// Of the tool's origin, m/s.
    pub speed_m_s: f64,
    /// Between the last two cycles, m/s².
    pub acceleration_m_s2: f64,
    /// Time of the last cycle with motion, s.
    pub last_motion_s: f64,
    /// Nothing moved in the last cycle.
    pub at_rest: bool,
    /// Since the last reset.
    pub peaks: Peaks,
}

impl Measure {
    /// At rest here.
    pub fn new(tool: &Isometry3<f64>, joints: [f64; 6], cycle_s: f64) -> Self {
        let window = (SMOOTHING_S / cycle_s).round().max(1.0) as usize;
        Self {
            cycle_s,
            tool_m: tool.translation.vector,
            velocities: VecDeque::from(vec![Vector3::zeros(); window]),
            joints,
            rates: [0.0; 6],
            speed_m_s: 0.0,
            acceleration_m_s2: 0.0,
            last_motion_s: 0.0,
            at_rest: true,
            peaks: Peaks::default(),
        }
    }

    /// Takes in a cycle that ended at `time_s`.
    pub fn cycle(&mut self, time_s: f64, tool: &Isometry3<f64>, joints: &[f64; 6], force_n: f64) {
        let step = tool.translation.vector - self.tool_m;
        let velocity = step / self.cycle_s;
        let last = self.velocities.back().copied().unwrap_or_default();
        let first = self.velocities.pop_front().unwrap_or_default();
        self.velocities.push_back(velocity);
        let window_s = self.cycle_s * self.velocities.len() as f64;
        self.speed_m_s = velocity.norm();
        self.acceleration_m_s2 = (velocity - last).norm() / self.cycle_s;
        let smooth = (velocity - first).norm() / window_s;
        self.tool_m = tool.translation.vector;

        let peaks = &mut self.peaks;
        let mut still = self.speed_m_s < REST_M_S;
        for (joint, position) in joints.iter().enumerate() {
            let rate = (position - self.joints[joint]) / self.cycle_s;
            let change = (rate - self.rates[joint]).abs() / self.cycle_s;
            raise(&mut peaks.joint_speed_rad_s[joint], rate.abs());
            raise(&mut peaks.joint_acceleration_rad_s2[joint], change);
            still &= rate.abs() < REST_RAD_S;
            self.rates[joint] = rate;
        }
        self.joints = *joints;
        raise(&mut peaks.tool_speed_m_s, self.speed_m_s);
        raise(&mut peaks.tool_acceleration_m_s2, self.acceleration_m_s2);
        raise(&mut peaks.tool_smooth_acceleration_m_s2, smooth);
        raise(&mut peaks.tool_step_m, step.norm());
        raise(&mut peaks.force_n, force_n);
        self.at_rest = still;
        if !still {
            self.last_motion_s = time_s;
        }
    }

    /// Of the joints over the last cycle, rad/s.
    pub fn rates(&self) -> &[f64; 6] {
        &self.rates
    }
}

fn raise(peak: &mut f64, value: f64) {
    *peak = peak.max(value);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From rest at 2 m/s² for 50 cycles of 4 ms, then stopped dead.
    #[test]
    fn peaks_are_those_of_an_even_acceleration() {
        let cycle_s = 0.004;
        let pose = |x: f64| Isometry3::translation(x, 0.0, 0.0);
        let mut measure = Measure::new(&pose(0.0), [0.0; 6], cycle_s);
        let mut time_s = 0.0;
        let mut at = 0.0;
        for _ in 0..50 {
            time_s += cycle_s;
            at = 0.5 * 2.0 * time_s * time_s;
            measure.cycle(time_s, &pose(at), &[at; 6], 7.0);
        }
        let peaks = measure.peaks;
        assert!(
            (peaks.tool_acceleration_m_s2 - 2.0).abs() < 1e-6,
            "{peaks:?}"
        );
        assert!(
            (peaks.tool_smooth_acceleration_m_s2 - 2.0).abs() < 1e-6,
            "{peaks:?}"
        );
        // Mean speed of the last cycle: 2 m/s² · 198 ms.
        assert!((peaks.tool_speed_m_s - 0.396).abs() < 1e-9, "{peaks:?}");
        assert!(
            (peaks.joint_speed_rad_s[5] - 0.396).abs() < 1e-9,
            "{peaks:?}"
        );
        assert_eq!(peaks.force_n, 7.0);
        assert!(!measure.at_rest);
        measure.cycle(time_s + cycle_s, &pose(at), &[at; 6], 0.0);
        assert!(measure.at_rest);
        assert!((measure.last_motion_s - 0.2).abs() < 1e-9);
        assert!((measure.peaks.tool_acceleration_m_s2 - 99.0).abs() < 1e-6);
    }
}
