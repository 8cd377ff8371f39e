//! A bounded queue before a thread that writes.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};

use super::{Finished, RecordingError};

/// Starts a thread behind a queue of `capacity` entries; `dropped` counts those that found no room.
pub(super) fn start<T: Send + 'static>(
    file: &Path,
    capacity: usize,
    dropped: Arc<AtomicU64>,
    consume: impl FnOnce(Receiver<T>) -> Result<(), RecordingError> + Send + 'static,
) -> std::io::Result<(Entrance<T>, WriterThread)> {
    let (entries, receiver) = sync_channel(capacity);
    let thread = thread::Builder::new()
        .name("recorder".to_owned())
        .spawn(move || consume(receiver))?;
    let file = file.to_owned();
    Ok((Entrance { entries, dropped }, WriterThread { file, thread }))
}

/// The near end of a queue; several threads may have one.
pub(super) struct Entrance<T> {
    entries: SyncSender<T>,
    dropped: Arc<AtomicU64>,
}

impl<T> Clone for Entrance<T> {
    fn clone(&self) -> Self {
        Self {
            entries: self.entries.clone(),
            dropped: Arc::clone(&self.dropped),
        }
    }
}

impl<T> Entrance<T> {
    /// Gives an entry back where there is no room for it. A thread that has ended says why when it
    /// is joined; its entries are not missed here.
    fn offer(&self, entry: T) -> Option<T> {
        match self.entries.try_send(entry) {
            Err(TrySendError::Full(entry)) => Some(entry),
            Ok(()) | Err(TrySendError::Disconnected(_)) => None,
        }
    }

    fn count_dropped(&self) {
        self.dropped.fetch_add(1, Ordering::AcqRel);
    }

    /// Whether there was room; if not, the entry is dropped and counted. It never waits for the
    /// writer.
    pub fn send_or_drop(&self, entry: T) -> bool {
        let found_room = self.offer(entry).is_none();
        if !found_room {
            self.count_dropped();
        }
        found_room
    }

    /// Waits for room.
    pub fn send_and_wait(&self, entry: T) {
        // A thread that has ended says why when it is joined.
        let _ = self.entries.send(entry);
    }
}

/// The thread at the far end.
pub(super) struct WriterThread {
    file: PathBuf,
    thread: JoinHandle<Result<(), RecordingError>>,
}

impl WriterThread {
    /// Whether it takes no more entries.
    pub fn has_ended(&self) -> bool {
        self.thread.is_finished()
    }

    /// Waits for its end; that comes once no entrance is left, or when an entry tells it.
    pub fn join(self) -> Result<(), RecordingError> {
        let panicked = RecordingError::Write {
            file: self.file,
            reason: "the recorder's thread panicked; this is a bug".to_owned(),
        };
        self.thread.join().unwrap_or(Err(panicked))
    }
}

/// A queue with one entrance, some of whose entries must not be lost.
pub(super) struct Queue<T> {
    entrance: Entrance<T>,
    thread: WriterThread,
    /// Entries that must not be lost and found no room; sent before anything newer.
    waiting: VecDeque<T>,
}

impl<T: Send + 'static> Queue<T> {
    /// Starts the thread; the queue holds `capacity` entries.
    pub fn start(
        file: &Path,
        capacity: usize,
        consume: impl FnOnce(Receiver<T>) -> Result<(), RecordingError> + Send + 'static,
    ) -> std::io::Result<Self> {
        let (entrance, thread) = start(file, capacity, Arc::default(), consume)?;
        Ok(Self {
            entrance,
            thread,
            waiting: VecDeque::new(),
        })
    }

    /// Sends an entry if there is room for it.
    pub fn send_or_drop(&mut self, entry: T) {
        self.send_waiting();
        if self.waiting.is_empty() {
            self.entrance.send_or_drop(entry);
        } else {
            self.entrance.count_dropped();
        }
    }

    /// Sends an entry as soon as there is room for it.
    pub fn send_in_turn(&mut self, entry: T) {
        self.waiting.push_back(entry);
        self.send_waiting();
    }

    fn send_waiting(&mut self) {
        while let Some(entry) = self.waiting.pop_front() {
            if let Some(entry) = self.entrance.offer(entry) {
                self.waiting.push_front(entry);
                return;
            }
        }
    }

    /// Whether the thread takes no more entries.
    pub fn has_ended(&self) -> bool {
        self.thread.has_ended()
    }

    /// Sends what waits, and waits for the thread.
    pub fn finish(self) -> Finished {
        for entry in self.waiting {
            self.entrance.send_and_wait(entry);
        }
        let dropped = Arc::clone(&self.entrance.dropped);
        drop(self.entrance);
        Finished {
            result: self.thread.join(),
            dropped: dropped.load(Ordering::Acquire),
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
