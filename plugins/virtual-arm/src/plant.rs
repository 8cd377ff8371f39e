//! Arm, grasp and object together, one step at a time.

use nalgebra::Vector3;

use crate::arm::Arm;
use crate::geometry::{Geometry, HandleFrame};
use crate::resistance::Resisting;
use crate::world::{Grasp, World};

/// Step of the integrator, s.
pub const STEP_S: f64 = 0.00025;

/// Time for the handle to come to rest in the fingers before anything is told, s.
const SETTLING_S: f64 = 1.0;

/// A joint slower than this, with the arm at rest, stands still, m/s.
const STILL_M_S: f64 = 1e-9;

/// Force and torque at the tool origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// N.
    pub force: Vector3<f64>,
    /// N m.
    pub torque: Vector3<f64>,
}

/// What befalls the object and the grasp besides the arm's motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disturbance {
    /// Somebody else's force on the handle, along its way towards open, N.
    pub push_n: f64,
    /// The object is stuck where it is.
    pub jammed: bool,
    /// The fingers do not hold the handle.
    pub released: bool,
}

/// The physics.
#[derive(Debug, Clone)]
pub struct Plant {
    geometry: Geometry,
    resisting: Resisting,
    grasp: Grasp,
    mass_kg: f64,
    lever: f64,
    /// The arm.
    pub arm: Arm,
    /// Nothing at first.
    pub disturbance: Disturbance,
    /// The handle's way from the zero of the joint, m.
    position_m: f64,
    /// The handle's speed along its way, m/s.
    speed_m_s: f64,
}

impl Plant {
    /// The tool on the handle with the joint at `start` (rad or m), settled.
    pub fn new(world: &World, start: f64, stop_deceleration_m_s2: f64) -> Self {
        let lever = world.joint.lever();
        let geometry = Geometry::new(&world.joint, world.path);
        let position_m = start * lever;
        let arm = Arm::new(
            world.arm,
            stop_deceleration_m_s2,
            geometry.ideal_position_m(position_m),
            geometry.handle(position_m).orientation,
        );
        let (lower_m, upper_m) = (world.joint.lower * lever, world.joint.upper * lever);
        let mut plant = Self {
            geometry,
            resisting: Resisting::new(world.resistance.clone(), lower_m, upper_m),
            grasp: world.grasp,
            mass_kg: world.joint.mass_kg,
            lever,
            arm,
            disturbance: Disturbance::default(),
            position_m,
            speed_m_s: 0.0,
        };
        for _ in 0..(SETTLING_S / STEP_S) as usize {
            plant.step(STEP_S);
        }
        plant
    }

    /// True joint state, rad or m.
    pub fn joint_state(&self) -> f64 {
        self.position_m / self.lever
    }

    /// The handle's way from the zero of the joint, m, and its speed along it, m/s.
    pub fn handle_motion(&self) -> (f64, f64) {
        (self.position_m, self.speed_m_s)
    }

    /// Tool relative to the handle: along the path, lateral, vertical, m.
    pub fn grasp_offset_m(&self) -> Vector3<f64> {
        self.stretch(&self.geometry.handle(self.position_m))
    }

    /// Whether nothing will change until the next command.
    pub fn is_at_rest(&self) -> bool {
        self.arm.is_at_rest() && self.speed_m_s.abs() < STILL_M_S
    }

    /// One step of object and arm.
    pub fn step(&mut self, step_s: f64) {
        self.step_object(step_s);
        self.arm.step(step_s);
    }

    /// One semi-implicit step of the object alone: damping and dry friction at the new speed, so
    /// that friction holds what it can hold and never reverses a motion; springs at the old
    /// position. An arm that is moved by something else is placed before each step by its fields.
    pub fn step_object(&mut self, step_s: f64) {
        let handle = self.geometry.handle(self.position_m);
        let pull = self.spring_force(&handle) + self.dragging_force(&handle);
        let push = handle.slope.dot(&pull) + handle.turn.dot(&self.twisting(&handle))
            - self.resisting.closing_force_n(self.position_m)
            + self.resisting.stop_force_n(self.position_m, self.speed_m_s)
            + self.disturbance.push_n;
        let damping = self.held(&self.grasp.damping_n_s_per_m);
        let drag = handle.slope.component_mul(&handle.slope).dot(&damping)
            + self.resisting.viscous_n_s_per_m();

        let weight = self.mass_kg + step_s * drag;
        let free = (self.mass_kg * self.speed_m_s + step_s * push) / weight;
        let held = step_s * self.resisting.coulomb_n(self.position_m) / weight;
        self.speed_m_s = if self.disturbance.jammed || free.abs() <= held {
            0.0
        } else {
            free - held * free.signum()
        };
        self.position_m += step_s * self.speed_m_s;
    }

    fn spring_force(&self, handle: &HandleFrame) -> Vector3<f64> {
        self.stretch(handle)
            .component_mul(&self.held(&self.grasp.stiffness_n_per_m))
    }

    fn dragging_force(&self, handle: &HandleFrame) -> Vector3<f64> {
        handle
            .local(&self.arm.velocity.linear)
            .component_mul(&self.held(&self.grasp.damping_n_s_per_m))
    }

    /// A property of the grasp: nothing where the fingers do not hold.
    fn held(&self, property: &Vector3<f64>) -> Vector3<f64> {
        match self.disturbance.released {
            false => *property,
            true => Vector3::zeros(),
        }
    }

    /// What the tool exerts on the object at the tool origin, tool axes.
    pub fn wrench(&self) -> Wrench {
        let handle = self.geometry.handle(self.position_m);
        let sliding = handle.local(&self.arm.velocity.linear) - handle.slope * self.speed_m_s;
        let force = self.spring_force(&handle)
            + sliding.component_mul(&self.held(&self.grasp.damping_n_s_per_m));
        let to_tool = self.arm.orientation.inverse();
        Wrench {
            force: to_tool * handle.base(&force),
            torque: to_tool * self.twisting(&handle),
        }
    }

    /// Tool relative to the handle, in the handle's axes, m.
    fn stretch(&self, handle: &HandleFrame) -> Vector3<f64> {
        handle.local(&(self.arm.position_m - handle.position_m))
    }

    /// Torque of the turned grasp on the object, base axes, N m.
    fn twisting(&self, handle: &HandleFrame) -> Vector3<f64> {
        if self.grasp.rotation_nm_per_rad == 0.0 || self.disturbance.released {
            return Vector3::zeros();
        }
        (self.arm.orientation * handle.orientation.inverse()).scaled_axis()
            * self.grasp.rotation_nm_per_rad
    }
}
