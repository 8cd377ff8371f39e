//! Moving the arm and keeping what it feels.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use pubs_calibrate::record::{
    BaselineLimits, Keeper, RecordError, RecordOptions, RecordReport, RecordStatus, record as drive,
};
use pubs_core::Task;
use pubs_core::object::LoadedObject;
use pubs_host::Registry;
use pubs_run::Sample;
use pubs_run::recording::{
    Done, FORMAT_VERSION, Frame, Observation, Recorder, RecordingWriter, read,
};

use super::Arguments;
use crate::failure::Failure;
use crate::{driver, exit, interrupt, recorded, show};

/// How recordings for a model are called, and those that only compare.
const CALIBRATION: &str = "calibration";
/// See [`CALIBRATION`].
const CHECK: &str = "check";

/// How a recording ended.
pub enum Recorded {
    /// Every demonstration is there, in these files.
    Whole(Vec<PathBuf>),
    /// The arm was stopped before; the verb ends with this code.
    Stopped(u8),
}

/// Records what is missing.
///
/// # Errors
/// Where nothing can be recorded.
pub fn record(
    arguments: &Arguments,
    loaded: &LoadedObject,
    task: &Arc<Task>,
    registry: &Registry,
) -> Result<Recorded, Failure> {
    let Some(control) = task.control else {
        return Err(Failure::invalid(
            RecordError::Abstract(task.name.clone()).to_string(),
        ));
    };
    let folder = arguments
        .recordings
        .clone()
        .unwrap_or_else(|| recorded::folder_of(&arguments.object));
    let kind = if arguments.check { CHECK } else { CALIBRATION };
    let earlier = Earlier::find(arguments, task, &folder, kind)?;
    if earlier.is_whole(task, arguments.demonstrations()) {
        show::note(&format!(
            "note: all demonstrations are recorded already in {}",
            names(&earlier.files)
        ));
        return Ok(Recorded::Whole(earlier.files));
    }
    let arm = driver::open(task, registry, &arguments.driver, arguments.seed)?;
    if arguments.check {
        driver::check_sensor(task, &arm, arguments.driver.accept_sensor)?;
    }
    std::fs::create_dir_all(&folder).map_err(|error| {
        Failure::invalid(format!(
            "cannot make the folder {}: {error}",
            folder.display()
        ))
    })?;
    let header = recorded::header(FORMAT_VERSION, task, &arm, arguments.seed);
    let writer = RecordingWriter::create(&earlier.next, &header, loaded.text())
        .map_err(|error| Failure::invalid(error.to_string()))?;
    let recorder = if arguments.driver.lockstep {
        Recorder::direct(writer)
    } else {
        Recorder::queued(writer).map_err(|error| Failure::fault(&error))?
    };
    let interrupt = interrupt::flag()?;
    let kept = Kept {
        recorder: Arc::new(Mutex::new(Some(recorder))),
        interrupt: Arc::clone(&interrupt),
    };
    let usual = BaselineLimits::of(&control);
    let options = RecordOptions {
        demonstrations: arguments.demonstrations(),
        done: earlier.done,
        baseline: BaselineLimits {
            off_n: arguments.baseline_off_n.unwrap_or(usual.off_n),
            noise_n: arguments.baseline_noise_n.unwrap_or(usual.noise_n),
        },
        lockstep: arguments.driver.lockstep,
        interrupt,
    };
    let bar = show::status_line();
    let mut watch = |status: &RecordStatus| bar.set_message(status_text(task, &options, status));
    let report = drive(
        task,
        Box::new(arm),
        Box::new(kept.clone()),
        &options,
        &mut watch,
    );
    bar.finish_and_clear();
    let report = match report {
        Ok(report) => report,
        Err(error) => {
            // Nothing was recorded, so nothing is kept.
            drop(kept.take());
            let _ = std::fs::remove_file(&earlier.next);
            return Err(refused(&error));
        }
    };
    let ending = close(&kept, &report);
    let mut files = earlier.files;
    files.push(earlier.next);
    told(arguments, &files, &report, ending)
}

fn refused(error: &RecordError) -> Failure {
    match error {
        RecordError::Driver(_) => Failure::fault(error),
        _ => Failure::Other {
            code: exit::SAFETY_STOP,
            message: error.to_string(),
        },
    }
}

/// What an interrupted recording has left.
struct Earlier {
    files: Vec<PathBuf>,
    done: Vec<Done>,
    /// Where to go on.
    next: PathBuf,
}

impl Earlier {
    fn find(
        arguments: &Arguments,
        task: &Task,
        folder: &Path,
        kind: &str,
    ) -> Result<Self, Failure> {
        let stem = stem(&task.name, kind);
        let name = |part: u32| recorded::part_of(folder, &stem, part);
        let parts = (1..).take_while(|&part| name(part).exists()).count() as u32;
        let next = name(parts + 1);
        if !arguments.resume {
            if parts > 0 && !arguments.check {
                return Err(Failure::invalid(format!(
                    "{} is there already: --resume goes on with it, --from {} fits it, --recordings DIR records elsewhere",
                    name(1).display(),
                    name(1).display()
                )));
            }
            return Ok(Self {
                files: Vec::new(),
                done: Vec::new(),
                next,
            });
        }
        if parts == 0 {
            return Err(Failure::invalid(format!(
                "there is nothing to resume: {} does not exist; leave out --resume",
                name(1).display()
            )));
        }
        let files: Vec<PathBuf> = (1..=parts).map(name).collect();
        let mut done = Vec::new();
        for file in &files {
            let recording = read(file).map_err(|error| Failure::invalid(error.to_string()))?;
            if let Some(loss) = &recording.loss {
                show::say(&format!("warning: {}: {loss}", file.display()));
            }
            done.extend(recording.done);
        }
        Ok(Self { files, done, next })
    }

    fn is_whole(&self, task: &Task, demonstrations: u32) -> bool {
        let moving = task.actions.iter().filter(|action| !action.is_stop());
        moving.into_iter().all(|action| {
            (1..=demonstrations).all(|demonstration| {
                self.done
                    .iter()
                    .any(|done| done.action == action.name && done.demonstration == demonstration)
            })
        })
    }
}

fn stem(object: &str, kind: &str) -> String {
    format!("{object}-{kind}")
}

/// The recordings that an object was calibrated with, where they still lie in their usual place.
pub fn found(object: &Path, name: &str) -> Vec<PathBuf> {
    let folder = recorded::folder_of(object);
    let stem = stem(name, CALIBRATION);
    (1..)
        .map(|part| recorded::part_of(&folder, &stem, part))
        .take_while(|file| file.exists())
        .collect()
}

/// The recorder, shared with the controller's thread until the arm rests.
#[derive(Clone)]
struct Kept {
    recorder: Arc<Mutex<Option<Recorder>>>,
    /// Calls the arm off where nothing more reaches the file.
    interrupt: Arc<AtomicBool>,
}

impl Kept {
    fn with(&self, act: impl FnOnce(&mut Recorder)) {
        let mut recorder = self.recorder.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(recorder) = recorder.as_mut() {
            act(recorder);
        }
    }

    fn take(&self) -> Option<Recorder> {
        self.recorder
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }
}

impl Keeper for Kept {
    fn frame(&mut self, frame: &Frame, sample: &Sample) {
        let observation = Observation {
            displacement: sample.displacement,
            forces_n: sample.forces_n,
        };
        let interrupt = Arc::clone(&self.interrupt);
        self.with(|recorder| {
            recorder.frame(frame, Some(&observation));
            if recorder.has_failed() {
                interrupt.store(true, Ordering::Release);
            }
        });
    }

    fn done(&mut self, time_ns: u64, done: Done) {
        self.with(|recorder| recorder.done(time_ns, done));
    }
}

/// Writes the last words and closes the file; what went wrong with it, if anything.
fn close(kept: &Kept, report: &RecordReport) -> Option<String> {
    kept.with(|recorder| {
        if let Some(trip) = &report.trip {
            recorder.guard(report.end_ns, trip.to_string());
        }
        recorder.timing(report.end_ns, report.lateness);
    });
    let finished = kept.take()?.finish();
    match finished.result {
        Err(error) => Some(error.to_string()),
        Ok(()) if finished.dropped > 0 => Some(format!(
            "the disk was too slow for {} readings, which are lost",
            finished.dropped
        )),
        Ok(()) => None,
    }
}

fn told(
    arguments: &Arguments,
    files: &[PathBuf],
    report: &RecordReport,
    ending: Option<String>,
) -> Result<Recorded, Failure> {
    let [x, y, z] = report.baseline.sd_n;
    show::note(&format!(
        "recorded {} of {} demonstrations in {:.0} s (sensor at rest: sd {x:.2}, {y:.2}, {z:.2} N) in {}",
        report.done.len(),
        report.wanted,
        report.time_s,
        names(files)
    ));
    if let Some(trouble) = ending {
        return Err(Failure::Other {
            code: exit::FAULT,
            message: trouble,
        });
    }
    let Some(trip) = &report.trip else {
        return Ok(Recorded::Whole(files.to_vec()));
    };
    let code = match trip.is_fault() {
        true => exit::FAULT,
        false => exit::SAFETY_STOP,
    };
    show::say(&format!(
        "stopped: {trip}\nwhat was recorded is kept; go on with: pubs-engine calibrate {} --resume",
        arguments.object.display()
    ));
    Ok(Recorded::Stopped(code))
}

fn names(files: &[PathBuf]) -> String {
    let names: Vec<String> = files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    names.join(", ")
}

fn status_text(task: &Task, options: &RecordOptions, status: &RecordStatus) -> String {
    let state = status.state.map_or_else(
        || "on the way to the closed limit".to_owned(),
        |state| format!("at {}", task.joint.display(state)),
    );
    format!(
        "{:5.1} s  demonstration {} of {}  {}  {state}  {} done",
        status.time_s,
        status.demonstration.max(1),
        options.demonstrations,
        task.actions[status.action].name,
        status.done,
    )
}
