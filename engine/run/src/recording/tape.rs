//! Recording a run from three loops at once, none of which may wait.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::queue::{self, Entrance, WriterThread};
use super::steps::{BeliefStep, Choice, Limits, Tick};
use super::{Finished, RecordingError, RecordingWriter};
use crate::clock::{SECOND_NS, now_ns};
use crate::loops::Period;
use crate::recording::Observation;
use crate::report::{LatenessReport, RunReport};

/// Entries that may wait for the disk: ten seconds of three loops.
const CAPACITY: usize = 1400;

/// What is recorded reaches the operating system within this, even where nothing follows.
const IDLE: Duration = Duration::from_millis(500);

/// What a run records.
enum Entry {
    Tick(Tick),
    Belief(BeliefStep),
    Choice(Choice),
    Guard(u64, String),
    Timing(u64, LatenessReport),
    Report(Box<RunReport>),
    /// Nothing has come for a while.
    Idle,
    End,
}

/// The recorder of a run; each loop has its own front end.
///
/// [`direct`](Self::direct) writes within each call, for a virtual clock; [`queued`](Self::queued)
/// leaves it to a thread behind a bounded queue: an entry that finds no room is dropped and
/// counted, and no call ever waits for the disk.
pub struct RunRecorder {
    /// `None` where those who listen are all there is.
    file: Option<PathBuf>,
    tape: Tape,
    thread: Option<WriterThread>,
}

/// The front end for one loop.
#[derive(Clone)]
pub(crate) struct Tape {
    way: Way,
    dropped: Arc<AtomicU64>,
    /// Whether it is recorded why the guard stopped the arm.
    guarded: Arc<AtomicBool>,
}

#[derive(Clone)]
enum Way {
    Direct(Arc<Mutex<Direct>>),
    Queued(Entrance<Entry>),
}

struct Direct {
    /// `None` once nobody wants more.
    writer: Option<Writer>,
    result: Result<(), RecordingError>,
}

/// A writer and what it needs to know of the run.
struct Writer {
    recording: RecordingWriter,
    range: (f64, f64),
    dropped: Arc<AtomicU64>,
    /// Drops that the file knows of.
    noted: u64,
    /// Time of the newest tick.
    time_ns: u64,
    /// Why the file ends before the run.
    fault: Option<RecordingError>,
}

impl RunRecorder {
    /// Writes within each call: on a virtual clock, whose loops wait for each other anyway.
    ///
    /// # Errors
    /// Where the disk is full or gone.
    pub fn direct(recording: RecordingWriter, limits: &Limits) -> Result<Self, RecordingError> {
        let file = kept_file(&recording);
        let dropped = Arc::default();
        let writer = Writer::begin(recording, limits, SECOND_NS, &dropped)?;
        let direct = Direct {
            writer: Some(writer),
            result: Ok(()),
        };
        Ok(Self {
            file,
            tape: Tape {
                way: Way::Direct(Arc::new(Mutex::new(direct))),
                dropped,
                guarded: Arc::default(),
            },
            thread: None,
        })
    }

    /// Writes from a thread of its own. Call it from a thread without real-time scheduling, which
    /// a new thread would inherit.
    ///
    /// # Errors
    /// Where the disk is full or gone, or the operating system gives no thread.
    pub fn queued(recording: RecordingWriter, limits: &Limits) -> Result<Self, RecordingError> {
        let (name, file) = (recording.file().to_owned(), kept_file(&recording));
        let dropped = Arc::default();
        let writer = Writer::begin(recording, limits, now_ns(), &dropped)?;
        let write = move |entries| writer.write_all(&entries);
        let (entries, thread) = queue::start(&name, CAPACITY, Arc::clone(&dropped), write)
            .map_err(|error| RecordingError::write(&name, &error))?;
        Ok(Self {
            file,
            tape: Tape {
                way: Way::Queued(entries),
                dropped,
                guarded: Arc::default(),
            },
            thread: Some(thread),
        })
    }

    /// The file; `None` where nothing is kept.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    pub(crate) fn tape(&self) -> Tape {
        self.tape.clone()
    }

    /// Writes what still waits and the run's last words, and closes the file. This may take as long
    /// as the disk does.
    pub(crate) fn finish(self, end_ns: u64, report: &RunReport) -> Finished {
        let dropped = || self.tape.dropped.load(Ordering::Acquire);
        let is_told = self.tape.guarded.load(Ordering::Acquire);
        let guard = report.reason.clone().filter(|_| !is_told);
        let guard = guard.map(|reason| Entry::Guard(end_ns, reason));
        let last_words = [
            Entry::Timing(end_ns, report.lateness),
            Entry::Report(Box::new(RunReport {
                recording_dropped: dropped(),
                ..report.clone()
            })),
            Entry::End,
        ];
        for entry in guard.into_iter().chain(last_words) {
            self.tape.send_and_wait(entry);
        }
        let result = match (&self.tape.way, self.thread) {
            (_, Some(thread)) => thread.join(),
            (Way::Direct(direct), None) => locked(direct).result.clone(),
            (Way::Queued(_), None) => Ok(()),
        };
        Finished {
            result,
            dropped: self.tape.dropped.load(Ordering::Acquire),
        }
    }
}

fn kept_file(recording: &RecordingWriter) -> Option<PathBuf> {
    recording.is_kept().then(|| recording.file().to_owned())
}

fn locked(direct: &Mutex<Direct>) -> std::sync::MutexGuard<'_, Direct> {
    direct.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Tape {
    /// Records a tick of the controller, and why the guard stopped the arm if that is new.
    pub fn period(&self, period: &Period<'_>) {
        let felt = period.felt.map(|felt| {
            let observation = Observation {
                displacement: felt.sample.displacement,
                forces_n: felt.sample.forces_n,
            };
            (felt.frame, observation)
        });
        self.send(Entry::Tick(Tick {
            tick: period.tick,
            time_ns: period.time_ns,
            order_ns: period.order_ns,
            stopping: period.stopping,
            felt,
        }));
        if let Some(trip) = period.trip
            && self.send(Entry::Guard(period.time_ns, trip.to_string()))
        {
            self.guarded.store(true, Ordering::Release);
        }
    }

    /// Records a step of the filter.
    pub fn belief(&self, step: BeliefStep) {
        self.send(Entry::Belief(step));
    }

    /// Records a step of the policy.
    pub fn choice(&self, choice: Choice) {
        self.send(Entry::Choice(choice));
    }

    /// Whether the entry found room.
    fn send(&self, entry: Entry) -> bool {
        match &self.way {
            Way::Direct(direct) => {
                locked(direct).write(entry);
                true
            }
            Way::Queued(entries) => entries.send_or_drop(entry),
        }
    }

    fn send_and_wait(&self, entry: Entry) {
        match &self.way {
            Way::Direct(direct) => locked(direct).write(entry),
            Way::Queued(entries) => entries.send_and_wait(entry),
        }
    }
}

impl Direct {
    /// Writes unless something has failed before.
    fn write(&mut self, entry: Entry) {
        let Some(mut writer) = self.writer.take() else {
            return;
        };
        if matches!(entry, Entry::End) {
            self.result = writer.finish();
            return;
        }
        match writer.write(entry) {
            Ok(()) => self.writer = Some(writer),
            Err(error) => self.result = Err(error),
        }
    }
}

impl Writer {
    fn begin(
        mut recording: RecordingWriter,
        limits: &Limits,
        time_ns: u64,
        dropped: &Arc<AtomicU64>,
    ) -> Result<Self, RecordingError> {
        recording.limits(time_ns, limits)?;
        Ok(Self {
            recording,
            range: (limits.lower, limits.upper),
            dropped: Arc::clone(dropped),
            noted: 0,
            time_ns,
            fault: None,
        })
    }

    fn write_all(mut self, entries: &Receiver<Entry>) -> Result<(), RecordingError> {
        loop {
            match entries.recv_timeout(IDLE) {
                Ok(Entry::End) | Err(RecvTimeoutError::Disconnected) => return self.finish(),
                Ok(entry) => self.write(entry)?,
                Err(RecvTimeoutError::Timeout) => self.write(Entry::Idle)?,
            }
        }
    }

    /// Writes an entry. Where the file fails, the rest is for those who listen; an error where
    /// nobody does.
    fn write(&mut self, entry: Entry) -> Result<(), RecordingError> {
        let Err(error) = self.put(entry) else {
            return Ok(());
        };
        if !self.recording.forsake_file() {
            return Err(error);
        }
        self.fault.get_or_insert(error);
        Ok(())
    }

    fn put(&mut self, entry: Entry) -> Result<(), RecordingError> {
        let recording = &mut self.recording;
        match entry {
            Entry::Tick(tick) => {
                self.time_ns = tick.time_ns;
                recording.tick(&tick)?;
            }
            Entry::Belief(step) => recording.belief(&step, self.range)?,
            Entry::Choice(choice) => recording.choice(&choice)?,
            Entry::Guard(time_ns, reason) => recording.guard(time_ns, &reason)?,
            Entry::Timing(time_ns, lateness) => recording.timing(time_ns, &lateness)?,
            Entry::Report(report) => {
                recording.tell_end(&report);
                recording.report(&report)?;
            }
            Entry::Idle => recording.flush()?,
            Entry::End => {}
        }
        self.note_drops()
    }

    /// The file itself says how much it lacks, as soon as something can be written again.
    fn note_drops(&mut self) -> Result<(), RecordingError> {
        let dropped = self.dropped.load(Ordering::Acquire);
        if dropped == self.noted {
            return Ok(());
        }
        self.noted = dropped;
        self.recording.dropped(self.time_ns, dropped)
    }

    fn finish(mut self) -> Result<(), RecordingError> {
        self.write(Entry::End)?;
        match self.fault {
            Some(fault) => Err(fault),
            None => self.recording.finish(),
        }
    }
}

#[cfg(test)]
mod tests;
