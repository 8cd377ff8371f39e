//! What is true of an object: a world file, read strictly.
//!
//! Inside, a joint's position is its handle's way along the path, in metres from the zero of the
//! joint (angle times radius on a hinge), and forces act at the handle along that path. So hinges
//! and slides share every formula.

mod check;
mod error;
mod file;
mod read;

pub use error::WorldError;

use nalgebra::{UnitQuaternion, Vector3};

/// A world file, checked, in SI units.
#[derive(Debug, Clone)]
pub struct World {
    /// Its own name.
    pub name: String,
    /// Kind, limits and place of the joint.
    pub joint: Joint,
    /// What the object sets against motion.
    pub resistance: Resistance,
    /// The fingers on the handle.
    pub grasp: Grasp,
    /// How far the handle leaves the ideal line or arc: lateral (away from the hinge), vertical.
    pub path: [Deviation; 2],
    /// How well the arm follows.
    pub arm: ArmLimits,
    /// The force sensor.
    pub sensor: SensorModel,
}

/// The joint as it is.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Hinge axis to handle, m; `None` on a slide.
    pub radius_m: Option<f64>,
    /// Closed limit, rad or m.
    pub lower: f64,
    /// Open limit, rad or m.
    pub upper: f64,
    /// What the handle feels, kg: inertia over radius squared on a hinge.
    pub mass_kg: f64,
    /// Tool frame at the grasp, unit.
    pub opening: Vector3<f64>,
    /// Tool frame at the grasp, unit; from the handle to the hinge axis. `None` on a slide.
    pub hinge: Option<Vector3<f64>>,
    /// Tool frame at the grasp, unit.
    pub up: Vector3<f64>,
    /// Tool on the handle with the joint at zero, base frame, m.
    pub closed_position_m: Vector3<f64>,
    /// Tool with the joint at zero, base frame.
    pub closed_orientation: UnitQuaternion<f64>,
}

impl Joint {
    /// Metres of the handle's way per unit of the joint: the radius, or 1 on a slide.
    pub fn lever(&self) -> f64 {
        self.radius_m.unwrap_or(1.0)
    }
}

/// Forces against motion, at the handle. Absent parts have zero force.
#[derive(Debug, Clone)]
pub struct Resistance {
    /// Dry friction, N.
    pub coulomb_n: f64,
    /// N per m/s.
    pub viscous_n_s_per_m: f64,
    /// How dry friction varies along the way; its mean is zero, unit N.
    pub ripple: Deviation,
    /// Magnetic catch: Gaussian from the closed limit on.
    pub catch: Bump,
    /// Magnetic seal: exponential from the closed limit on.
    pub seal: Bump,
    /// Self-closing hinge: logistic.
    pub spring_hinge: Logistic,
    /// Closing spring: force at the closed limit, N, and its growth, N/m.
    pub closing_spring: [f64; 2],
    /// The stops at both limits.
    pub stop: Stop,
}

impl Resistance {
    /// Dry and viscous friction times `factor`.
    pub fn scale_friction(&mut self, factor: f64) {
        self.coulomb_n *= factor;
        self.viscous_n_s_per_m *= factor;
        self.ripple.amplitude *= factor;
    }

    /// Force of catch and seal times `factor`.
    pub fn scale_catch(&mut self, factor: f64) {
        self.catch.force_n *= factor;
        self.seal.force_n *= factor;
    }
}

/// A force that is greatest at the closed limit.
#[derive(Debug, Clone, Copy)]
pub struct Bump {
    /// At the closed limit, N.
    pub force_n: f64,
    /// Standard deviation or decay length along the path, m.
    pub width_m: f64,
}

/// `force / (1 + exp((x − middle) / slope))`.
#[derive(Debug, Clone, Copy)]
pub struct Logistic {
    /// Far on the closed side, N.
    pub force_n: f64,
    /// Where half is left, m along the path.
    pub middle_m: f64,
    /// m along the path.
    pub slope_m: f64,
}

/// A stop: pushes only, never holds.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// N/m.
    pub stiffness_n_per_m: f64,
    /// N s/m.
    pub damping_n_s_per_m: f64,
}

/// Springs and dampers between tool and handle: along the path, lateral, vertical.
#[derive(Debug, Clone, Copy)]
pub struct Grasp {
    /// N/m.
    pub stiffness_n_per_m: Vector3<f64>,
    /// N s/m.
    pub damping_n_s_per_m: Vector3<f64>,
    /// The same about every axis, N m/rad.
    pub rotation_nm_per_rad: f64,
}

/// `mean + amplitude · sin(wave_number · x − phase)` along the handle's way x (m).
#[derive(Debug, Clone, Copy)]
pub struct Deviation {
    /// Mean.
    pub mean: f64,
    /// Amplitude, the unit of the mean.
    pub amplitude: f64,
    /// rad per m of the handle's way.
    pub wave_number: f64,
    /// rad.
    pub phase: f64,
}

impl Deviation {
    /// Nothing at all.
    pub const NONE: Self = Self {
        mean: 0.0,
        amplitude: 0.0,
        wave_number: 0.0,
        phase: 0.0,
    };

    /// Value and slope (per m) at `x_m`.
    pub fn at(&self, x_m: f64) -> (f64, f64) {
        if self.amplitude == 0.0 {
            return (self.mean, 0.0);
        }
        let (sine, cosine) = (self.wave_number * x_m - self.phase).sin_cos();
        (
            self.mean + self.amplitude * sine,
            self.amplitude * self.wave_number * cosine,
        )
    }
}

/// How the arm follows a commanded velocity.
#[derive(Debug, Clone, Copy)]
pub struct ArmLimits {
    /// Time constant, s; 0 follows at once.
    pub lag_s: f64,
    /// Bound on every change of velocity, m/s².
    pub acceleration_m_s2: f64,
    /// Standard deviation of each reported coordinate, m.
    pub position_noise_m: f64,
}

/// A force sensor at the wrist.
#[derive(Debug, Clone, Copy)]
pub struct SensorModel {
    /// Fresh at every sample, sd, N.
    pub white_n: f64,
    /// Correlated along the way or in time, sd, N.
    pub correlated_n: f64,
    /// Its correlation fades with this much travel of the tool, m; infinite: never.
    pub correlation_m: f64,
    /// Its correlation fades with this much time, s; infinite: never.
    pub correlation_s: f64,
    /// What a tare leaves behind, drawn anew by each, sd, N.
    pub bias_sd_n: f64,
    /// Drift since the tare, drawn with the bias, sd, N per minute.
    pub drift_n_per_minute: f64,
    /// Step of the output, N; 0: none.
    pub quantum_n: f64,
    /// First-order low-pass on the true force; infinite: none.
    pub bandwidth_hz: f64,
    /// Fresh at every sample, sd, N m.
    pub torque_white_nm: f64,
    /// What a tare does not take away, tool axes, N.
    pub offset_n: Vector3<f64>,
}
