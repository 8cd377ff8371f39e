//! The virtual arm, moved as the controller loop moves one: its recording has nothing wrong, and
//! what is broken on purpose is found in it too.
#![allow(clippy::unwrap_used)]

use std::path::Path as FilePath;

use pubs_core::Task;
use pubs_core::controller;
use pubs_core::joint::{Path, Pose};
use pubs_core::object::{Overrides, load};
use pubs_core::task::compile;
use pubs_plugin::{Driver, JointType, Twist};
use pubs_run::recording::{Done, FORMAT_VERSION, Frame, Header, Recording};
use pubs_virtual_arm::VirtualArm;

use super::{check_table, texts};
use crate::faults::Findings;

const TICK_NS: u64 = 10_000_000;
/// A blocked arm is held so long, in rows.
const HELD_ROWS: usize = 60;

struct Recorder {
    task: Task,
    arm: VirtualArm,
    path: Path,
    speed_m_s: f64,
    frames: Vec<Frame>,
}

impl Recorder {
    fn new() -> Self {
        let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../objects/door2.toml");
        let set = r#"driver.params={ world = "door2", start = 0.5 }"#;
        let overrides = Overrides::from_process([set.to_owned()]);
        let task = compile(&load(&file, &overrides).unwrap().file).unwrap();
        let mut arm = VirtualArm::open(&task.driver_setup(7).unwrap()).unwrap();
        arm.advance_to(TICK_NS).unwrap();
        arm.tare().unwrap();
        let reading = arm.read().unwrap();
        let pose = Pose::new(reading.position_m, reading.orientation_xyzw);
        Self {
            path: Path::at_grasp(&task.joint, &pose).unwrap(),
            task,
            arm,
            speed_m_s: 0.0,
            frames: Vec::new(),
        }
    }

    /// One control period.
    fn step(&mut self, action: usize, demonstration: u32) {
        let now_ns = (self.frames.len() as u64 + 2) * TICK_NS;
        self.arm.advance_to(now_ns).unwrap();
        let reading = self.arm.read().unwrap();
        let control = self.task.control.unwrap();
        let pose = Pose::new(reading.position_m, reading.orientation_xyzw);
        let asked = &self.task.actions[action];
        let along_n = controller::force_along(&self.path, &pose, asked, reading.force_n);
        let wanted = control.speed(asked, along_n);
        let settled =
            !asked.is_stop() && (self.speed_m_s - wanted).abs() <= 0.1 * wanted.abs().max(1e-6);
        self.speed_m_s = control.ramp(self.speed_m_s, wanted);
        let (linear, angular) = self.path.velocity(&pose, self.speed_m_s, 0.01);
        let twist = Twist {
            linear_m_s: linear.into(),
            angular_rad_s: angular.into(),
        };
        self.arm.command(twist, now_ns + 5 * TICK_NS).unwrap();
        self.frames.push(Frame {
            reading,
            action,
            demonstration,
            speed_m_s: self.speed_m_s,
            settled,
            truth: self.arm.truth(),
        });
    }

    /// Moves until the joint state passes `until`, or until the arm is held up.
    fn pull(&mut self, action: usize, demonstration: u32, until: f64) {
        let opening = self.task.actions[action].sign();
        let mut held = 0;
        while held < HELD_ROWS {
            self.step(action, demonstration);
            held = if self.speed_m_s == 0.0 { held + 1 } else { 0 };
            let state = self.arm.truth().unwrap();
            if (state - until) * opening > 0.0 {
                return;
            }
        }
    }

    fn finish(self) -> (Recording, Task) {
        let done = |action: &str| {
            [1, 2].map(|demonstration| Done {
                action: action.to_owned(),
                demonstration,
            })
        };
        let actions: Vec<String> = self
            .task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect();
        let recording = Recording {
            header: Header {
                format: FORMAT_VERSION,
                engine: "0.1.0".to_owned(),
                object: self.task.name.clone(),
                joint: JointType::Revolute,
                sensor: self.arm.sensor().to_owned(),
                actions: actions.clone(),
                rate_hz: 100.0,
                seed: 7,
            },
            frames: self.frames,
            done: actions[1..]
                .iter()
                .flat_map(|action| done(action))
                .collect(),
            loss: None,
        };
        (recording, self.task)
    }
}

#[test]
fn the_virtual_arm_gives_a_recording_with_nothing_wrong() {
    let mut recorder = Recorder::new();
    let anywhere = [f64::NEG_INFINITY, f64::INFINITY];
    // To the open end, shut until it is held up, against the catch, out of it, and back again.
    recorder.pull(1, 1, anywhere[1]);
    recorder.pull(2, 1, anywhere[0]);
    recorder.pull(1, 2, anywhere[1]);
    recorder.pull(3, 1, 1.5);
    recorder.pull(4, 1, 0.5);
    recorder.pull(1, 2, anywhere[1]);
    recorder.pull(2, 2, anywhere[0]);
    let (recording, task) = recorder.finish();
    assert_eq!(check_table(&recording, &task), Findings::default());
    let mut swapped = recording.clone();
    for frame in &mut swapped.frames {
        frame.reading.force_n.swap(1, 2);
    }
    let said = texts(&check_table(&swapped, &task).faults);
    assert!(
        said.len() == 1 && said[0].contains("force_y_n seems to hold it"),
        "{said:#?}"
    );
    let mut turned = recording;
    for frame in &mut turned.frames {
        frame.reading.force_n = frame.reading.force_n.map(|force| -force);
    }
    let said = texts(&check_table(&turned, &task).faults);
    assert!(
        said.len() == 1 && said[0].contains("the sign is reversed"),
        "{said:#?}"
    );
}
