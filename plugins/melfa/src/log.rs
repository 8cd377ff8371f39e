//! Real failures, in words, on standard error: each kind at most once a second.
//!
//! A thread of its own writes them, for a terminal that is held (Ctrl-S) or a pipe that nobody reads
//! must not keep the motion thread waiting. What does not fit into its queue is dropped.

use std::collections::HashMap;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use crate::system::monotonic_ns;

/// Between two lines of one kind, ns.
const PAUSE_NS: u64 = 1_000_000_000;

/// Lines that wait for the writer.
const QUEUE: usize = 64;

/// At the close the last lines are waited for so long.
const FLUSH: Duration = Duration::from_millis(200);

/// When each kind was last said, and how often it was swallowed since.
static SAID: Mutex<Option<HashMap<&'static str, (u64, u32)>>> = Mutex::new(None);

enum Item {
    Line(String),
    /// Everything before it has been written.
    Mark(Sender<()>),
}

/// To the writer; `None` where there is no thread for it.
static WRITER: OnceLock<Option<SyncSender<Item>>> = OnceLock::new();

fn writer() -> Option<&'static SyncSender<Item>> {
    let start = || {
        let (sender, receiver) = mpsc::sync_channel(QUEUE);
        let thread = thread::Builder::new().name("melfa log".to_owned());
        thread.spawn(move || write(&receiver)).ok().map(|_| sender)
    };
    WRITER.get_or_init(start).as_ref()
}

fn write(items: &Receiver<Item>) {
    for item in items {
        match item {
            Item::Line(line) => eprintln!("melfa: {line}"),
            // Whoever waited may have given up.
            Item::Mark(done) => drop(done.send(())),
        }
    }
}

/// Says `text`, unless something of this kind was said less than a second ago.
pub fn say(kind: &'static str, text: &str) {
    let (Some(swallowed), Some(writer)) = (due(kind, monotonic_ns()), writer()) else {
        return;
    };
    let more = match swallowed {
        0 => String::new(),
        count => format!(" ({count} more like this)"),
    };
    // A full queue means that nobody reads.
    let _ = writer.try_send(Item::Line(format!("{text}{more}")));
}

/// Waits until everything said so far is written, or nobody reads it.
pub fn flush() {
    let (done, written) = mpsc::channel();
    if let Some(writer) = writer()
        && writer.try_send(Item::Mark(done)).is_ok()
    {
        let _ = written.recv_timeout(FLUSH);
    }
}

/// How many were swallowed since the last line of this kind; `None` where this one is, too.
fn due(kind: &'static str, now_ns: u64) -> Option<u32> {
    let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
    let said = said.get_or_insert_with(HashMap::new);
    match said.get_mut(kind) {
        Some((last_ns, swallowed)) if now_ns.saturating_sub(*last_ns) < PAUSE_NS => {
            *swallowed += 1;
            None
        }
        entry => {
            let swallowed = entry.map_or(0, |(_, swallowed)| *swallowed);
            said.insert(kind, (now_ns, 0));
            Some(swallowed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_of_a_kind_per_second() {
        let seconds = [0.0, 0.2, 0.9, 1.1, 1.2, 9.0];
        let found: Vec<_> = seconds
            .iter()
            .map(|second| due("test", 1 + (second * 1e9) as u64))
            .collect();
        assert_eq!(found, [Some(0), None, None, Some(2), None, Some(1)]);
        assert_eq!(due("another", 1), Some(0));
    }
}
