//! What the arm holds: the object, the fingers on it and the force sensor, driven by the joints.

use nalgebra::{Isometry3, Vector3, Vector6};
use pubs_melfa_protocol::arm;
use pubs_virtual_arm::arm::Velocity;
use pubs_virtual_arm::plant::{Disturbance, Plant, STEP_S, Wrench};
use pubs_virtual_arm::sensor::Sensor;
use pubs_virtual_arm::world::World;

use crate::axes::AxisMap;

/// Longest time between two samples of the sensor, s.
const TICK_S: f64 = 0.001;

/// The arm's own stops are not the plant's: its follower never moves.
const UNUSED_DECELERATION_M_S2: f64 = 1.0;

/// What stands between robot and object.
#[derive(Debug, Clone, Copy)]
pub struct Fitting {
    /// The world's frame in the robot's base.
    pub mount: Isometry3<f64>,
    /// The tool in the flange.
    pub tool: Isometry3<f64>,
    /// The sensor's axes.
    pub axes: AxisMap,
    /// What the sensor shows of nothing, sensor axes, N.
    pub bias_n: Vector3<f64>,
}

/// Faults of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorFault {
    /// No component is shown beyond plus and minus this, N.
    pub saturation_n: f64,
    /// Added to the bias, N.
    pub step_n: Vector3<f64>,
    /// Added to the bias with time, N/s.
    pub rate_n_per_s: Vector3<f64>,
}

impl Default for SensorFault {
    fn default() -> Self {
        Self {
            saturation_n: f64::INFINITY,
            step_n: Vector3::zeros(),
            rate_n_per_s: Vector3::zeros(),
        }
    }
}

/// Plant and sensor behind the arm.
#[derive(Debug, Clone)]
pub struct Scene {
    fitting: Fitting,
    plant: Plant,
    sensor: Sensor,
    /// Faults of the sensor.
    pub sensor_fault: SensorFault,
}

impl Scene {
    /// The tool on the handle, the joint of the object at `state` (rad or m).
    pub fn new(world: &World, state: f64, sensor_seed: u64, fitting: Fitting) -> Self {
        let plant = Plant::new(world, state, UNUSED_DECELERATION_M_S2);
        Self {
            sensor: Sensor::new(world.sensor, sensor_seed, plant.wrench()),
            plant,
            fitting,
            sensor_fault: SensorFault::default(),
        }
    }

    /// The tool in the robot's base with these joints.
    pub fn tool(&self, joints: &[f64; 6]) -> Isometry3<f64> {
        arm::forward(joints) * self.fitting.tool
    }

    /// The flange that puts the tool there.
    pub fn flange(&self, tool: &Isometry3<f64>) -> Isometry3<f64> {
        tool * self.fitting.tool.inverse()
    }

    /// The tool in the flange.
    pub fn tool_offset(&self) -> &Isometry3<f64> {
        &self.fitting.tool
    }

    /// Moves the joints evenly from one position to another, and the object with them.
    pub fn advance(&mut self, from: &[f64; 6], to: &[f64; 6], duration_s: f64) {
        let ticks = (duration_s / TICK_S).ceil();
        let tick_s = duration_s / ticks;
        let steps = (tick_s / STEP_S).ceil();
        let rates: [f64; 6] = std::array::from_fn(|joint| (to[joint] - from[joint]) / duration_s);
        let at = |time_s: f64| std::array::from_fn(|joint| from[joint] + rates[joint] * time_s);
        for tick in 0..ticks as u32 {
            let start_s = f64::from(tick) * tick_s;
            let before = self.plant.arm.position_m;
            for step in 0..steps as u32 {
                self.place(&at(start_s + f64::from(step) * tick_s / steps), &rates);
                self.plant.step_object(tick_s / steps);
            }
            self.place(&at(start_s + tick_s), &rates);
            let travel_m = (self.plant.arm.position_m - before).norm();
            self.sensor.tick(tick_s, travel_m, self.plant.wrench());
        }
        self.sensor_fault.step_n += self.sensor_fault.rate_n_per_s * duration_s;
    }

    /// Puts the tool where these joints, at these speeds, have it.
    fn place(&mut self, joints: &[f64; 6], rates: &[f64; 6]) {
        let flange = arm::forward(joints);
        let moving = arm::jacobian(joints) * Vector6::from(*rates);
        let (linear, angular) = (moving.fixed_rows::<3>(0), moving.fixed_rows::<3>(3));
        let (linear, angular): (Vector3<f64>, Vector3<f64>) = (linear.into(), angular.into());
        let lever = flange.rotation * self.fitting.tool.translation.vector;
        let tool = self.fitting.mount.inverse() * flange * self.fitting.tool;
        let to_world = self.fitting.mount.rotation.inverse();
        let arm = &mut self.plant.arm;
        arm.position_m = tool.translation.vector;
        arm.orientation = tool.rotation;
        arm.velocity = Velocity {
            linear: to_world * (linear + angular.cross(&lever)),
            angular: to_world * angular,
        };
    }

    /// What the sensor shows: its own axes, not tared, N and N m.
    pub fn shown(&self) -> Wrench {
        let at_flange = self.to_flange(self.sensor.sample());
        let axes = &self.fitting.axes;
        let force = axes.apply(&at_flange.force) + self.fitting.bias_n + self.sensor_fault.step_n;
        let most = self.sensor_fault.saturation_n;
        Wrench {
            force: force.map(|component| component.clamp(-most, most)),
            torque: axes.apply(&at_flange.torque),
        }
    }

    /// What the tool truly exerts on the object at the flange, flange axes.
    pub fn true_wrench(&self) -> Wrench {
        self.to_flange(self.plant.wrench())
    }

    fn to_flange(&self, at_tool: Wrench) -> Wrench {
        let tool = &self.fitting.tool;
        let force = tool.rotation * at_tool.force;
        Wrench {
            force,
            torque: tool.rotation * at_tool.torque + tool.translation.vector.cross(&force),
        }
    }

    /// True joint state of the object, rad or m.
    pub fn joint_state(&self) -> f64 {
        self.plant.joint_state()
    }

    /// Speed of the handle along its way, m/s.
    pub fn handle_speed_m_s(&self) -> f64 {
        self.plant.handle_motion().1
    }

    /// What befalls the object.
    pub fn disturbance(&mut self) -> &mut Disturbance {
        &mut self.plant.disturbance
    }

    /// How far the tool is from the handle, m.
    pub fn handle_distance_m(&self) -> f64 {
        self.plant.grasp_offset_m().norm()
    }

    /// Whether the fingers hold the handle.
    pub fn is_held(&self) -> bool {
        !self.plant.disturbance.released
    }
}
