//! The law (12)-(13) of the engine's controller, and the guard's force limit.

use nalgebra::{Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};
use pubs_plugin::{Reading, Twist};
use pubs_virtual_arm::world::Joint;

use crate::arguments::Arguments;

pub const RATE_HZ: f64 = 100.0;

/// A tool that is off the arc is drawn back to it with this rate.
const ARC_CORRECTION_PER_S: f64 = 5.0;

/// Below this speed the correction fades out.
const FULL_CORRECTION_SPEED_M_S: f64 = 0.02;

/// A movement action.
pub struct Action {
    pub name: &'static str,
    /// 1 opens, -1 closes.
    pub sign: f64,
    pub high_force: bool,
}

pub const ACTIONS: [Action; 4] = [
    Action {
        name: "safe_open",
        sign: 1.0,
        high_force: false,
    },
    Action {
        name: "safe_close",
        sign: -1.0,
        high_force: false,
    },
    Action {
        name: "high_open",
        sign: 1.0,
        high_force: true,
    },
    Action {
        name: "high_close",
        sign: -1.0,
        high_force: true,
    },
];

impl Action {
    /// The safe action the other way.
    pub fn opposite(&self) -> &'static Self {
        if self.sign > 0.0 {
            &ACTIONS[1]
        } else {
            &ACTIONS[0]
        }
    }
}

/// The believed line or arc, fixed in the base frame at the grasp.
#[derive(Clone)]
pub struct Path {
    grasp: Vector3<f64>,
    opening: Vector3<f64>,
    up: Vector3<f64>,
    /// Centre, axis and radius.
    arc: Option<(Vector3<f64>, Unit<Vector3<f64>>, f64)>,
}

impl Path {
    pub fn at_grasp(joint: &Joint, reading: &Reading) -> Self {
        let orientation = orientation(reading);
        let grasp = Vector3::from(reading.position_m);
        let opening = orientation * joint.opening;
        let arc = joint.radius_m.zip(joint.hinge).map(|(radius, hinge)| {
            let hinge = orientation * hinge;
            (
                grasp + hinge * radius,
                Unit::new_normalize(opening.cross(&hinge)),
                radius,
            )
        });
        Self {
            grasp,
            opening,
            up: orientation * joint.up,
            arc,
        }
    }

    /// Joint displacement since the grasp, rad or m.
    pub fn displacement(&self, reading: &Reading) -> f64 {
        let position = Vector3::from(reading.position_m);
        let Some((centre, axis, _)) = &self.arc else {
            return self.opening.dot(&(position - self.grasp));
        };
        let (from, to) = (self.grasp - centre, position - centre);
        axis.dot(&from.cross(&to)).atan2(from.dot(&to))
    }

    /// Unit direction of opening at the tool.
    fn tangent(&self, reading: &Reading) -> Vector3<f64> {
        match &self.arc {
            None => self.opening,
            Some((centre, axis, _)) => axis
                .cross(&(Vector3::from(reading.position_m) - centre))
                .normalize(),
        }
    }

    /// (f_d, f_z, f_n) for a motion towards open (1) or closed (-1).
    pub fn forces(&self, reading: &Reading, sign: f64) -> [f64; 3] {
        let along = self.tangent(reading) * sign;
        let up = (self.up - along * along.dot(&self.up)).normalize();
        let force = orientation(reading) * Vector3::from(reading.force_n);
        [
            along.dot(&force),
            up.dot(&force),
            up.cross(&along).dot(&force),
        ]
    }

    fn twist(&self, reading: &Reading, speed_m_s: f64) -> Twist {
        let Some((centre, axis, radius)) = &self.arc else {
            return Twist {
                linear_m_s: (self.opening * speed_m_s).into(),
                angular_rad_s: [0.0; 3],
            };
        };
        let turn = speed_m_s / radius;
        let arm = Vector3::from(reading.position_m) - centre;
        let height = axis.into_inner() * axis.dot(&arm);
        let level = arm - height;
        let half_a_period = Rotation3::from_axis_angle(axis, 0.5 * turn / RATE_HZ);
        let off_arc = level.normalize() * (level.norm() - radius) + height;
        let moving = (speed_m_s.abs() / FULL_CORRECTION_SPEED_M_S).min(1.0);
        let linear = half_a_period * self.tangent(reading) * speed_m_s
            - off_arc * (ARC_CORRECTION_PER_S * moving);
        Twist {
            linear_m_s: linear.into(),
            angular_rad_s: (axis.into_inner() * turn).into(),
        }
    }
}

fn orientation(reading: &Reading) -> UnitQuaternion<f64> {
    let [x, y, z, w] = reading.orientation_xyzw;
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

/// Ramps the speed towards that of an action.
#[derive(Default)]
pub struct Controller {
    speed_m_s: f64,
    /// The guard stopped the motion; it stays stopped.
    pub guarded: bool,
}

impl Controller {
    pub fn twist(
        &mut self,
        path: &Path,
        reading: &Reading,
        action: &Action,
        settings: &Arguments,
    ) -> Twist {
        let force = path.forces(reading, action.sign)[0];
        let overshoot = settings.contact_stiffness_n_per_m
            * (self.speed_m_s.abs() * 2.0 / RATE_HZ
                + self.speed_m_s.powi(2) / (2.0 * settings.stop_deceleration_m_s2));
        self.guarded |= force > settings.force_limit_n - overshoot;
        let target = match action.high_force {
            _ if self.guarded => 0.0,
            false if force > settings.force_threshold_n => 0.0,
            false => action.sign * settings.safe_speed_m_s,
            true => action.sign * settings.high_speed_m_s,
        };
        let bound = if target == 0.0 {
            settings.stop_deceleration_m_s2
        } else {
            settings.acceleration_m_s2
        };
        let step = bound / RATE_HZ;
        self.speed_m_s += (target - self.speed_m_s).clamp(-step, step);
        path.twist(reading, self.speed_m_s)
    }
}
