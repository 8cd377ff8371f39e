//! Building the machine from the options.

use std::path::Path;

use nalgebra::{Isometry3, Translation3, Vector3};
use pubs_melfa_protocol::pose::quaternion_of;
use pubs_virtual_arm::world::World;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::controller::{Controller, Servo, Settings};
use crate::emulator::StartError;
use crate::machine::Machine;
use crate::mount::{self, Mount};
use crate::options::Options;
use crate::program::Program;
use crate::scenario::Scenario;
use crate::scene::{Fitting, Scene};

/// Speed at which the whole range should be reachable, m/s.
const USUAL_SPEED_M_S: f64 = 0.15;

/// The machine that the options ask for, and what the user should know of it.
///
/// # Errors
///
/// Where they ask for what there is not.
pub fn build(options: &Options) -> Result<(Machine, Option<String>), StartError> {
    let mut world = World::load(&options.world)?;
    world.resistance.scale_friction(options.friction_scale);
    world.resistance.scale_catch(options.catch_scale);
    let mut streams = Xoshiro256PlusPlus::seed_from_u64(options.seed);
    let drawn = streams.random::<f64>();
    let sensor_seed = streams.random::<u64>();
    let (lower, upper) = (world.joint.lower, world.joint.upper);
    let state = lower + (upper - lower) * options.start.unwrap_or(drawn);

    let mount = options
        .mount
        .unwrap_or_else(|| Mount::for_world(&world.name));
    let tool = tool_of(&options.tool);
    let joints = mount::joints_at(&world, &mount, &tool, state)?;
    let warning = warning(&world, &mount, &tool);
    let fitting = Fitting {
        mount: mount.isometry(),
        tool,
        axes: options.sensor_axes,
        bias_n: Vector3::from(options.sensor_bias),
    };
    let scene = Scene::new(&world, state, sensor_seed, fitting);
    let settings = Settings {
        cycle_s: options.cycle_ms / 1000.0,
        mxtout: options.mxtout,
        posture: options.posture,
        servo_delay_s: f64::from(options.servo_delay_ms) / 1000.0,
        sensor_id: options.sensor_id,
        grasp: options.grasp,
    };
    let mut controller = Controller::new(settings, joints, options.stop_scale, scene);
    controller.mode = options.mode;
    if options.servo || options.run {
        controller.servo = Servo::On;
    }
    if let Some(path) = &options.program {
        put_program(&mut controller, path, options.run)?;
    }
    let scenario = match &options.scenario {
        Some(path) => Scenario::load(path)?,
        None => Scenario::default(),
    };
    Ok((Machine::new(controller, scenario, options.clone()), warning))
}

fn tool_of(numbers: &[f64; 6]) -> Isometry3<f64> {
    let [x, y, z, a, b, c] = *numbers;
    Isometry3::from_parts(
        Translation3::new(x / 1000.0, y / 1000.0, z / 1000.0),
        quaternion_of(&[a, b, c].map(f64::to_radians)),
    )
}

fn warning(world: &World, mount: &Mount, tool: &Isometry3<f64>) -> Option<String> {
    match mount::reach(world, mount, tool, USUAL_SPEED_M_S) {
        Ok(reach) if reach.speed_share < 1.0 => None,
        Ok(reach) => Some(format!(
            "at {USUAL_SPEED_M_S} m/s a joint would need {:.1} times its greatest speed somewhere in \
             the object's range; give another --mount",
            reach.speed_share
        )),
        Err(error) => Some(format!(
            "the arm does not reach all of the object's range ({error}); give another --mount"
        )),
    }
}

fn put_program(controller: &mut Controller, path: &Path, run: bool) -> Result<(), StartError> {
    let text = std::fs::read_to_string(path).map_err(|error| StartError::Program {
        path: path.display().to_string(),
        reason: error.to_string(),
    })?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let program = Program::from_lines(text.lines());
    controller.store.insert(&stem, program.clone());
    controller.task.select(&stem, program);
    if run {
        controller.task.start(false);
    }
    Ok(())
}
