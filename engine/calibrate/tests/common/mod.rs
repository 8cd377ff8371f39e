//! Recordings of the virtual arm, in memory.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by tests that each use a part of it, and a test may fail"
)]

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use pubs_calibrate::record::{BaselineLimits, Keeper, RecordOptions, RecordReport, record};
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

/// Records on the virtual clock.
pub fn recorded(task: &Arc<Task>, demonstrations: u32, seed: u64) -> (Recording, RecordReport) {
    let registry = Registry::new(
        &[pubs_segments::table(), pubs_virtual_arm::table()],
        search_path(&[]),
    );
    let driver = task.driver.as_ref().unwrap();
    let plugin = registry.driver(&driver.plugin).unwrap();
    let arm = plugin.open(&task.driver_setup(seed).unwrap()).unwrap();
    let kept = Kept::default();
    let options = RecordOptions {
        demonstrations,
        done: Vec::new(),
        baseline: BaselineLimits::of(&task.control.unwrap()),
        lockstep: true,
        interrupt: Arc::new(AtomicBool::new(false)),
    };
    let report = record(
        task,
        Box::new(arm),
        Box::new(kept.clone()),
        &options,
        &mut |_| {},
    )
    .unwrap();
    let (frames, done) = std::mem::take(&mut *kept.0.lock().unwrap());
    let header = Header {
        format: FORMAT_VERSION,
        engine: "test".to_owned(),
        object: task.name.clone(),
        joint: JointType::Revolute,
        sensor: "virtual-arm".to_owned(),
        actions: task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect(),
        rate_hz: task.control.unwrap().rate_hz,
        seed,
    };
    let recording = Recording {
        header,
        frames,
        done,
        loss: None,
    };
    (recording, report)
}
