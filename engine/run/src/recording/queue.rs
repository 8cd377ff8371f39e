//! A bounded queue before a thread that writes.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};

use super::{Finished, RecordingError};

/// A thread and the bounded queue before it.
pub(super) struct Queue<T> {
    file: PathBuf,
    entries: SyncSender<T>,
    thread: JoinHandle<Result<(), RecordingError>>,
    /// Entries that must not be lost and found no room; sent before anything newer.
    waiting: VecDeque<T>,
    dropped: u64,
}

impl<T: Send + 'static> Queue<T> {
    /// Starts the thread; the queue holds `capacity` entries.
    pub fn start(
        file: &Path,
        capacity: usize,
        consume: impl FnOnce(Receiver<T>) -> Result<(), RecordingError> + Send + 'static,
    ) -> std::io::Result<Self> {
        let (entries, receiver) = sync_channel(capacity);
        let thread = thread::Builder::new()
            .name("recorder".to_owned())
            .spawn(move || consume(receiver))?;
        Ok(Self {
            file: file.to_owned(),
            entries,
            thread,
            waiting: VecDeque::new(),
            dropped: 0,
        })
    }

    /// Sends an entry if there is room for it.
    pub fn send_or_drop(&mut self, entry: T) {
        self.send_waiting();
        let full = !self.waiting.is_empty()
            || matches!(self.entries.try_send(entry), Err(TrySendError::Full(_)));
        self.dropped += u64::from(full);
    }

    /// Sends an entry as soon as there is room for it.
    pub fn send_in_turn(&mut self, entry: T) {
        self.waiting.push_back(entry);
        self.send_waiting();
    }

    fn send_waiting(&mut self) {
        while let Some(entry) = self.waiting.pop_front() {
            if let Err(TrySendError::Full(entry)) = self.entries.try_send(entry) {
                self.waiting.push_front(entry);
                return;
            }
        }
    }

    /// Whether the thread takes no more entries.
    pub fn has_ended(&self) -> bool {
        self.thread.is_finished()
    }

    /// Sends what waits, and waits for the thread.
    pub fn finish(self) -> Finished {
        for entry in self.waiting {
            // A thread that has ended says why below.
            let _ = self.entries.send(entry);
        }
        drop(self.entries);
        let panicked = RecordingError::Write {
            file: self.file,
            reason: "the recorder's thread panicked; this is a bug".to_owned(),
        };
        Finished {
            result: self.thread.join().unwrap_or(Err(panicked)),
            dropped: self.dropped,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn a_full_queue_drops_what_may_be_dropped_and_nothing_else() {
        let (open, gate) = channel();
        let (log, arrived) = channel();
        // A disk that takes nothing until the gate is opened.
        let mut queue = Queue::start(Path::new("slow"), 3, move |entries| {
            let () = gate.recv().unwrap();
            for entry in entries {
                log.send(entry).unwrap();
            }
            Ok(())
        })
        .unwrap();
        for entry in ["0", "1", "2", "3", "4"] {
            queue.send_or_drop(entry);
        }
        queue.send_in_turn("done");
        queue.send_in_turn("guard");
        queue.send_or_drop("7");
        assert_eq!(queue.dropped, 3, "3, 4 and 7 found no room");
        open.send(()).unwrap();
        let finished = queue.finish();
        assert_eq!(finished.dropped, 3);
        assert_eq!(finished.result, Ok(()));
        let arrived: Vec<_> = arrived.iter().collect();
        assert_eq!(arrived, ["0", "1", "2", "done", "guard"]);
    }

    #[test]
    fn a_panic_of_the_thread_is_an_error() {
        let queue =
            Queue::<()>::start(Path::new("lost.mcap"), 1, |_| panic!("on purpose")).unwrap();
        let text = queue.finish().result.unwrap_err().to_string();
        assert!(
            text.contains("lost.mcap") && text.contains("panicked"),
            "{text}"
        );
    }
}
