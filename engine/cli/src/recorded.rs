//! The recording that every run makes.

use std::path::{Path, PathBuf};

use clap::Args;
use pubs_core::Task;
use pubs_core::object::Overrides;
use pubs_host::DriverInstance;
use pubs_policy::{PolicyFile, Runtime};
use pubs_run::recording::{
    Header, Limits, Listener, PolicyNote, RUN_FORMAT_VERSION, RecordingError, RecordingWriter,
    RunHeader, RunPreface, RunRecorder,
};
use pubs_run::{RunOptions, RunReport, utc};
use serde_json::Value;

use crate::failure::Failure;
use crate::object::Ready;
use crate::policies::sibling_folder;
use crate::show;

/// Environment variable that says where.
pub const RECORD_VARIABLE: &str = "PUBS_RECORD";

/// Where a run is recorded.
#[derive(Args)]
pub struct RecordingOptions {
    /// Record into this file (.mcap), or into this folder under a name with object and time
    /// [default: recordings, beside the object's folder]
    #[arg(long, value_name = "FILE|DIR", env = RECORD_VARIABLE)]
    record: Option<PathBuf>,
    /// Record nothing
    #[arg(long)]
    no_record: bool,
}

/// What a recording says of a run.
pub struct Setup<'a> {
    pub ready: &'a Ready,
    pub object: &'a Path,
    pub overrides: &'a Overrides,
    pub belief_frequency: Option<u32>,
    pub policy: &'a PolicyFile,
    pub runtime: &'a Runtime,
    pub arm: &'a DriverInstance,
}

/// Opens the recording, before anything moves; `listeners` hear what is recorded, even where
/// nothing is kept.
///
/// # Errors
/// Where the file exists already or cannot be created.
pub fn recorder(
    options: &RecordingOptions,
    setup: &Setup<'_>,
    run: &RunOptions,
    listeners: Vec<Box<dyn Listener>>,
) -> Result<Option<RunRecorder>, Failure> {
    if options.no_record && listeners.is_empty() {
        return Ok(None);
    }
    let header = header(RUN_FORMAT_VERSION, &setup.ready.task, setup.arm, run.seed);
    let mut writer = match options.no_record {
        true => RecordingWriter::unkept(&header),
        false => kept(options, setup, run, &header)?,
    };
    for listener in listeners {
        writer.listen(listener);
    }
    let task = &setup.ready.task;
    let limits = Limits {
        unit: task.joint.unit(),
        lower: task.joint.lower,
        upper: task.joint.upper,
        goals: run.goals.iter().map(|goal| goal.state).collect(),
        tolerance: task.reward.goal_tolerance,
    };
    let recorder = if run.lockstep {
        RunRecorder::direct(writer, &limits)
    } else {
        RunRecorder::queued(writer, &limits)
    };
    recorder.map(Some).map_err(|error| Failure::fault(&error))
}

/// A recording in a file, with all that it says of the run.
fn kept(
    options: &RecordingOptions,
    setup: &Setup<'_>,
    run: &RunOptions,
    header: &Header,
) -> Result<RecordingWriter, Failure> {
    let started = utc::now();
    let about = about(setup, run, &started);
    let resolved = setup.ready.loaded.resolved_text();
    let resolved = resolved.map_err(Failure::invalid)?;
    let preface = RunPreface {
        header,
        run: &about,
        object_toml: setup.ready.loaded.text(),
        resolved_toml: &resolved,
        policies: vec![setup.policy.bytes()],
    };
    let writer = create(options, setup, &started, &preface)?;
    show::detail(|| format!("recording: {}", writer.file().display()));
    Ok(writer)
}

/// Creates the file: the one that was named, or the first free name in the folder.
fn create(
    options: &RecordingOptions,
    setup: &Setup<'_>,
    started: &str,
    preface: &RunPreface<'_>,
) -> Result<RecordingWriter, Failure> {
    let refused = |error: RecordingError| {
        Failure::invalid(format!(
            "{error}\n  (--record FILE or DIR records elsewhere, --no-record not at all)"
        ))
    };
    let folder = match &options.record {
        Some(file) if is_file_name(file) => {
            return RecordingWriter::create_run(file, preface).map_err(refused);
        }
        Some(folder) => folder.clone(),
        None => folder_of(setup.object),
    };
    if folder.is_file() {
        return Err(Failure::invalid(format!(
            "--record {0}: {0} is a file, but no recording is named so; give the name of a new file (.mcap) or of a folder",
            folder.display()
        )));
    }
    std::fs::create_dir_all(&folder).map_err(|error| {
        Failure::invalid(format!(
            "cannot make the folder {}: {error}\n  (--record FILE or DIR records elsewhere, --no-record not at all)",
            folder.display()
        ))
    })?;
    let time = started.replace(['-', ':'], "");
    let stem = format!("{}-{time}", setup.ready.task.name);
    let mut part = 1;
    loop {
        match RecordingWriter::create_run(&part_of(&folder, &stem, part), preface) {
            // Another run of the same second.
            Err(RecordingError::Exists { .. }) => part += 1,
            created => return created.map_err(refused),
        }
    }
}

/// `recordings` beside the folder of an object file.
pub fn folder_of(object: &Path) -> PathBuf {
    sibling_folder(object, "recordings")
}

/// File of the first recording of a name, and of those that come after it.
pub fn part_of(folder: &Path, stem: &str, part: u32) -> PathBuf {
    match part {
        1 => folder.join(format!("{stem}.mcap")),
        part => folder.join(format!("{stem}-{part}.mcap")),
    }
}

/// Whether a recording of that name is a file, not a folder of them.
pub fn is_file_name(path: &Path) -> bool {
    !path.is_dir() && path.extension().is_some_and(|ending| ending == "mcap")
}

/// What a recording of any format says of its object.
pub fn header(format: u32, task: &Task, arm: &DriverInstance, seed: u64) -> Header {
    Header {
        format,
        engine: env!("CARGO_PKG_VERSION").to_owned(),
        object: task.name.clone(),
        joint: task.joint.joint_type(),
        sensor: arm.sensor().to_owned(),
        actions: task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect(),
        rate_hz: task.control.map_or(0.0, |control| control.rate_hz),
        seed,
    }
}

fn about(setup: &Setup<'_>, run: &RunOptions, started: &str) -> RunHeader {
    let (task, policy) = (&setup.ready.task, setup.policy);
    let contract = policy.contract();
    let plugin = setup.arm.plugin();
    RunHeader {
        goals: run
            .goals
            .iter()
            .map(|goal| (goal.state, goal.policy))
            .collect(),
        goal_tolerance: task.reward.goal_tolerance,
        shield: run.shield.map(|shield| (shield.mass, shield.flattening)),
        max_steps: run.max_steps,
        lockstep: run.lockstep,
        belief_frequency: setup.belief_frequency,
        vector_unit: pubs_core::vector::VectorUnit::best().to_string(),
        driver: format!("{} {}", plugin.name(), plugin.version()),
        driver_parameters: task
            .driver
            .as_ref()
            .map_or(Value::Null, |driver| driver.table.clone()),
        model: setup.ready.model_plugin.clone(),
        runtime: setup.runtime.to_string(),
        overrides: setup.overrides.typed(),
        policies: vec![PolicyNote {
            name: policy.path().display().to_string(),
            sha256: policy.sha256().to_owned(),
            foreign_inputs: contract.is_none().then(|| policy.inputs().to_vec()),
            contract: serde_json::to_value(contract).unwrap_or(Value::Null),
        }],
        started: (!run.lockstep).then(|| started.to_owned()),
    }
}

/// What the recording lacks, if anything.
pub fn trouble(report: &RunReport) -> Option<String> {
    match (&report.recording_fault, report.recording_dropped) {
        (Some(fault), _) => Some(format!(
            "{fault}\n  (the run went on without it; the recording holds what came before)"
        )),
        (None, 0) => None,
        (None, dropped) => Some(format!(
            "the disk was too slow for {dropped} entries of the recording, which are lost"
        )),
    }
}

/// Where it is, for the summary.
pub fn summary(report: &RunReport) -> String {
    match &report.recording {
        None => "not recorded\n".to_owned(),
        Some(file) if report.recording_dropped > 0 => format!(
            "recording {file} ({} entries lost)\n",
            report.recording_dropped
        ),
        Some(file) => format!("recording {file}\n"),
    }
}
