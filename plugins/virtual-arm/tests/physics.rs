//! The physics against closed forms, in worlds written for the purpose and on door2.

#![allow(clippy::unwrap_used)]

use nalgebra::Vector3;
use pubs_virtual_arm::arm::Velocity;
use pubs_virtual_arm::plant::{Disturbance, Plant, STEP_S};
use pubs_virtual_arm::world::World;

/// A drawer of 2 kg, opening along base x, with this friction and the tables in `extra`.
fn drawer(coulomb_n: f64, viscous: f64, grasp_damping: f64, extra: &str) -> World {
    let text = format!(
        r#"
schema = 1
name = "drawer"
[joint]
type = "prismatic"
limits_m = [0.0, 0.4]
mass_kg = 2.0
opening_direction = [1.0, 0.0, 0.0]
up_direction = [0.0, 0.0, 1.0]
closed_position_m = [0.5, 0.0, 0.3]
closed_orientation_xyzw = [0.0, 0.0, 0.0, 1.0]
[friction]
coulomb_n = {coulomb_n:?}
viscous_n_s_per_m = {viscous:?}
[stop]
stiffness_n_per_m = 20000.0
damping_n_s_per_m = 0.0
[grasp]
stiffness_n_per_m = [2000.0, 1000.0, 1500.0]
damping_n_s_per_m = [{grasp_damping:?}, 0.0, 0.0]
[arm]
lag_s = 0.002
acceleration_m_s2 = 10.0
[sensor]
{extra}"#
    );
    World::parse("drawer", &text).unwrap()
}

fn run(plant: &mut Plant, seconds: f64) {
    for _ in 0..(seconds / STEP_S).round() as usize {
        plant.step(STEP_S);
    }
}

fn linear(x: f64, y: f64, z: f64) -> Velocity {
    Velocity {
        linear: Vector3::new(x, y, z),
        angular: Vector3::zeros(),
    }
}

/// The velocity along door2's arc: hinge at base (0.75, 0.17), axis down.
fn along_door2(plant: &Plant, speed_m_s: f64) -> Velocity {
    let axis = Vector3::new(0.0, 0.0, -1.0);
    let arm = plant.arm.position_m - Vector3::new(0.75, 0.17, 0.60);
    Velocity {
        linear: axis.cross(&arm).normalize() * speed_m_s,
        angular: axis * (speed_m_s / 0.32),
    }
}

fn tool_angle_of_door2(plant: &Plant) -> f64 {
    let arm = plant.arm.position_m - Vector3::new(0.75, 0.17, 0.60);
    (-arm.x).atan2(-arm.y)
}

/// Force along the opening direction of door2, which is tool -z.
fn pull_on_door2(plant: &Plant) -> f64 {
    -plant.wrench().force.z
}

#[test]
fn mass_on_the_grasp_swings_at_its_natural_frequency_and_keeps_its_energy() {
    let mut plant = Plant::new(&drawer(0.0, 0.0, 0.0, ""), 0.2, 5.0);
    plant.arm.position_m.x += 0.01;
    let centre = plant.joint_state() + 0.01;
    let mut crossings = Vec::new();
    let mut greatest = 0.0f64;
    let mut before = plant.joint_state() - centre;
    for step in 0..40_000 {
        plant.step(STEP_S);
        let now = plant.joint_state() - centre;
        if before < 0.0 && now >= 0.0 {
            crossings.push(step as f64 + before / (before - now));
        }
        if step > 30_000 {
            greatest = greatest.max(now.abs());
        }
        before = now;
    }
    let periods = crossings.len() - 1;
    let period = (crossings[periods] - crossings[0]) * STEP_S / periods as f64;
    let expected = std::f64::consts::TAU * (2.0f64 / 2000.0).sqrt();
    assert!(
        (period / expected - 1.0).abs() < 1e-3,
        "period {period} s, 2π√(m/k) = {expected} s"
    );
    assert!(
        (greatest / 0.01 - 1.0).abs() < 0.01,
        "amplitude 10 mm after 50 swings, found {greatest} m"
    );
}

#[test]
fn steady_pull_is_dry_friction_plus_viscous_friction() {
    for (coulomb, viscous, speed) in [(3.0, 0.0, 0.05), (0.0, 20.0, 0.1), (2.0, 10.0, -0.05)] {
        let mut plant = Plant::new(&drawer(coulomb, viscous, 40.0, ""), 0.2, 5.0);
        plant.arm.follow(linear(speed, 0.0, 0.0));
        run(&mut plant, 1.5);
        let expected = f64::signum(speed) * (coulomb + viscous * f64::abs(speed));
        let found = plant.wrench().force.x;
        assert!(
            (found - expected).abs() < 0.01,
            "{coulomb} N, {viscous} N s/m, {speed} m/s: {expected} N, found {found}"
        );
    }
}

#[test]
fn sideways_tool_loads_the_lateral_and_vertical_springs() {
    let mut plant = Plant::new(&drawer(1.0, 0.0, 40.0, ""), 0.2, 5.0);
    plant.arm.position_m += Vector3::new(0.0, 0.002, 0.003);
    let force = plant.wrench().force;
    assert!(
        (force - Vector3::new(0.0, 2.0, 4.5)).norm() < 1e-9,
        "1000 N/m · 2 mm, 1500 N/m · 3 mm: {force:?}"
    );
}

#[test]
fn stop_gives_way_by_force_over_stiffness() {
    let mut plant = Plant::new(&drawer(0.0, 5.0, 40.0, ""), 0.4, 5.0);
    plant.arm.follow(linear(0.02, 0.0, 0.0));
    run(&mut plant, 0.5);
    plant.arm.ramp_to_rest();
    run(&mut plant, 2.0);
    let (force, depth) = (plant.wrench().force.x, plant.joint_state() - 0.4);
    assert!(force > 15.0, "the tool leans on the stop with {force} N");
    assert!(
        (depth - force / 20_000.0).abs() < 1e-7,
        "{force} N press {depth} m into 20 kN/m"
    );
}

#[test]
fn closing_spring_is_held_by_the_grasp() {
    let world = drawer(
        0.0,
        0.0,
        40.0,
        "[closing_spring]\nforce_n = 3.0\nstiffness_n_per_m = 10.0\n",
    );
    let plant = Plant::new(&world, 0.2, 5.0);
    let force = plant.wrench().force.x;
    // The grasp gives way by about 2.5 mm, which takes 0.025 N off 3 + 10 · 0.2.
    let expected = (3.0 + 10.0 * 0.2) * 2000.0 / 2010.0;
    assert!(
        (force - expected).abs() < 1e-3,
        "{expected} N, found {force}"
    );
}

#[test]
fn nothing_moves_by_itself() {
    let world = World::load("door2").unwrap();
    for start_deg in [0.0f64, 1.0, 3.0, 10.0, 60.0, 125.0] {
        let mut plant = Plant::new(&world, start_deg.to_radians(), 5.0);
        let (state, force) = (plant.joint_state(), plant.wrench().force);
        run(&mut plant, 5.0);
        assert_eq!(
            plant.joint_state(),
            state,
            "the door at {start_deg} degrees moved"
        );
        assert_eq!(
            plant.wrench().force,
            force,
            "the force at {start_deg} degrees changed"
        );
    }
}

#[test]
fn catch_of_door2_holds_15_n_and_lets_go_before_25_n() {
    let mut plant = Plant::new(&World::load("door2").unwrap(), 0.0, 5.0);
    let mut greatest = 0.0f64;
    let mut at_15_n = None;
    while tool_angle_of_door2(&plant) < 8f64.to_radians() {
        plant.arm.follow(along_door2(&plant, 0.005));
        plant.step(STEP_S);
        let pull = pull_on_door2(&plant);
        greatest = greatest.max(pull);
        if pull > 15.0 {
            at_15_n = at_15_n.or(Some(plant.joint_state()));
        }
    }
    let held = at_15_n.unwrap().to_degrees();
    assert!(
        held < 0.15,
        "at 15 N the door is still closed, found it {held} degrees open"
    );
    assert!(
        (21.0..23.5).contains(&greatest),
        "the catch lets go at about 22 N, not {greatest}"
    );
    assert!(
        plant.joint_state().to_degrees() > 6.5,
        "beyond the catch the door follows the tool"
    );
}

#[test]
fn pulling_fast_breaks_the_catch_of_door2_without_a_fling() {
    let mut plant = Plant::new(&World::load("door2").unwrap(), 0.0, 5.0);
    let (mut greatest, mut furthest_ahead) = (0.0f64, f64::NEG_INFINITY);
    for step in 0..(1.0 / STEP_S) as usize {
        let speed = (step as f64 * STEP_S).min(0.15);
        plant.arm.follow(along_door2(&plant, speed));
        plant.step(STEP_S);
        greatest = greatest.max(pull_on_door2(&plant));
        furthest_ahead = furthest_ahead.max(plant.joint_state() - tool_angle_of_door2(&plant));
    }
    assert!(
        (22.0..34.0).contains(&greatest),
        "the guard at 0.15 m/s stops at 34 N; peak {greatest} N"
    );
    let ahead = furthest_ahead.to_degrees();
    assert!(
        ahead < 0.2,
        "the door ran {ahead} degrees ahead of the tool"
    );
}

#[test]
fn closing_door2_is_pulled_in_by_its_magnet() {
    let mut plant = Plant::new(&World::load("door2").unwrap(), 10f64.to_radians(), 5.0);
    let mut least = 0.0f64;
    while tool_angle_of_door2(&plant) > 0.0 {
        plant.arm.follow(along_door2(&plant, -0.05));
        plant.step(STEP_S);
        least = least.min(-pull_on_door2(&plant));
    }
    assert!(
        (-20.5..-17.0).contains(&least),
        "catch and hinge less friction pull with {least} N"
    );
    assert!(
        plant.joint_state().to_degrees() < 0.05,
        "the door is closed"
    );
}

/// A drawer held by the arm at rest, and what befalls it.
fn befallen(disturbance: Disturbance, seconds: f64) -> Plant {
    let mut plant = Plant::new(&drawer(5.0, 0.0, 130.0, ""), 0.1, 5.0);
    plant.disturbance = disturbance;
    run(&mut plant, seconds);
    plant
}

#[test]
fn somebody_pulling_stretches_the_grasp_by_what_friction_leaves() {
    let push_n = 25.0;
    let plant = befallen(
        Disturbance {
            push_n,
            ..Disturbance::default()
        },
        2.0,
    );
    // 25 N less 5 N of friction, against 2000 N/m, is 10 mm, and 20 N on the tool.
    let way = plant.joint_state() - 0.1;
    assert!((way - 0.010).abs() < 2e-4, "the drawer went {way} m");
    let force = plant.wrench().force.x;
    assert!((force + 20.0).abs() < 0.5, "the tool exerts {force} N");
}

#[test]
fn released_drawer_feels_nothing_of_the_tool() {
    let mut plant = befallen(
        Disturbance {
            released: true,
            ..Disturbance::default()
        },
        0.1,
    );
    plant.arm.follow(linear(0.1, 0.0, 0.0));
    run(&mut plant, 0.5);
    assert_eq!(plant.wrench().force, Vector3::zeros());
    let moved = plant.joint_state() - 0.1;
    assert!(moved.abs() < 1e-6, "it went {moved} m by itself");
}

#[test]
fn jammed_drawer_stands_while_the_force_grows() {
    let mut plant = befallen(
        Disturbance {
            jammed: true,
            ..Disturbance::default()
        },
        0.1,
    );
    let before = plant.joint_state();
    plant.arm.follow(linear(0.05, 0.0, 0.0));
    run(&mut plant, 0.4);
    assert_eq!(plant.joint_state(), before);
    // 0.05 m/s for 0.4 s is 20 mm: 40 N on the spring and 6.5 N on the damper.
    let force = plant.wrench().force.x;
    assert!((force - 46.5).abs() < 1.0, "{force} N after 20 mm");
}
