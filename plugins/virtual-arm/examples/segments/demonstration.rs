//! Carrying out an action, and what the filter would see of it.

use pubs_plugin::{ControlSetup, Driver, DriverSetup, JointSetup, JointType, PluginError, Reading};
use pubs_virtual_arm::VirtualArm;
use pubs_virtual_arm::world::World;

use crate::arguments::Arguments;
use crate::controller::{Action, Controller, Path, RATE_HZ};

const FILTER_HZ: f64 = 30.0;

const COMMAND_LIFE_NS: u64 = 100_000_000;

/// Long enough to cross any range in safe mode and to stand at the far limit for a while.
const CROSSING_S: f64 = 1.0;

/// A motion that starts somewhere inside: its first moments differ, and the filter meets them.
const BURST_S: f64 = 2.0;

/// Bursts spread evenly over the range, per demonstration.
const BURSTS: usize = 12;

/// Half of the bursts come straight out of a motion the other way, as reversals do, s.
const PRELUDE_S: f64 = 0.4;

/// Bursts that start within [`NEAR`] of each limit, per demonstration.
const BURSTS_NEAR_A_LIMIT: usize = 6;

/// Share of the range that is near a limit.
const NEAR: f64 = 0.03;

/// What one filter update sees; joint states are those that the tool's way tells (rad or m).
pub struct Sample {
    pub before: f64,
    pub after: f64,
    /// f_d, f_z, f_n, N.
    pub force: [f64; 3],
    pub moved: bool,
}

/// All demonstrations of an action.
pub fn all(
    world: &World,
    arguments: &Arguments,
    action: &Action,
) -> Result<Vec<Sample>, PluginError> {
    let speed = if action.high_force {
        arguments.high_speed_m_s
    } else {
        arguments.safe_speed_m_s
    };
    let crossing_s =
        CROSSING_S + (world.joint.upper - world.joint.lower) * world.joint.lever() / speed;
    let mut samples = Vec::new();
    for demonstration in 0..arguments.demonstrations {
        let shift = (demonstration as f64 + 0.5) / arguments.demonstrations as f64;
        for (run, start) in starts(shift, action.sign).into_iter().enumerate() {
            let plan = Plan {
                start,
                prelude_s: if run >= 2 && (run as u64 + demonstration) % 2 == 1 {
                    PRELUDE_S
                } else {
                    0.0
                },
                duration_s: if run < 2 { crossing_s } else { BURST_S },
                seed: arguments.seed + 1000 * demonstration + run as u64,
            };
            samples.extend(carry_out(&plan, world, arguments, action)?);
        }
    }
    Ok(samples)
}

/// Fractions of the range: first those of the crossings (from the limit itself, and from behind a
/// catch that holds there), then those of the bursts.
fn starts(shift: f64, sign: f64) -> Vec<f64> {
    let inside = |fraction: f64| if sign > 0.0 { fraction } else { 1.0 - fraction };
    let mut starts = vec![inside(0.0), inside(NEAR)];
    starts.extend((0..BURSTS).map(|burst| (burst as f64 + shift) / BURSTS as f64));
    for burst in 0..BURSTS_NEAR_A_LIMIT {
        let near = NEAR * (burst as f64 + shift) / BURSTS_NEAR_A_LIMIT as f64;
        starts.extend([near, 1.0 - near]);
    }
    starts
}

/// One run of the arm.
struct Plan {
    /// Fraction of the range.
    start: f64,
    /// Safe motion the other way before the action, s.
    prelude_s: f64,
    duration_s: f64,
    seed: u64,
}

fn carry_out(
    plan: &Plan,
    world: &World,
    arguments: &Arguments,
    action: &Action,
) -> Result<Vec<Sample>, PluginError> {
    let joint = &world.joint;
    let mut arm = VirtualArm::open(&setup(world, arguments, plan))?;
    arm.advance_to(0)?;
    let grasp = arm.read()?;
    let mut scene = Scene {
        arm,
        path: Path::at_grasp(joint, &grasp),
        controller: Controller::default(),
        arguments,
        commands: 0,
        updates: 1,
    };
    scene.run(action.opposite(), plan.prelude_s, |_, _| ())?;

    let start = joint.lower + plan.start * (joint.upper - joint.lower);
    let path = scene.path.clone();
    let state =
        |reading: &Reading| (start + path.displacement(reading)).clamp(joint.lower, joint.upper);
    let mut samples = Vec::new();
    let mut furthest_back = f64::INFINITY;
    scene.run(action, plan.prelude_s + plan.duration_s, |before, after| {
        let way = |reading| path.displacement(reading) * joint.lever();
        furthest_back = furthest_back
            .min(action.sign * way(before))
            .min(action.sign * way(after));
        if action.sign * way(after) - furthest_back < arguments.skipped_travel_m {
            return;
        }
        samples.push(Sample {
            before: state(before),
            after: state(after),
            force: path.forces(after, action.sign),
            moved: (way(after) - way(before)).abs() > arguments.motion_threshold_m,
        });
    })?;
    Ok(samples)
}

/// The arm under the engine's two faster loops, on virtual time.
struct Scene<'a> {
    arm: VirtualArm,
    path: Path,
    controller: Controller,
    arguments: &'a Arguments,
    commands: u32,
    updates: u32,
}

impl Scene<'_> {
    /// Carries `action` out until `end_s`, and hands each filter update the readings before and
    /// after it.
    fn run(
        &mut self,
        action: &Action,
        end_s: f64,
        mut update: impl FnMut(&Reading, &Reading),
    ) -> Result<(), PluginError> {
        let mut before = self.arm.read()?;
        loop {
            let command_ns = nanoseconds(f64::from(self.commands) / RATE_HZ);
            let update_ns = nanoseconds(f64::from(self.updates) / FILTER_HZ);
            if command_ns.min(update_ns) >= nanoseconds(end_s) {
                return Ok(());
            }
            self.arm.advance_to(command_ns.min(update_ns))?;
            let reading = self.arm.read()?;
            if command_ns <= update_ns {
                let twist = self
                    .controller
                    .twist(&self.path, &reading, action, self.arguments);
                self.arm.command(twist, reading.time_ns + COMMAND_LIFE_NS)?;
                self.commands += 1;
            }
            if update_ns <= command_ns {
                update(&before, &reading);
                before = reading;
                self.updates += 1;
            }
        }
    }
}

fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

fn setup(world: &World, arguments: &Arguments, plan: &Plan) -> DriverSetup {
    let joint = &world.joint;
    DriverSetup {
        joint: JointSetup {
            r#type: if joint.radius_m.is_some() {
                JointType::Revolute
            } else {
                JointType::Prismatic
            },
            lower: joint.lower,
            upper: joint.upper,
            integer: false,
            radius_m: joint.radius_m,
            opening_direction: Some(joint.opening.into()),
            hinge_direction: joint.hinge.map(Into::into),
            up_direction: Some(joint.up.into()),
            motion_threshold_m: Some(arguments.motion_threshold_m),
        },
        actions: Vec::new(),
        control: ControlSetup {
            rate_hz: RATE_HZ,
            safe_speed_m_s: arguments.safe_speed_m_s,
            high_speed_m_s: arguments.high_speed_m_s,
            force_threshold_n: arguments.force_threshold_n,
            force_limit_n: arguments.force_limit_n,
            acceleration_m_s2: arguments.acceleration_m_s2,
            stop_deceleration_m_s2: arguments.stop_deceleration_m_s2,
            contact_stiffness_n_per_m: arguments.contact_stiffness_n_per_m,
        },
        driver: serde_json::json!({
            "plugin": VirtualArm::NAME,
            "params": { "world": arguments.world, "start": plan.start },
        }),
        seed: plan.seed,
    }
}
