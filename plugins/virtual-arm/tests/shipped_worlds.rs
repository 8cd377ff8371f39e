//! How the shipped worlds move: as their files claim, held by the grasp, and never by themselves.

#![allow(clippy::unwrap_used)]

use pubs_virtual_arm::arm::Velocity;
use pubs_virtual_arm::geometry::{Geometry, HandleFrame};
use pubs_virtual_arm::plant::{Plant, STEP_S};
use pubs_virtual_arm::world::{Deviation, World};

const SHIPPED: [&str; 5] = ["door1", "door2", "drawer1", "drawer2", "fridge"];

/// An arm that leads the handle of a shipped world along its ideal way.
struct Scene {
    plant: Plant,
    ideal: Geometry,
    lever: f64,
    /// How far the tool has come, m.
    tool_m: f64,
}

impl Scene {
    /// `start` in the joint's own unit: degrees or m.
    fn at(name: &str, start: f64) -> Self {
        let world = World::load(name).unwrap();
        let start = match world.joint.radius_m {
            Some(_) => start.to_radians(),
            None => start,
        };
        Self {
            plant: Plant::new(&world, start, 5.0),
            ideal: Geometry::new(&world.joint, [Deviation::NONE; 2]),
            lever: world.joint.lever(),
            tool_m: start * world.joint.lever(),
        }
    }

    fn handle(&self) -> HandleFrame {
        self.ideal.handle(self.tool_m)
    }

    /// One step at `speed_m_s` towards open.
    fn step(&mut self, speed_m_s: f64) {
        let handle = self.handle();
        self.plant.arm.follow(Velocity {
            linear: handle.axes[0] * speed_m_s,
            angular: handle.turn * speed_m_s,
        });
        self.plant.step(STEP_S);
        let way = self.plant.arm.velocity.linear.dot(&handle.axes[0]) * STEP_S;
        self.tool_m += way;
    }

    fn state_m(&self) -> f64 {
        self.plant.joint_state() * self.lever
    }

    /// Along the way towards open, N.
    fn pull_n(&self) -> f64 {
        let force = self.plant.arm.orientation * self.plant.wrench().force;
        self.handle().axes[0].dot(&force)
    }
}

#[test]
fn nothing_moves_by_itself() {
    for name in SHIPPED {
        let upper = match name {
            "fridge" => 100.0,
            _ if name.starts_with("door") => 125.0,
            _ => 0.25,
        };
        for fraction in [0.0, 0.008, 0.024, 0.08, 0.15, 0.5, 0.7, 1.0] {
            let mut plant = Scene::at(name, fraction * upper).plant;
            let (state, force) = (plant.joint_state(), plant.wrench().force);
            for _ in 0..(5.0 / STEP_S) as usize {
                plant.step(STEP_S);
            }
            assert_eq!(
                (plant.joint_state(), plant.wrench().force),
                (state, force),
                "{name} left alone at {fraction} of its range"
            );
        }
    }
}

#[test]
fn steady_pull_is_friction_and_springs() {
    // Start (degrees or m), speed, where the force is read, and by hand: friction ± force towards
    // closed + viscous, N.
    let cases = [
        ("door1", 10.0, 0.05, 18.5, 2.6988 + 2.95 + 0.1),
        ("door1", 25.0, -0.05, 18.5, -2.6988 + 2.95 - 0.1),
        ("door1", 80.0, 0.05, 87.5, 0.3 + 0.1),
        ("door1", 80.0, 0.15, 87.5, 0.3 + 0.3),
        ("drawer1", 0.05, 0.05, 0.1, 2.4735 + 0.6 + 0.2),
        ("drawer1", 0.15, -0.05, 0.1, -2.4735 + 0.6 - 0.2),
        ("drawer1", 0.02, 0.15, 0.1, 2.4735 + 0.6 + 0.6),
        ("drawer2", 0.05, 0.05, 0.1, 3.1759 + 0.5 + 0.25),
        ("drawer2", 0.15, -0.05, 0.1, -3.1759 + 0.5 - 0.25),
    ];
    for (name, start, speed, at, expected) in cases {
        let mut scene = Scene::at(name, start);
        let place = match World::load(name).unwrap().joint.radius_m {
            Some(radius) => f64::to_radians(at) * radius,
            None => at,
        };
        while (place - scene.state_m()) * f64::signum(speed) > 0.0 {
            scene.step(speed);
        }
        let found = scene.pull_n();
        assert!(
            (found - expected).abs() < 0.05,
            "{name} at {at}, {speed} m/s: {expected} N, found {found}"
        );
    }
}

#[test]
fn catch_of_drawer2_holds_15_n_and_lets_go_before_23_n() {
    let mut scene = Scene::at("drawer2", 0.0);
    let (mut greatest, mut at_15_n) = (0.0f64, None);
    while scene.tool_m < 0.05 {
        scene.step(0.005);
        greatest = greatest.max(scene.pull_n());
        if scene.pull_n() > 15.0 {
            at_15_n = at_15_n.or(Some(scene.state_m()));
        }
    }
    let held_m = at_15_n.unwrap();
    assert!(
        held_m < 0.0008,
        "at 15 N the drawer has but left its preload on the stop, found it {held_m} m open"
    );
    assert!(
        (20.0..23.0).contains(&greatest),
        "the catch lets go at about 21 N, not {greatest}"
    );
}

#[test]
fn worlds_without_a_catch_open_below_the_threshold_of_safe_mode() {
    for name in ["door1", "drawer1"] {
        let mut scene = Scene::at(name, 0.0);
        let mut greatest = 0.0f64;
        for step in 0..(2.0 / STEP_S) as usize {
            scene.step((step as f64 * STEP_S).min(0.05));
            greatest = greatest.max(scene.pull_n());
        }
        assert!(
            greatest < 12.0,
            "{name}: safe mode stops above 15 N, and its pull reaches {greatest} N"
        );
    }
}

#[test]
fn high_force_opens_every_world_below_its_own_stop_and_without_a_fling() {
    for name in SHIPPED {
        let mut scene = Scene::at(name, 0.0);
        let (mut greatest, mut furthest_ahead) = (0.0f64, f64::NEG_INFINITY);
        for step in 0..(1.0 / STEP_S) as usize {
            scene.step((step as f64 * STEP_S).min(0.15));
            greatest = greatest.max(scene.pull_n());
            furthest_ahead = furthest_ahead.max(scene.state_m() - scene.tool_m);
        }
        assert!(
            greatest < 32.0,
            "{name}: the stop at 0.15 m/s begins at 33.75 N; peak {greatest} N"
        );
        assert!(
            furthest_ahead < 0.0015,
            "{name} ran {furthest_ahead} m ahead of the tool"
        );
        assert!(scene.state_m() > 0.12, "{name} is still shut");
    }
}
