//! Recording beside a control loop, which must never wait for a disk.

use std::sync::mpsc::Receiver;

use super::queue::Queue;
use super::{Done, Frame, Observation, RecordingError, RecordingWriter};
use crate::report::LatenessReport;

/// Frames that may wait for the disk: ten seconds of them.
const CAPACITY: usize = 1000;

/// What a recorder takes.
enum Entry {
    Frame(Frame, Option<Observation>),
    Done(u64, Done),
    Guard(u64, String),
    Timing(u64, LatenessReport),
}

/// The front end of a [`RecordingWriter`]: calls cannot fail, the first error is kept for
/// [`finish`](Self::finish).
///
/// [`direct`](Self::direct) writes within the call, for a virtual clock; [`queued`](Self::queued)
/// leaves the writing to a thread, and no call blocks: a frame for which the queue has no room is
/// dropped and counted, everything else waits its turn.
pub struct Recorder(Way);

enum Way {
    Direct {
        writer: Box<RecordingWriter>,
        error: Option<RecordingError>,
    },
    Queued(Queue<Entry>),
}

/// How a recording went.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// The first error; the file holds what came before it.
    pub result: Result<(), RecordingError>,
    /// Frames for which the queue had no room.
    pub dropped: u64,
}

impl Recorder {
    /// Writes within each call.
    pub fn direct(writer: RecordingWriter) -> Self {
        Self(Way::Direct {
            writer: Box::new(writer),
            error: None,
        })
    }

    /// Writes from a thread of its own. Call it from a thread without real-time scheduling, which
    /// a new thread would inherit.
    ///
    /// # Errors
    /// Where the operating system gives no thread.
    pub fn queued(writer: RecordingWriter) -> Result<Self, RecordingError> {
        let file = writer.file().to_owned();
        Queue::start(&file, CAPACITY, move |entries| write_all(writer, &entries))
            .map(|queue| Self(Way::Queued(queue)))
            .map_err(|error| RecordingError::write(&file, &error))
    }

    /// Records one control period; `observation` where the path of the handle is known.
    pub fn frame(&mut self, frame: &Frame, observation: Option<&Observation>) {
        match &mut self.0 {
            Way::Direct { writer, error } => {
                keep(error, || writer.frame(frame, observation));
            }
            Way::Queued(queue) => queue.send_or_drop(Entry::Frame(*frame, observation.copied())),
        }
    }

    /// Records that a demonstration was carried out to its end.
    pub fn done(&mut self, time_ns: u64, done: Done) {
        self.note(Entry::Done(time_ns, done));
    }

    /// Records why the guard stopped the arm.
    pub fn guard(&mut self, time_ns: u64, reason: String) {
        self.note(Entry::Guard(time_ns, reason));
    }

    /// Records how late the loops were.
    pub fn timing(&mut self, time_ns: u64, lateness: LatenessReport) {
        self.note(Entry::Timing(time_ns, lateness));
    }

    fn note(&mut self, entry: Entry) {
        match &mut self.0 {
            Way::Direct { writer, error } => {
                keep(error, || write(writer, &entry));
            }
            Way::Queued(queue) => queue.send_in_turn(entry),
        }
    }

    /// Whether nothing more reaches the file, as on a full disk; [`finish`](Self::finish) says why.
    pub fn has_failed(&self) -> bool {
        match &self.0 {
            Way::Direct { error, .. } => error.is_some(),
            Way::Queued(queue) => queue.has_ended(),
        }
    }

    /// Writes what still waits and closes the file. This may take as long as the disk does.
    pub fn finish(self) -> Finished {
        match self.0 {
            Way::Direct { writer, error } => Finished {
                result: error.map_or_else(|| writer.finish(), Err),
                dropped: 0,
            },
            Way::Queued(queue) => queue.finish(),
        }
    }
}

/// Does `write` unless something has failed before, and keeps its error.
fn keep(error: &mut Option<RecordingError>, write: impl FnOnce() -> Result<(), RecordingError>) {
    if error.is_none() {
        *error = write().err();
    }
}

fn write(writer: &mut RecordingWriter, entry: &Entry) -> Result<(), RecordingError> {
    match entry {
        Entry::Frame(frame, observation) => writer.frame(frame, observation.as_ref()),
        Entry::Done(time_ns, done) => writer.done(*time_ns, done),
        Entry::Guard(time_ns, reason) => writer.guard(*time_ns, reason),
        Entry::Timing(time_ns, lateness) => writer.timing(*time_ns, lateness),
    }
}

fn write_all(mut writer: RecordingWriter, entries: &Receiver<Entry>) -> Result<(), RecordingError> {
    for entry in entries {
        write(&mut writer, &entry)?;
    }
    writer.finish()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::recording::{read, testing};

    #[test]
    fn both_ways_write_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let record = |name: &str, queued: bool| {
            let file = folder.path().join(name);
            let writer = RecordingWriter::create(&file, &testing::header(), "").unwrap();
            let mut recorder = if queued {
                Recorder::queued(writer).unwrap()
            } else {
                Recorder::direct(writer)
            };
            for index in 0..300 {
                recorder.frame(&testing::frame(index), None);
            }
            let done = Done {
                action: "safe_open".to_owned(),
                demonstration: 1,
            };
            recorder.done(5, done);
            recorder.guard(6, "interrupted".to_owned());
            recorder.timing(7, LatenessReport::default());
            assert!(!recorder.has_failed());
            let finished = recorder.finish();
            assert_eq!(finished.result, Ok(()), "{name}");
            assert_eq!(finished.dropped, 0, "{name}");
            file
        };
        let direct = record("direct.mcap", false);
        let queued = record("queued.mcap", true);
        assert!(std::fs::read(&direct).unwrap() == std::fs::read(&queued).unwrap());
        let recording = read(&direct).unwrap();
        assert_eq!(recording.frames.len(), 300);
        assert_eq!(recording.done.len(), 1);
        assert_eq!(recording.loss, None);
    }

    #[test]
    fn the_first_error_is_kept_and_ends_the_writing() {
        let folder = tempfile::tempdir().unwrap();
        for queued in [false, true] {
            let file = folder.path().join(format!("{queued}.mcap"));
            let writer = RecordingWriter::create(&file, &testing::header(), "").unwrap();
            let mut recorder = if queued {
                Recorder::queued(writer).unwrap()
            } else {
                Recorder::direct(writer)
            };
            recorder.frame(&testing::frame(0), None);
            let mut unknown = testing::frame(1);
            unknown.action = 99;
            recorder.frame(&unknown, None);
            unknown.action = 98;
            recorder.frame(&unknown, None);
            while !recorder.has_failed() {
                std::thread::yield_now();
            }
            let text = recorder.finish().result.unwrap_err().to_string();
            assert!(text.contains("no action 99"), "queued {queued}: {text}");
            assert_eq!(read(&file).unwrap().frames.len(), 1, "queued {queued}");
        }
    }

    #[test]
    fn a_recorder_can_go_to_another_thread() {
        fn is_send<T: Send>() {}
        is_send::<Recorder>();
    }
}
