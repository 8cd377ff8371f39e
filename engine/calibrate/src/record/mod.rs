//! Recording demonstrations: the arm opens and closes the object between its limits, §III-C.1.
//!
//! [`record()`] tares, touches a limit for the zero and then carries out the four movement actions
//! (`demonstrator`) through the guard and the loops of a run. Each control period goes to a
//! [`Keeper`]; a stop from outside or by the guard loses nothing of what was recorded before.

mod baseline;
mod demonstrator;
mod moves;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc;

use pubs_core::Task;
use pubs_run::recording::{Done, Frame};
use pubs_run::{
    Arm, ArmError, Drive, Follower, LatenessReport, Period, Rates, Sample, Signals, Trip,
};

pub use baseline::{Baseline, BaselineLimits};
pub use demonstrator::RecordStatus;

use demonstrator::Demonstrator;
use moves::Moves;

/// Keeps what happens. Called from the controller's thread: it must never wait.
pub trait Keeper: Send {
    /// One control period.
    fn frame(&mut self, frame: &Frame, sample: &Sample);
    /// A demonstration came to its end.
    fn done(&mut self, time_ns: u64, done: Done);
}

/// How to record.
#[derive(Clone)]
pub struct RecordOptions {
    /// Demonstrations of each movement action.
    pub demonstrations: u32,
    /// Those that an earlier recording holds already.
    pub done: Vec<Done>,
    /// What the resting sensor may show.
    pub baseline: BaselineLimits,
    /// On a virtual clock instead of in real time.
    pub lockstep: bool,
    /// Set from outside to stop.
    pub interrupt: Arc<AtomicBool>,
}

/// How a recording went.
#[derive(Debug, Clone)]
pub struct RecordReport {
    /// The sensor at rest, after the tare.
    pub baseline: Baseline,
    /// Demonstrations that came to their end, those of earlier recordings among them.
    pub done: Vec<Done>,
    /// How many there should be.
    pub wanted: usize,
    /// Why the arm was stopped before the end, if it was.
    pub trip: Option<Trip>,
    /// Duration, s.
    pub time_s: f64,
    /// When the arm came to rest, on the clock of the readings.
    pub end_ns: u64,
    /// How late the loops were.
    pub lateness: LatenessReport,
}

/// Why nothing could be recorded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecordError {
    /// An abstract object.
    #[error("object `{0}` has an abstract joint; only doors and drawers are calibrated")]
    Abstract(String),
    /// The driver failed.
    #[error("the driver failed: {0}")]
    Driver(#[from] ArmError),
    /// The sensor is noisy.
    #[error(
        "the force sensor is noisy at rest: standard deviation {:.2}, {:.2}, {:.2} N (x, y, z), allowed are {limit_n} N; \
         look for vibration, a loose cable or a wrong filter setting of the sensor",
        baseline.sd_n[0], baseline.sd_n[1], baseline.sd_n[2]
    )]
    Noisy {
        /// What it shows.
        baseline: Baseline,
        /// What is allowed, N.
        limit_n: f64,
    },
    /// The sensor is off.
    #[error(
        "the force sensor shows {off_n:.2} N at rest after the tare ({:.2}, {:.2}, {:.2} N in x, y, z), allowed are {limit_n} N; \
         tare it out of contact, release what the grasp holds under tension, or check the tool's weight compensation",
        baseline.mean_n[0], baseline.mean_n[1], baseline.mean_n[2]
    )]
    Off {
        /// What it shows.
        baseline: Baseline,
        /// Length of the mean force, N.
        off_n: f64,
        /// What is allowed, N.
        limit_n: f64,
    },
}

/// The follower of a recording: hands the newest sample on.
struct Handing;

impl Follower for Handing {
    type Message = Sample;

    fn step(&mut self, _now_ns: u64, sample: &Sample) -> Result<Sample, String> {
        Ok(*sample)
    }
}

/// Records until every demonstration is done, or the arm is stopped.
///
/// # Errors
/// [`RecordError`] before anything moves; later trouble is in the report.
pub fn record(
    task: &Arc<Task>,
    mut arm: Box<dyn Arm>,
    mut keeper: Box<dyn Keeper>,
    options: &RecordOptions,
    watch: &mut dyn FnMut(&RecordStatus),
) -> Result<RecordReport, RecordError> {
    let control = task
        .control
        .ok_or_else(|| RecordError::Abstract(task.name.clone()))?;
    let moves = Moves::of(task).ok_or_else(|| RecordError::Abstract(task.name.clone()))?;
    let baseline = baseline::tared(arm.as_mut(), &control, &options.baseline, options.lockstep)?;
    let (events, heard) = mpsc::channel();
    let demonstrator = Demonstrator::new(
        task,
        control,
        moves,
        options.demonstrations,
        options.done.clone(),
        events,
    );
    let tap = Box::new(move |period: &Period<'_>| {
        let Some(felt) = &period.felt else {
            return;
        };
        keeper.frame(&felt.frame, &felt.sample);
        for done in heard.try_iter() {
            keeper.done(felt.frame.reading.time_ns, done);
        }
    });
    // The demonstrator decides as often as the controller steps, so that a high-force stroke ends
    // just where one more policy step of it would leave the limits.
    let rates = Rates {
        names: ["sample", "demonstration"],
        follower_hz: control.rate_hz,
        chooser_hz: control.rate_hz,
    };
    let drive = Drive::new(
        task,
        control,
        arm,
        Handing,
        demonstrator,
        &rates,
        Signals::new(),
        Some(tap),
        Arc::clone(&options.interrupt),
    );
    let driven = drive.run(options.lockstep, watch);
    Ok(RecordReport {
        baseline,
        done: driven.chooser.into_done(),
        wanted: options.demonstrations as usize * Moves::COUNT,
        trip: driven.trip,
        time_s: driven.time_s,
        end_ns: driven.end_ns,
        lateness: driven.lateness,
    })
}
