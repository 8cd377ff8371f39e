//! Plant and sensor in ticks of one millisecond.
//!
//! Everything happens on ticks, so when and how often somebody reads changes nothing.

use nalgebra::Vector3;
use pubs_plugin::{DriverStatus, Reading, Twist};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::arm::Velocity;
use crate::plant::{Plant, STEP_S};
use crate::sensor::{Sensor, normals};
use crate::trouble::Trouble;
use crate::world::World;

/// Length of a tick, ns.
pub const TICK_NS: u64 = 1_000_000;

const TICK_S: f64 = 0.001;
const STEPS_PER_TICK: usize = (TICK_S / STEP_S) as usize;

/// A scene at rest that is further behind than this many ticks skips what would not change.
const LONG_TICKS: u64 = 500;

/// Ticks that are still run after a skip, for the sensor's filter.
const LAST_TICKS: u64 = 100;

/// The whole simulated scene.
#[derive(Debug, Clone)]
pub struct Simulation {
    plant: Plant,
    sensor: Sensor,
    position_noise_m: f64,
    position_noise: Xoshiro256PlusPlus,
    reported_m: Vector3<f64>,
    origin_ns: u64,
    ticks: u64,
    expires_ns: u64,
    trouble: Trouble,
    first_command_ns: Option<u64>,
}

impl Simulation {
    /// The joint at `start` (a fraction of its range, or drawn evenly over it), the tool at rest on
    /// the handle, at time `origin_ns`.
    pub fn new(
        world: &World,
        start: Option<f64>,
        trouble: Trouble,
        seed: u64,
        stop_deceleration_m_s2: f64,
        origin_ns: u64,
    ) -> Self {
        let mut streams = Xoshiro256PlusPlus::seed_from_u64(seed);
        let fraction = streams.random::<f64>();
        let sensor_seed = streams.random::<u64>();
        let position_noise = Xoshiro256PlusPlus::seed_from_u64(streams.random::<u64>());
        let joint = &world.joint;
        let state = joint.lower + (joint.upper - joint.lower) * start.unwrap_or(fraction);
        let plant = Plant::new(world, state, stop_deceleration_m_s2);
        Self {
            sensor: Sensor::new(world.sensor, sensor_seed, plant.wrench()),
            position_noise_m: world.arm.position_noise_m,
            position_noise,
            reported_m: plant.arm.position_m,
            plant,
            origin_ns,
            ticks: 0,
            expires_ns: 0,
            trouble,
            first_command_ns: None,
        }
    }

    /// Gives the present tick another name; nothing else changes.
    pub fn set_time(&mut self, time_ns: u64) {
        self.origin_ns = time_ns;
        self.ticks = 0;
    }

    /// Runs all ticks up to `time_ns`.
    pub fn advance_to(&mut self, time_ns: u64) {
        let due = time_ns.saturating_sub(self.origin_ns) / TICK_NS;
        while self.ticks < due {
            if due - self.ticks > LONG_TICKS && self.plant.is_at_rest() {
                self.ticks = due - LAST_TICKS;
            }
            self.tick();
        }
    }

    fn tick(&mut self) {
        if self.plant.arm.is_following() && self.now_ns() >= self.expires_ns {
            self.plant.arm.ramp_to_rest();
        }
        if let Some(first_ns) = self.first_command_ns {
            let time_s = (self.now_ns() - first_ns) as f64 * 1e-9;
            self.plant.disturbance = self.trouble.at(time_s);
        }
        let from = self.plant.arm.position_m;
        for _ in 0..STEPS_PER_TICK {
            self.plant.step(STEP_S);
        }
        self.ticks += 1;
        let travel_m = (self.plant.arm.position_m - from).norm();
        self.sensor.tick(TICK_S, travel_m, self.plant.wrench());
        self.reported_m =
            self.plant.arm.position_m + normals(&mut self.position_noise) * self.position_noise_m;
    }

    fn now_ns(&self) -> u64 {
        self.origin_ns + self.ticks * TICK_NS
    }

    /// Follows `twist` until `expires_ns`.
    pub fn command(&mut self, twist: Twist, expires_ns: u64) {
        self.expires_ns = expires_ns;
        self.first_command_ns.get_or_insert(self.now_ns());
        self.plant.arm.follow(Velocity {
            linear: Vector3::from(twist.linear_m_s),
            angular: Vector3::from(twist.angular_rad_s),
        });
    }

    /// Ramps to rest.
    pub fn stop(&mut self) {
        self.plant.arm.ramp_to_rest();
    }

    /// Tares the sensor; says how fast the tool moves where it is not at rest.
    pub fn tare(&mut self) -> Result<(), f64> {
        if !self.plant.arm.is_at_rest() {
            return Err(self.plant.arm.velocity.linear.norm());
        }
        self.sensor.tare();
        Ok(())
    }

    /// What was measured at the newest tick.
    pub fn reading(&self) -> Reading {
        let arm = &self.plant.arm;
        let wrench = self.sensor.sample();
        let quaternion = arm.orientation.quaternion();
        Reading {
            time_ns: self.now_ns(),
            position_m: self.reported_m.into(),
            orientation_xyzw: [quaternion.i, quaternion.j, quaternion.k, quaternion.w],
            force_n: wrench.force.into(),
            torque_nm: wrench.torque.into(),
            status: if arm.is_following() {
                DriverStatus::Ready
            } else {
                DriverStatus::Stopped
            },
        }
    }

    /// True joint state, rad or m.
    pub fn joint_state(&self) -> f64 {
        self.plant.joint_state()
    }
}
