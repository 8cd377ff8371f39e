//! Recordings of the virtual arm, in memory.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by tests that each use a part of it, and a test may fail"
)]

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use pubs_calibrate::record::{
    BaselineLimits, Keeper, RecordError, RecordOptions, RecordReport, record,
};
use pubs_core::Task;
use pubs_core::object::{self, Overrides};
use pubs_core::task::compile;
use pubs_host::{Registry, search_path};
use pubs_plugin::JointType;
use pubs_run::Sample;
use pubs_run::recording::{Done, FORMAT_VERSION, Frame, Header, Recording};

pub fn object_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../objects/{name}.toml"))
}

pub fn task(name: &str, overrides: &[&str]) -> Arc<Task> {
    let overrides = Overrides::from_process(overrides.iter().map(|&text| text.to_owned()));
    let loaded = object::load(&object_path(name), &overrides).unwrap();
    Arc::new(compile(&loaded.file).unwrap())
}

#[derive(Clone, Default)]
struct Kept(Arc<Mutex<(Vec<Frame>, Vec<Done>)>>);

impl Keeper for Kept {
    fn frame(&mut self, frame: &Frame, _: &Sample) {
        self.0.lock().unwrap().0.push(*frame);
    }

    fn done(&mut self, _: u64, done: Done) {
        self.0.lock().unwrap().1.push(done);
    }
}

/// Keeps what is recorded, and calls halt after so many frames.
struct Halting {
    kept: Kept,
    after: usize,
    interrupt: Arc<AtomicBool>,
}

impl Keeper for Halting {
    fn frame(&mut self, frame: &Frame, sample: &Sample) {
        self.kept.frame(frame, sample);
        if self.kept.0.lock().unwrap().0.len() == self.after {
            self.interrupt.store(true, Ordering::Release);
        }
    }

    fn done(&mut self, time_ns: u64, done: Done) {
        self.kept.done(time_ns, done);
    }
}

/// How to record in a test.
pub struct Plan {
    pub demonstrations: u32,
    pub seed: u64,
    pub done: Vec<Done>,
    pub halt_after: usize,
    pub baseline: Option<BaselineLimits>,
}

impl Plan {
    pub fn new(demonstrations: u32, seed: u64) -> Self {
        Self {
            demonstrations,
            seed,
            done: Vec::new(),
            halt_after: usize::MAX,
            baseline: None,
        }
    }

    /// Records on the virtual clock.
    pub fn record(self, task: &Arc<Task>) -> Result<(Recording, RecordReport), RecordError> {
        let registry = Registry::new(
            &[pubs_segments::table(), pubs_virtual_arm::table()],
            search_path(&[]),
        );
        let driver = task.driver.as_ref().unwrap();
        let plugin = registry.driver(&driver.plugin).unwrap();
        let arm = plugin.open(&task.driver_setup(self.seed).unwrap()).unwrap();
        let control = task.control.unwrap();
        let kept = Kept::default();
        let interrupt = Arc::new(AtomicBool::new(false));
        let keeper = Halting {
            kept: kept.clone(),
            after: self.halt_after,
            interrupt: Arc::clone(&interrupt),
        };
        let options = RecordOptions {
            demonstrations: self.demonstrations,
            done: self.done,
            baseline: self.baseline.unwrap_or(BaselineLimits::of(&control)),
            lockstep: true,
            interrupt,
        };
        let report = record(task, Box::new(arm), Box::new(keeper), &options, &mut |_| {})?;
        let (frames, done) = std::mem::take(&mut *kept.0.lock().unwrap());
        let header = Header {
            format: FORMAT_VERSION,
            engine: "test".to_owned(),
            object: task.name.clone(),
            joint: if task.joint.unit() == "rad" {
                JointType::Revolute
            } else {
                JointType::Prismatic
            },
            sensor: "virtual-arm".to_owned(),
            actions: task
                .actions
                .iter()
                .map(|action| action.name.clone())
                .collect(),
            rate_hz: control.rate_hz,
            seed: self.seed,
        };
        let recording = Recording {
            header,
            frames,
            done,
            loss: None,
        };
        Ok((recording, report))
    }
}

pub fn recorded(task: &Arc<Task>, demonstrations: u32, seed: u64) -> (Recording, RecordReport) {
    Plan::new(demonstrations, seed).record(task).unwrap()
}
