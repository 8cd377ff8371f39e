//! The low-pass between a target and what the joints are sent to.

use nalgebra::{Isometry3, Translation3};

/// Nearer than this to its target, m or rad, a value has arrived.
const ARRIVED: f64 = 1e-9;

/// First order; its time constant is the third argument of `Mxt`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass {
    /// Share of the distance to the target that a cycle goes.
    share: f64,
}

impl LowPass {
    /// With this time constant; 0 lets everything through.
    pub fn new(time_constant_s: f64, cycle_s: f64) -> Self {
        let share = match time_constant_s > 0.0 {
            true => 1.0 - (-cycle_s / time_constant_s).exp(),
            false => 1.0,
        };
        Self { share }
    }

    /// Where a pose is a cycle later on its way to the target.
    pub fn pose(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> Isometry3<f64> {
        let way = to.translation.vector - from.translation.vector;
        let turn = (to.rotation * from.rotation.inverse()).scaled_axis();
        if way.norm() < ARRIVED && turn.norm() < ARRIVED {
            return *to;
        }
        let turned = nalgebra::UnitQuaternion::from_scaled_axis(turn * self.share);
        Isometry3::from_parts(
            Translation3::from(from.translation.vector + way * self.share),
            turned * from.rotation,
        )
    }

    /// The same of joints.
    pub fn joints(&self, from: &[f64; 6], to: &[f64; 6]) -> [f64; 6] {
        let near = (0..6).all(|joint| (to[joint] - from[joint]).abs() < ARRIVED);
        match near {
            true => *to,
            false => {
                std::array::from_fn(|joint| from[joint] + (to[joint] - from[joint]) * self.share)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn one_over_e_is_missing_after_the_time_constant() {
        let filter = LowPass::new(0.035, 0.0035);
        let mut joints = [0.0; 6];
        let target = Isometry3::from_parts(
            Translation3::new(1.0, 0.0, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.5),
        );
        let mut pose = Isometry3::identity();
        for _ in 0..10 {
            joints = filter.joints(&joints, &[1.0; 6]);
            pose = filter.pose(&pose, &target);
        }
        let left = (-1f64).exp();
        assert!((joints[3] - (1.0 - left)).abs() < 1e-12, "{joints:?}");
        assert!((pose.translation.x - (1.0 - left)).abs() < 1e-12, "{pose}");
        assert!((pose.rotation.angle() - 0.5 * (1.0 - left)).abs() < 1e-9);
    }

    #[test]
    fn without_a_time_constant_everything_passes() {
        let found = LowPass::new(0.0, 0.0035).joints(&[0.0; 6], &[1.0; 6]);
        assert_eq!(found, [1.0; 6]);
    }
}
