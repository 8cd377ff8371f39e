//! The absolute pose that the arm is to have in the next cycle.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use pubs_melfa_protocol::Pose;

use crate::twist::Motion;

/// How targets are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Writing {
    /// Lengths are whole numbers of it, mm.
    pub quantum_mm: f64,
    /// Angles are whole numbers of it, rad.
    pub quantum_rad: f64,
    /// Angles go on beyond ±180° rather than jump.
    pub continuous_angles: bool,
}

/// The tool's pose after `seconds` at `velocity`, base axes.
pub fn moved(pose: &Isometry3<f64>, velocity: &Motion, seconds: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(velocity.angular * seconds);
    let mut rotation = turn * pose.rotation;
    rotation.renormalize_fast();
    Isometry3::from_parts(
        Translation3::from(pose.translation.vector + velocity.linear * seconds),
        rotation,
    )
}

/// How far two poses are apart: m and rad.
pub fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    let metres = (a.translation.vector - b.translation.vector).norm();
    (metres, a.rotation.angle_to(&b.rotation))
}

/// `pose`, of the controller's base, as it is sent: in whole quanta, its angles beside those of
/// `before`, with the posture that the arm has.
pub fn written(pose: &Isometry3<f64>, before: &Pose, feedback: &Pose, writing: &Writing) -> Pose {
    let mut sent = Pose::from_isometry(pose, feedback.posture, feedback.turns);
    sent.extra = feedback.extra;
    for value in &mut sent.position_mm {
        *value = whole(f64::from(*value), writing.quantum_mm);
    }
    for (value, before) in sent.angles_rad.iter_mut().zip(before.angles_rad) {
        let mut angle = f64::from(*value);
        if writing.continuous_angles {
            angle += ((f64::from(before) - angle) / TAU).round() * TAU;
        }
        *value = whole(angle, writing.quantum_rad);
    }
    sent
}

fn whole(value: f64, quantum: f64) -> f32 {
    ((value / quantum).round() * quantum) as f32
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::Vector3;

    use super::*;

    const WRITING: Writing = Writing {
        quantum_mm: 1e-3,
        quantum_rad: 1e-5,
        continuous_angles: true,
    };

    #[test]
    fn a_quarter_circle_round_a_hinge() {
        // The tool at 0.3 m from a vertical hinge, turning with it at 1 rad/s in steps of 3.5 ms.
        let mut pose = Isometry3::translation(0.3, 0.0, 0.0);
        let steps = (FRAC_PI_2 / 0.0035).round() as usize;
        let step_s = FRAC_PI_2 / steps as f64;
        for _ in 0..steps {
            let p = pose.translation.vector;
            // The tangent at the middle of the step, as the engine gives it.
            let midway = UnitQuaternion::from_scaled_axis(Vector3::z() * (0.5 * step_s));
            let velocity = Motion {
                linear: midway * Vector3::new(-p.y, p.x, 0.0),
                angular: Vector3::z(),
            };
            pose = moved(&pose, &velocity, step_s);
        }
        let end = Vector3::new(0.0, 0.3, 0.0);
        assert!((pose.translation.vector - end).norm() < 1e-5, "{pose}");
        assert!((pose.rotation.angle() - FRAC_PI_2).abs() < 1e-9, "{pose}");
    }

    #[test]
    fn targets_are_whole_quanta_with_the_posture_of_the_arm() {
        let feedback = Pose {
            posture: 7,
            turns: 0x0010,
            extra: [1.5, 0.0],
            ..Pose::default()
        };
        let pose = Isometry3::translation(0.123_456_78, -1e-9, 0.4);
        let sent = written(&pose, &feedback, &feedback, &WRITING);
        assert_eq!(sent.position_mm, [123.457, 0.0, 400.0]);
        assert_eq!(
            (sent.posture, sent.turns, sent.extra),
            (7, 0x0010, [1.5, 0.0])
        );
    }

    #[test]
    fn angles_go_on_beyond_half_a_turn() {
        let mut pose = Isometry3::rotation(Vector3::x() * (PI - 0.002));
        let mut before = Pose::from_isometry(&pose, 0, 0);
        let mut jumped = false;
        for _ in 0..20 {
            let turn = Motion {
                linear: Vector3::zeros(),
                angular: Vector3::x(),
            };
            pose = moved(&pose, &turn, 0.0035);
            let sent = written(&pose, &before, &before, &WRITING);
            let step = sent.angles_rad[0] - before.angles_rad[0];
            assert!((step - 0.0035).abs() < 2e-5, "A went on by {step} rad");
            let other = Writing {
                continuous_angles: false,
                ..WRITING
            };
            jumped |= written(&pose, &before, &before, &other).angles_rad[0] < 0.0;
            before = sent;
        }
        assert!(jumped, "without it A should have come out at -180°");
    }
}
