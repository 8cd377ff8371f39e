//! Keeping every joint below its speed limit, away from the ends of its range, and the wrist away
//! from its singularity.

use std::fmt;

use nalgebra::{Matrix6, Vector3, Vector6};
use pubs_melfa_protocol::arm::{RANGE_RAD, SPEED_RAD_S, forward, jacobian};

use crate::twist::Motion;

/// Tool and flange are not further apart than this; where they seem to be, the controller's base is
/// not the arm's, and the tool's own origin must do.
const LONGEST_TOOL_M: f64 = 0.5;

/// Below this speed a joint does not move towards anything, rad/s.
const STILL_RAD_S: f64 = 1e-4;

/// Where less than this share of a velocity is left, the posture is taken as singular.
const LEAST_FACTOR: f64 = 0.05;

/// Its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointGuard {
    /// Share of each joint's greatest speed.
    pub speed_fraction: f64,
    /// |J5| must stay above it, rad.
    pub singularity_rad: f64,
    /// Distance to the end of a range, rad.
    pub margin_rad: f64,
}

/// Why a velocity is not carried out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Blocked {
    /// J4 and J6 nearly in line.
    Wrist {
        /// J5, deg.
        j5_deg: f64,
    },
    /// Near the end of a joint's range, going there.
    Range {
        /// 1 to 6.
        joint: usize,
        /// Where it is, deg.
        angle_deg: f64,
    },
    /// Another singular posture: a joint would have to be far too fast.
    Singular {
        /// 1 to 6.
        joint: usize,
        /// The speed it would need, rad/s.
        speed_rad_s: f64,
    },
}

impl fmt::Display for Blocked {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wrist { j5_deg } => write!(
                out,
                "J5 is at {j5_deg:.1}°, near the wrist's singularity: begin from a posture with J5 further from zero"
            ),
            Self::Range { joint, angle_deg } => write!(
                out,
                "J{joint} is at {angle_deg:.1}° and goes towards the end of its range: begin from a posture with more room"
            ),
            Self::Singular { joint, speed_rad_s } => write!(
                out,
                "a singular posture: J{joint} would have to move at {speed_rad_s:.1} rad/s; begin from another posture"
            ),
        }
    }
}

/// Joint speeds of a velocity, and the factor that keeps them within their limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// At most 1.
    pub factor: f64,
    /// The greatest share of a limit that any joint would use with the whole velocity.
    pub share: f64,
}

impl JointGuard {
    /// How much of `velocity` of the tool (controller's base, at `tool_origin`, m) the joints allow
    /// at `joints` (rad).
    ///
    /// # Errors
    /// Where the arm must not go on this way at all.
    pub fn allow(
        &self,
        joints: &[f64; 6],
        tool_origin: &Vector3<f64>,
        velocity: &Motion,
    ) -> Result<Allowed, Blocked> {
        if joints[4].abs() < self.singularity_rad {
            return Err(Blocked::Wrist {
                j5_deg: joints[4].to_degrees(),
            });
        }
        let Some(speeds) = joint_speeds(joints, tool_origin, velocity) else {
            return Err(Blocked::Singular {
                joint: 5,
                speed_rad_s: f64::INFINITY,
            });
        };
        self.within_range(joints, &speeds)?;
        let shares = (0..6).map(|index| speeds[index].abs() / SPEED_RAD_S[index]);
        let (joint, share) = shares
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, 0.0));
        let factor = if share > self.speed_fraction {
            self.speed_fraction / share
        } else {
            1.0
        };
        if factor < LEAST_FACTOR {
            return Err(Blocked::Singular {
                joint: joint + 1,
                speed_rad_s: speeds[joint].abs(),
            });
        }
        Ok(Allowed { factor, share })
    }

    fn within_range(&self, joints: &[f64; 6], speeds: &Vector6<f64>) -> Result<(), Blocked> {
        let leaving = (0..6).find(|&index| {
            let (angle, speed) = (joints[index], speeds[index]);
            let outwards = angle * speed > 0.0 && speed.abs() > STILL_RAD_S;
            outwards && angle.abs() > RANGE_RAD[index] - self.margin_rad
        });
        match leaving {
            None => Ok(()),
            Some(index) => Err(Blocked::Range {
                joint: index + 1,
                angle_deg: joints[index].to_degrees(),
            }),
        }
    }
}

/// Speeds of J1 to J6 (rad/s) for a velocity of the tool; `None` where none are determined.
fn joint_speeds(
    joints: &[f64; 6],
    tool_origin: &Vector3<f64>,
    velocity: &Motion,
) -> Option<Vector6<f64>> {
    let flange = forward(joints).translation.vector;
    let arm = flange - tool_origin;
    let shift = if arm.norm() < LONGEST_TOOL_M {
        velocity.angular.cross(&arm)
    } else {
        Vector3::zeros()
    };
    let linear = velocity.linear + shift;
    let angular = velocity.angular;
    let twist = Vector6::new(
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    );
    let matrix: Matrix6<f64> = jacobian(joints);
    let speeds = matrix.lu().solve(&twist)?;
    speeds
        .iter()
        .all(|speed| speed.is_finite())
        .then_some(speeds)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    const GUARD: JointGuard = JointGuard {
        speed_fraction: 0.8,
        singularity_rad: 0.087,
        margin_rad: 0.035,
    };

    /// Elbow and wrist bent by a right angle: the flange is 0.5 m ahead, looking down.
    const BENT: [f64; 6] = [0.0, 0.0, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0];

    fn going(linear: [f64; 3], angular: [f64; 3]) -> Motion {
        Motion {
            linear: linear.into(),
            angular: angular.into(),
        }
    }

    #[test]
    fn joint_speeds_by_hand() {
        let flange = forward(&BENT).translation.vector;
        // The wrist is 0.5 m from the axis of J1: sideways motion turns J1 by v / 0.5, and J6, which
        // looks down, keeps the orientation by turning along with it.
        let speeds = joint_speeds(&BENT, &flange, &going([0.0, 0.1, 0.0], [0.0; 3])).unwrap();
        assert!(
            (speeds[0] - 0.2).abs() < 1e-9 && (speeds[5].abs() - 0.2).abs() < 1e-9,
            "{speeds}"
        );
        // A turn about the vertical through a tool 0.2 m below the flange: the same for the flange.
        let tool = flange - Vector3::z() * 0.2;
        let turn = going([0.0; 3], [0.0, 0.0, 0.3]);
        let (here, there) = (
            joint_speeds(&BENT, &flange, &turn),
            joint_speeds(&BENT, &tool, &turn),
        );
        assert!((here.unwrap() - there.unwrap()).norm() < 1e-9);
        // A turn about the base's x moves the flange sideways where the tool hangs below it.
        let turn = going([0.0; 3], [0.3, 0.0, 0.0]);
        let shifted = going([0.0, -0.06, 0.0], [0.3, 0.0, 0.0]);
        let found = joint_speeds(&BENT, &tool, &turn).unwrap();
        let expected = joint_speeds(&BENT, &flange, &shifted).unwrap();
        assert!((found - expected).norm() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn a_velocity_is_cut_to_the_slowest_joint() {
        let flange = forward(&BENT).translation.vector;
        for speed in [0.1, 0.5, 1.0, 2.0] {
            let velocity = going([0.0, speed, 0.0], [0.0; 3]);
            let allowed = GUARD.allow(&BENT, &flange, &velocity).unwrap();
            let share = speed / 0.5 / SPEED_RAD_S[0];
            assert!(
                (allowed.share - share).abs() < 1e-9,
                "{speed} m/s: {allowed:?}"
            );
            let factor = (0.8 / share).min(1.0);
            assert!(
                (allowed.factor - factor).abs() < 1e-9,
                "{speed} m/s: {allowed:?}"
            );
        }
    }

    #[test]
    fn postures_that_must_not_go_on() {
        let still = going([0.0; 3], [0.0; 3]);
        let sideways = going([0.0, 0.1, 0.0], [0.0; 3]);
        let allow = |joints: [f64; 6], velocity: &Motion| {
            let flange = forward(&joints).translation.vector;
            GUARD.allow(&joints, &flange, velocity)
        };
        let straight = [0.0, 0.3, 0.8, 0.0, 0.05, 0.0];
        assert!(matches!(
            allow(straight, &still),
            Err(Blocked::Wrist { .. })
        ));
        let mut wound = BENT;
        wound[0] = RANGE_RAD[0] - 0.01;
        let towards = Motion {
            linear: forward(&wound).rotation * Vector3::new(0.0, -0.1, 0.0),
            ..still
        };
        let away = towards.scaled(-1.0);
        let results = [allow(wound, &towards), allow(wound, &away)];
        let refused: Vec<_> = results.iter().filter(|result| result.is_err()).collect();
        assert_eq!(refused.len(), 1, "one way only is closed: {results:?}");
        assert!(
            matches!(refused[0], Err(Blocked::Range { joint: 1, .. })),
            "{results:?}"
        );
        // The wrist nearly above the shoulder: sideways motion would spin J1.
        let folded = [0.0, -0.6155, 1.1138, 0.0, 1.0, 0.0];
        let found = allow(folded, &sideways);
        assert!(
            matches!(found, Err(Blocked::Singular { joint: 1, .. })),
            "{found:?}"
        );
    }
}
