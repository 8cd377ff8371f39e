//! From a name or a path to a checked [`World`].

use std::f64::consts::TAU;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::check::{DIRECTION_TOLERANCE, Reader};
use super::file::{BumpTable, DeviationTable, JointKind, JointTable, SensorTable, WorldFile};
use super::{
    ArmLimits, Bump, Deviation, Grasp, Joint, Logistic, Resistance, SensorModel, Stop, World,
    WorldError,
};
use crate::plant::STEP_S;

const SCHEMA: u32 = 1;

const BUILT_IN: &[(&str, &str)] = &[
    ("door1", include_str!("../../worlds/door1.toml")),
    ("door2", include_str!("../../worlds/door2.toml")),
    ("drawer1", include_str!("../../worlds/drawer1.toml")),
    ("drawer2", include_str!("../../worlds/drawer2.toml")),
    ("fridge", include_str!("../../worlds/fridge.toml")),
];

impl World {
    /// The names of the built-in worlds.
    pub fn built_in() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// Reads a built-in world by name, or a file where the name ends in `.toml`.
    ///
    /// # Errors
    /// Where there is no such world or it is not valid.
    pub fn load(name: &str) -> Result<Self, WorldError> {
        if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Self::parse(name, text);
        }
        if !name.ends_with(".toml") {
            let known = Self::built_in().collect::<Vec<_>>().join(", ");
            return Err(WorldError::Unknown {
                name: name.to_owned(),
                known,
            });
        }
        let text = std::fs::read_to_string(name).map_err(|error| WorldError::Unreadable {
            path: name.to_owned(),
            folder: std::env::current_dir()
                .map_or_else(|_| "?".to_owned(), |folder| folder.display().to_string()),
            reason: error.to_string(),
        })?;
        Self::parse(name, &text)
    }

    /// Reads the text of a world file; `name` is for messages.
    ///
    /// # Errors
    /// Where it is not valid.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        let file: WorldFile = toml::from_str(text).map_err(|error| WorldError::Format {
            name: name.to_owned(),
            text: with_nearest_key(&error),
        })?;
        Reader { name }.world(file)
    }
}

/// toml's own account (line, column, valid keys), with the nearest valid key after it.
fn with_nearest_key(error: &toml::de::Error) -> String {
    let account = error.to_string().trim_end().to_owned();
    let mut quoted = error.message().split('`').skip(1).step_by(2);
    let (true, Some(unknown)) = (error.message().starts_with("unknown field"), quoted.next())
    else {
        return account;
    };
    let nearest = quoted.max_by(|a, b| {
        strsim::jaro_winkler(a, unknown).total_cmp(&strsim::jaro_winkler(b, unknown))
    });
    nearest.map_or(account.clone(), |key| {
        format!("{account}\nnearest valid key: `{key}`")
    })
}

impl Reader<'_> {
    fn world(&self, file: WorldFile) -> Result<World, WorldError> {
        self.require("schema", file.schema, file.schema == SCHEMA, "1")?;
        let joint = self.joint(&file.joint)?;
        let lever = joint.radius_m;
        let resistance = self.resistance(&file, lever)?;
        let path = [
            self.deviation("path.lateral", file.path.lateral.as_ref(), lever)?,
            self.deviation("path.vertical", file.path.vertical.as_ref(), lever)?,
        ];
        let grasp = self.grasp(&file)?;
        let arm = ArmLimits {
            lag_s: self.not_negative("arm.lag_s", file.arm.lag_s)?,
            acceleration_m_s2: self
                .positive("arm.acceleration_m_s2", file.arm.acceleration_m_s2)?,
            position_noise_m: self
                .not_negative("arm.position_noise_m", file.arm.position_noise_m)?,
        };
        let sensor = self.sensor(&file.sensor)?;
        let world = World {
            name: file.name,
            joint,
            resistance,
            grasp,
            path,
            arm,
            sensor,
        };
        self.integrable(&world)?;
        Ok(world)
    }

    fn joint(&self, table: &JointTable) -> Result<Joint, WorldError> {
        let revolute = table.r#type == JointKind::Revolute;
        let (limits_key, limits, unit) = if revolute {
            self.absent(
                "joint.limits_m",
                table.limits_m.is_none(),
                "left out on a revolute joint",
            )?;
            self.absent(
                "joint.mass_kg",
                table.mass_kg.is_none(),
                "left out on a revolute joint",
            )?;
            ("joint.limits_deg", table.limits_deg, 1f64.to_radians())
        } else {
            let rule = "left out on a prismatic joint";
            self.absent("joint.limits_deg", table.limits_deg.is_none(), rule)?;
            self.absent("joint.radius_m", table.radius_m.is_none(), rule)?;
            self.absent("joint.inertia_kg_m2", table.inertia_kg_m2.is_none(), rule)?;
            self.absent(
                "joint.hinge_direction",
                table.hinge_direction.is_none(),
                rule,
            )?;
            ("joint.limits_m", table.limits_m, 1.0)
        };
        let [lower, upper] = self.given(limits_key, limits)?;
        self.require(
            limits_key,
            format!("[{lower}, {upper}]"),
            lower < upper && (upper - lower).is_finite(),
            "[closed, open] with closed < open",
        )?;
        self.require(
            limits_key,
            upper - lower,
            !revolute || upper - lower < 360.0,
            "less than a full turn",
        )?;

        let (radius_m, mass_kg) = if revolute {
            let radius = self.positive(
                "joint.radius_m",
                self.given("joint.radius_m", table.radius_m)?,
            )?;
            let inertia = self.positive(
                "joint.inertia_kg_m2",
                self.given("joint.inertia_kg_m2", table.inertia_kg_m2)?,
            )?;
            (Some(radius), inertia / (radius * radius))
        } else {
            (
                None,
                self.positive("joint.mass_kg", self.given("joint.mass_kg", table.mass_kg)?)?,
            )
        };

        let opening = self.direction("joint.opening_direction", table.opening_direction)?;
        let up = self.direction("joint.up_direction", table.up_direction)?;
        self.require(
            "joint.up_direction",
            format!("{:?}", table.up_direction),
            opening.dot(&up).abs() < 0.9,
            "well off the opening direction",
        )?;
        let hinge = match table.hinge_direction {
            Some(hinge) => Some(self.direction("joint.hinge_direction", hinge)?),
            None if revolute => Some(self.given("joint.hinge_direction", None)?),
            None => None,
        };
        let square = hinge.is_none_or(|hinge| hinge.dot(&opening).abs() < DIRECTION_TOLERANCE);
        self.require(
            "joint.hinge_direction",
            format!("{:?}", table.hinge_direction),
            square,
            "at a right angle to the opening direction",
        )?;

        let [x, y, z, w] = table.closed_orientation_xyzw;
        let quaternion = Quaternion::new(w, x, y, z);
        self.require(
            "joint.closed_orientation_xyzw",
            format!("{:?}", [x, y, z, w]),
            (quaternion.norm() - 1.0).abs() < DIRECTION_TOLERANCE,
            "a unit quaternion (x, y, z, w)",
        )?;
        let position = Vector3::from(table.closed_position_m);
        self.require(
            "joint.closed_position_m",
            format!("{:?}", table.closed_position_m),
            position.norm().is_finite(),
            "finite",
        )?;
        Ok(Joint {
            radius_m,
            lower: lower * unit,
            upper: upper * unit,
            mass_kg,
            opening,
            hinge,
            up,
            closed_position_m: position,
            closed_orientation: UnitQuaternion::new_normalize(quaternion),
        })
    }

    fn resistance(&self, file: &WorldFile, radius: Option<f64>) -> Result<Resistance, WorldError> {
        let friction = &file.friction;
        let ripple = DeviationTable {
            mean_m: 0.0,
            amplitude_m: friction.ripple_n,
            period_deg: friction.ripple_period_deg,
            period_m: friction.ripple_period_m,
            phase_deg: friction.ripple_phase_deg,
        };
        let ripple = if friction.ripple_n == 0.0 {
            Deviation::NONE
        } else {
            self.deviation("friction.ripple", Some(&ripple), radius)?
        };
        let coulomb_n = self.not_negative("friction.coulomb_n", friction.coulomb_n)?;
        self.require(
            "friction.ripple_n",
            friction.ripple_n,
            friction.ripple_n.abs() <= coulomb_n,
            "at most coulomb_n",
        )?;
        let spring_hinge = match &file.spring_hinge {
            None => Logistic {
                force_n: 0.0,
                middle_m: 0.0,
                slope_m: 1.0,
            },
            Some(table) => Logistic {
                force_n: self.not_negative("spring_hinge.force_n", table.force_n)?,
                middle_m: self.length(
                    "spring_hinge.middle",
                    table.middle_deg,
                    table.middle_m,
                    radius,
                )?,
                slope_m: self.positive(
                    "spring_hinge.slope",
                    self.length("spring_hinge.slope", table.slope_deg, table.slope_m, radius)?,
                )?,
            },
        };
        let closing_spring = match &file.closing_spring {
            None => [0.0, 0.0],
            Some(table) => [
                self.not_negative("closing_spring.force_n", table.force_n)?,
                self.not_negative("closing_spring.stiffness_n_per_m", table.stiffness_n_per_m)?,
            ],
        };
        Ok(Resistance {
            coulomb_n,
            viscous_n_s_per_m: self
                .not_negative("friction.viscous_n_s_per_m", friction.viscous_n_s_per_m)?,
            ripple,
            catch: self.bump("catch", file.catch.as_ref(), radius)?,
            seal: self.bump("seal", file.seal.as_ref(), radius)?,
            spring_hinge,
            closing_spring,
            stop: Stop {
                stiffness_n_per_m: self
                    .positive("stop.stiffness_n_per_m", file.stop.stiffness_n_per_m)?,
                damping_n_s_per_m: self
                    .not_negative("stop.damping_n_s_per_m", file.stop.damping_n_s_per_m)?,
            },
        })
    }

    fn bump(
        &self,
        key: &str,
        table: Option<&BumpTable>,
        radius: Option<f64>,
    ) -> Result<Bump, WorldError> {
        let Some(table) = table else {
            return Ok(Bump {
                force_n: 0.0,
                width_m: 1.0,
            });
        };
        let width = self.length(
            &format!("{key}.width"),
            table.width_deg,
            table.width_m,
            radius,
        )?;
        Ok(Bump {
            force_n: self.not_negative(&format!("{key}.force_n"), table.force_n)?,
            width_m: self.positive(&format!("{key}.width"), width)?,
        })
    }

    fn deviation(
        &self,
        key: &str,
        table: Option<&DeviationTable>,
        radius: Option<f64>,
    ) -> Result<Deviation, WorldError> {
        let Some(table) = table else {
            return Ok(Deviation::NONE);
        };
        let period_key = format!("{key}.period");
        let period = self.positive(
            &period_key,
            self.length(&period_key, table.period_deg, table.period_m, radius)?,
        )?;
        let parts = [table.mean_m, table.amplitude_m, table.phase_deg];
        self.require(
            key,
            format!("{parts:?}"),
            parts.iter().all(|part| part.is_finite()),
            "finite",
        )?;
        Ok(Deviation {
            mean: table.mean_m,
            amplitude: table.amplitude_m,
            wave_number: TAU / period,
            phase: table.phase_deg.to_radians(),
        })
    }

    fn grasp(&self, file: &WorldFile) -> Result<Grasp, WorldError> {
        let table = &file.grasp;
        for stiffness in table.stiffness_n_per_m {
            self.positive("grasp.stiffness_n_per_m", stiffness)?;
        }
        for damping in table.damping_n_s_per_m {
            self.not_negative("grasp.damping_n_s_per_m", damping)?;
        }
        Ok(Grasp {
            stiffness_n_per_m: Vector3::from(table.stiffness_n_per_m),
            damping_n_s_per_m: Vector3::from(table.damping_n_s_per_m),
            rotation_nm_per_rad: self
                .not_negative("grasp.rotation_nm_per_rad", table.rotation_nm_per_rad)?,
        })
    }

    fn sensor(&self, table: &SensorTable) -> Result<SensorModel, WorldError> {
        let or_infinite = |key: &str, value: Option<f64>| match value {
            None => Ok(f64::INFINITY),
            Some(value) => self.positive(key, value),
        };
        Ok(SensorModel {
            white_n: self.not_negative("sensor.white_n", table.white_n)?,
            correlated_n: self.not_negative("sensor.correlated_n", table.correlated_n)?,
            correlation_m: or_infinite("sensor.correlation_m", table.correlation_m)?,
            correlation_s: or_infinite("sensor.correlation_s", table.correlation_s)?,
            bias_sd_n: self.not_negative("sensor.bias_sd_n", table.bias_sd_n)?,
            drift_n_per_minute: self
                .not_negative("sensor.drift_n_per_minute", table.drift_n_per_minute)?,
            quantum_n: self.not_negative("sensor.quantum_n", table.quantum_n)?,
            bandwidth_hz: or_infinite("sensor.bandwidth_hz", table.bandwidth_hz)?,
            torque_white_nm: self.not_negative("sensor.torque_white_nm", table.torque_white_nm)?,
            offset_n: Vector3::zeros(),
        })
    }

    /// The integrator is stable while a step is short against the fastest oscillation and the
    /// fastest decay.
    fn integrable(&self, world: &World) -> Result<(), WorldError> {
        let mass = world.joint.mass_kg;
        let stop = world.resistance.stop;
        let stiffness = world.grasp.stiffness_n_per_m.x + stop.stiffness_n_per_m;
        let angle_per_step = (stiffness / mass).sqrt() * STEP_S;
        self.require(
            "stop.stiffness_n_per_m",
            stop.stiffness_n_per_m,
            angle_per_step < 0.5,
            "softer, or the object heavier: too fast for the integrator",
        )?;
        let decay_per_step = stop.damping_n_s_per_m / mass * STEP_S;
        self.require(
            "stop.damping_n_s_per_m",
            stop.damping_n_s_per_m,
            decay_per_step < 0.5,
            "less, or the object heavier: too fast for the integrator",
        )
    }
}
