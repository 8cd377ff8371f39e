//! Every shipped object, from one end of its range to the other, through external control.

#![allow(clippy::unwrap_used)]

mod bench;

use bench::{Bench, to_pose};
use nalgebra::{Isometry3, Translation3};
use pubs_melfa_emulator::mount::Mount;
use pubs_melfa_protocol::Pose;
use pubs_virtual_arm::geometry::Geometry;
use pubs_virtual_arm::world::{Deviation, World};

const HIGH_SPEED_M_S: f64 = 0.15;
const ACCELERATION_M_S2: f64 = 1.0;

/// Where the tool is with the joint of the object at `way_m` of its handle, base frame.
fn held(world: &World, way_m: f64, flags: &Pose) -> Pose {
    let handle = Geometry::new(&world.joint, [Deviation::NONE; 2]).handle(way_m);
    let tool = Isometry3::from_parts(Translation3::from(handle.position_m), handle.orientation);
    let tool = Mount::for_world(&world.name).isometry() * tool;
    Pose::from_isometry(&tool, flags.posture, flags.turns)
}

#[test]
fn whole_range_is_passed_at_high_speed_both_ways_without_an_alarm() {
    for name in ["drawer1", "drawer2", "door1", "door2"] {
        let world = World::load(name).unwrap();
        let mut bench = Bench::ready(&["--world", name, "--start", "0"], "Mxt 1,0,10");
        let flags = bench.handshake();
        let range_m = (world.joint.upper - world.joint.lower) * world.joint.lever();
        let cycle_s = bench.machine.controller.cycle_s();
        let (mut way_m, mut speed) = (0.0f64, 0.0f64);
        for end_m in [range_m, 0.0] {
            let mut last_m = way_m - 1.0;
            while way_m != last_m {
                last_m = way_m;
                let left = end_m - way_m;
                // As fast as still leaves room to stop.
                let most = (2.0 * ACCELERATION_M_S2 * left.abs())
                    .sqrt()
                    .min(HIGH_SPEED_M_S);
                let step = ACCELERATION_M_S2 * cycle_s;
                speed += (most * left.signum() - speed).clamp(-step, step);
                way_m += (speed * cycle_s).clamp(-left.abs(), left.abs());
                let target = held(
                    &world,
                    world.joint.lower * world.joint.lever() + way_m,
                    &flags,
                );
                let reply = bench.send(&to_pose(target));
                assert!(
                    reply.is_some(),
                    "{name} at {way_m} m: {:?}",
                    bench.machine.controller.alarm
                );
            }
            bench.cycles(200);
            let controller = &bench.machine.controller;
            let state = controller.scene.joint_state() * world.joint.lever();
            assert!(
                (state - end_m).abs() < 0.01,
                "{name}: at {state} m, not {end_m} m"
            );
            assert!(controller.measure.at_rest, "{name} moves on");
        }
        let peaks = bench.machine.controller.measure.peaks;
        assert!(
            (0.14..0.16).contains(&peaks.tool_speed_m_s),
            "{name}: {peaks:?}"
        );
        assert!(
            peaks.tool_smooth_acceleration_m_s2 < 2.0 * ACCELERATION_M_S2,
            "{name}: {peaks:?}"
        );
    }
}
