//! Encoder pulses and motor currents: scales invented here, the real ones are not known.

/// Pulses per radian of every joint.
pub const PULSES_PER_RAD: f64 = 100_000.0;

/// Torque at a current of 100 %, N m.
const RATED_TORQUE_NM: [f64; 6] = [150.0, 150.0, 80.0, 20.0, 20.0, 12.0];

/// Joints 1 to 6 (rad) as pulses of J1 to J8.
pub fn of_joints(joints: &[f64; 6]) -> [i32; 8] {
    six_of_eight(|joint| (joints[joint] * PULSES_PER_RAD).round() as i32)
}

/// And back.
pub fn to_joints(pulses: &[i32; 8]) -> [f64; 6] {
    std::array::from_fn(|joint| f64::from(pulses[joint]) / PULSES_PER_RAD)
}

/// Torques (N m) as currents, %.
pub fn currents(torques_nm: &[f64; 6]) -> [i32; 8] {
    six_of_eight(|joint| (torques_nm[joint] / RATED_TORQUE_NM[joint] * 100.0).round() as i32)
}

fn six_of_eight(value: impl Fn(usize) -> i32) -> [i32; 8] {
    std::array::from_fn(|joint| if joint < 6 { value(joint) } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_go_there_and_back() {
        let joints = [0.1, -0.2, 1.5, 0.0, -2.0, 3.0];
        let pulses = of_joints(&joints);
        assert_eq!(
            pulses,
            [10_000, -20_000, 150_000, 0, -200_000, 300_000, 0, 0]
        );
        assert_eq!(to_joints(&pulses), joints);
        assert_eq!(
            currents(&[75.0, 0.0, -8.0, 0.0, 0.0, 12.0])[..3],
            [50, 0, -10]
        );
    }
}
