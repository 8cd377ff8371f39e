//! The simulated scene as a [`Driver`].

use pubs_plugin::{Driver, DriverSetup, JointType, PluginError, Reading, Twist};

use crate::clock::monotonic_ns;
use crate::params::{self, Params};
use crate::simulation::Simulation;
use crate::world::World;

/// A simulated arm with its tool on a simulated object.
///
/// In real time every call first integrates up to the host's monotonic clock. The first
/// `advance_to` puts the scene back to its beginning and starts virtual time there, so that what
/// was read before makes no difference; it is refused once the arm was commanded in real time.
///
/// The gripper holds the handle from the start. `tare` stands for one that was done before the
/// contact: it removes the sensor's own offset (and leaves a small bias), not the grasp's force.
pub struct VirtualArm {
    simulation: Simulation,
    beginning: Simulation,
    time: Time,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Time {
    Real { commanded: bool },
    Virtual { now_ns: u64 },
}

impl VirtualArm {
    fn catch_up(&mut self) {
        if let Time::Real { .. } = self.time {
            self.simulation.advance_to(monotonic_ns());
        }
    }
}

/// Refuses an object file that takes a hinge for a slide, or a slide for a hinge.
fn same_kind(believed: JointType, name: &str, world: &World) -> Result<(), PluginError> {
    let (kind, expected, word) = match world.joint.radius_m {
        Some(_) => ("a hinge", JointType::Revolute, "revolute"),
        None => ("a slide", JointType::Prismatic, "prismatic"),
    };
    if believed == expected {
        return Ok(());
    }
    Err(PluginError::new(format!(
        "params: world \"{name}\" has {kind}, which the object's joint is not; name another world, or write joint.type = \"{word}\""
    )))
}

impl Driver for VirtualArm {
    const NAME: &'static str = "virtual-arm";
    const VERSION: &'static str = env!("CARGO_PKG_VERSION");
    const PARAMS_SCHEMA: &'static str = params::SCHEMA;
    const VIRTUAL_TIME: bool = true;

    fn open(setup: &DriverSetup) -> Result<Self, PluginError> {
        let params = Params::from_driver_table(&setup.driver)?;
        let world = params
            .world()
            .map_err(|error| PluginError::new(error.to_string()))?;
        same_kind(setup.joint.r#type, &params.world, &world)?;
        let deceleration = setup.control.stop_deceleration_m_s2;
        if !(deceleration > 0.0 && deceleration.is_finite()) {
            return Err(PluginError::new(format!(
                "control.stop_deceleration_m_s2 = {deceleration}, but it must be positive"
            )));
        }
        let simulation = Simulation::new(
            &world,
            params.start,
            params.trouble,
            setup.seed,
            deceleration,
            monotonic_ns(),
        );
        Ok(Self {
            beginning: simulation.clone(),
            simulation,
            time: Time::Real { commanded: false },
        })
    }

    fn sensor(&self) -> &str {
        Self::NAME
    }

    fn read(&mut self) -> Result<Reading, PluginError> {
        self.catch_up();
        Ok(self.simulation.reading())
    }

    fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), PluginError> {
        let finite = twist
            .linear_m_s
            .iter()
            .chain(&twist.angular_rad_s)
            .all(|part| part.is_finite());
        if !finite {
            return Err(PluginError::new(format!(
                "refused a twist that is not finite: {twist:?}"
            )));
        }
        self.catch_up();
        if let Time::Real { commanded } = &mut self.time {
            *commanded = true;
        }
        self.simulation.command(twist, expires_ns);
        Ok(())
    }

    fn tare(&mut self) -> Result<(), PluginError> {
        self.catch_up();
        self.simulation.tare().map_err(|speed| {
            PluginError::new(format!(
                "tare needs an arm at rest, but the tool moves at {speed:.3} m/s"
            ))
        })
    }

    fn stop(&mut self) -> Result<(), PluginError> {
        self.catch_up();
        self.simulation.stop();
        Ok(())
    }

    fn advance_to(&mut self, time_ns: u64) -> Result<(), PluginError> {
        match self.time {
            Time::Real { commanded: true } => {
                return Err(PluginError::new(
                    "virtual time cannot start after a command in real time",
                ));
            }
            Time::Real { commanded: false } => {
                self.simulation = self.beginning.clone();
                self.simulation.set_time(time_ns);
            }
            Time::Virtual { now_ns } if time_ns < now_ns => {
                return Err(PluginError::new(format!(
                    "cannot go back to {time_ns} ns: it is {now_ns} ns already"
                )));
            }
            Time::Virtual { .. } => self.simulation.advance_to(time_ns),
        }
        self.time = Time::Virtual { now_ns: time_ns };
        Ok(())
    }

    fn truth(&mut self) -> Option<f64> {
        self.catch_up();
        Some(self.simulation.joint_state())
    }
}
