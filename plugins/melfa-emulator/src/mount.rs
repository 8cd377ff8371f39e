//! Where an object stands beside the robot.
//!
//! A world gives its object in a frame of its own. The mount puts that frame into the robot's
//! base, turned about the vertical. The defaults were found by a search over places for the four
//! shipped worlds: the whole range is within the joints' ranges, far from singular points, and
//! needs little of the joints' speeds at 0.15 m/s.

use std::str::FromStr;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use pubs_melfa_protocol::arm::{self, ReachError, SPEED_RAD_S};
use pubs_virtual_arm::geometry::Geometry;
use pubs_virtual_arm::world::{Deviation, World};

/// Which posture the arm takes: wrist in front, elbow up, hand not flipped.
const POSTURE: u32 = 7;

/// Steps in which the range is walked.
const STEPS: u32 = 400;

/// The world's frame in the robot's base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// m.
    pub position_m: [f64; 3],
    /// Turn about the vertical, degrees.
    pub yaw_deg: f64,
}

impl Mount {
    /// As laid out for a shipped world; the robot's base itself for others.
    pub fn for_world(name: &str) -> Self {
        let (position_m, yaw_deg) = match name {
            "drawer1" => ([0.05, 0.83, -0.05], -30.0),
            "drawer2" => ([0.03, -0.81, 0.05], 30.0),
            "door1" => ([0.82, 0.56, -0.45], -120.0),
            "door2" => ([0.66, -0.73, -0.50], 120.0),
            _ => ([0.0; 3], 0.0),
        };
        Self {
            position_m,
            yaw_deg,
        }
    }

    /// As a transform.
    pub fn isometry(&self) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians());
        Isometry3::from_parts(Translation3::from(self.position_m), turn)
    }
}

impl FromStr for Mount {
    type Err = String;

    /// Four numbers: X, Y, Z in metres, yaw in degrees.
    fn from_str(text: &str) -> Result<Self, String> {
        let [x, y, z, yaw_deg] = numbers(text)?;
        Ok(Self {
            position_m: [x, y, z],
            yaw_deg,
        })
    }
}

/// `N` finite numbers between commas.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let fault = || format!("{text:?} should be {N} numbers between commas");
    let parsed: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse().map_err(|_| fault()))
        .collect::<Result<_, _>>()?;
    let parsed: [f64; N] = parsed.try_into().map_err(|_| fault())?;
    match parsed.iter().all(|number| number.is_finite()) {
        true => Ok(parsed),
        false => Err(fault()),
    }
}

/// How well the arm reaches all of an object's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Greatest share of a joint's speed that the tool needs at the speed asked about.
    pub speed_share: f64,
    /// Least distance of a joint from the end of its range, degrees.
    pub margin_deg: f64,
    /// Least |sin| of J3 and J5, each 0 at a singular point.
    pub regularity: f64,
}

/// Joints that hold the handle with the joint of the object at `state` (rad or m).
///
/// # Errors
///
/// Where the arm does not reach it.
pub fn joints_at(
    world: &World,
    mount: &Mount,
    tool: &Isometry3<f64>,
    state: f64,
) -> Result<[f64; 6], ReachError> {
    let flange = flange_at(world, mount, tool, state);
    arm::inverse_with_posture(&flange, &[0.0; 6], POSTURE)
}

/// Walks the whole range, a little beyond both limits as the grasp gives way, and says how well
/// the arm gets along at `speed_m_s`.
///
/// # Errors
///
/// Where it does not.
pub fn reach(
    world: &World,
    mount: &Mount,
    tool: &Isometry3<f64>,
    speed_m_s: f64,
) -> Result<Reach, ReachError> {
    const BEYOND_M: f64 = 0.015;
    let lever = world.joint.lever();
    let (from, to) = (
        world.joint.lower - BEYOND_M / lever,
        world.joint.upper + BEYOND_M / lever,
    );
    let step = (to - from) / f64::from(STEPS);
    let duration_s = step * lever / speed_m_s;
    // From where a run may begin, so that the turns of the joints are those of a run.
    let mut joints = joints_at(world, mount, tool, world.joint.lower)?;
    joints = arm::inverse(&flange_at(world, mount, tool, from), &joints)?;
    let mut reach = Reach {
        speed_share: 0.0,
        margin_deg: f64::INFINITY,
        regularity: f64::INFINITY,
    };
    for index in 1..=STEPS {
        let flange = flange_at(world, mount, tool, from + step * f64::from(index));
        let next = arm::inverse(&flange, &joints)?;
        for joint in 0..6 {
            let share = (next[joint] - joints[joint]).abs() / duration_s / SPEED_RAD_S[joint];
            reach.speed_share = reach.speed_share.max(share);
            let margin = (arm::RANGE_RAD[joint] - next[joint].abs()).to_degrees();
            reach.margin_deg = reach.margin_deg.min(margin);
        }
        let regularity = next[2].sin().abs().min(next[4].sin().abs());
        reach.regularity = reach.regularity.min(regularity);
        joints = next;
    }
    Ok(reach)
}

fn flange_at(world: &World, mount: &Mount, tool: &Isometry3<f64>, state: f64) -> Isometry3<f64> {
    let geometry = Geometry::new(&world.joint, [Deviation::NONE; 2]);
    let handle = geometry.handle(state * world.joint.lever());
    let held = Isometry3::from_parts(Translation3::from(handle.position_m), handle.orientation);
    mount.isometry() * held * tool.inverse()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn all_of_every_shipped_object_is_well_within_reach() {
        for name in ["drawer1", "drawer2", "door1", "door2"] {
            let world = World::load(name).unwrap();
            let found = reach(
                &world,
                &Mount::for_world(name),
                &Isometry3::identity(),
                0.15,
            );
            let found = found.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(found.speed_share < 0.5, "{name}: joint speeds {found:?}");
            assert!(found.margin_deg > 10.0, "{name}: joint ranges {found:?}");
            assert!(found.regularity > 0.2, "{name}: singular {found:?}");
        }
    }

    #[test]
    fn starts_at_the_far_end_take_the_same_turns() {
        for name in ["drawer1", "drawer2", "door1", "door2"] {
            let world = World::load(name).unwrap();
            let mount = Mount::for_world(name);
            let tool = Isometry3::identity();
            let mut joints = joints_at(&world, &mount, &tool, world.joint.upper).unwrap();
            for index in (0..=100).rev() {
                let share = f64::from(index) / 100.0;
                let state = world.joint.lower + share * (world.joint.upper - world.joint.lower);
                let flange = flange_at(&world, &mount, &tool, state);
                let next = arm::inverse(&flange, &joints)
                    .unwrap_or_else(|error| panic!("{name} at {share}: {error}"));
                let jump = (0..6)
                    .map(|i| (next[i] - joints[i]).abs())
                    .fold(0.0, f64::max);
                assert!(jump < 0.1, "{name} at {share}: a joint jumps by {jump} rad");
                joints = next;
            }
        }
    }

    #[test]
    fn mounts_are_four_numbers() {
        let mount: Mount = "0.1, -0.2,0.3,45".parse().unwrap();
        assert_eq!(mount.position_m, [0.1, -0.2, 0.3]);
        let x = mount.isometry() * nalgebra::Point3::new(1.0, 0.0, 0.0);
        assert!((x.x - 0.1 - 0.5f64.sqrt()).abs() < 1e-12, "{x}");
        assert!("0.1,0.2,0.3".parse::<Mount>().is_err());
        assert!("0.1,0.2,0.3,inf".parse::<Mount>().is_err());
    }
}
