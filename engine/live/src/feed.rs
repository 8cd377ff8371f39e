//! What is recorded, passed on to whoever looks, without ever waiting for them.
//!
//! A viewer that comes late is given what the [`Feed`] remembers; one that is too slow misses
//! messages and is told how many.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pubs_run::RunReport;
use pubs_run::recording::{Listener, Message};
use tokio::sync::broadcast::{self, Receiver, Sender};

/// Messages that a viewer may be behind: several seconds of a run.
const BEHIND: usize = 8192;
/// Bytes that are remembered for those who come late: two minutes of a run, or more.
const REMEMBERED: usize = 16 << 20;

/// A message as viewers get it: a JSON array of topic and message.
pub(crate) type Line = Arc<str>;

/// One for all viewers.
#[derive(Clone)]
pub(crate) struct Feed(Arc<Mutex<State>>);

struct State {
    /// Comes once, at the beginning, and is never forgotten.
    limits: Option<Line>,
    past: VecDeque<Line>,
    bytes: usize,
    forgotten: u64,
    viewers: Sender<Line>,
}

/// What a new viewer gets: first the past, then what comes.
pub(crate) struct Viewed {
    pub past: Vec<Line>,
    pub coming: Receiver<Line>,
}

impl Feed {
    pub fn new() -> Self {
        Self(Arc::new(Mutex::new(State {
            limits: None,
            past: VecDeque::new(),
            bytes: 0,
            forgotten: 0,
            viewers: broadcast::channel(BEHIND).0,
        })))
    }

    /// For a new viewer.
    pub fn view(&self) -> Viewed {
        let state = self.state();
        let forgotten = (state.forgotten > 0).then(|| missed(state.forgotten));
        let past = forgotten.iter().chain(&state.limits).chain(&state.past);
        Viewed {
            past: past.cloned().collect(),
            coming: state.viewers.subscribe(),
        }
    }

    /// How many look.
    pub fn viewers(&self) -> usize {
        self.state().viewers.receiver_count()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn pass_on(&self, topic: &str, json: &str) {
        let line: Line = format!("[\"{topic}\",{json}]").into();
        let mut state = self.state();
        // An error: nobody looks.
        _ = state.viewers.send(Arc::clone(&line));
        if topic == "/limits" {
            state.limits = Some(line);
        } else {
            state.remember(line);
        }
    }
}

impl State {
    fn remember(&mut self, line: Line) {
        self.bytes += line.len();
        self.past.push_back(line);
        while self.bytes > REMEMBERED {
            let Some(oldest) = self.past.pop_front() else {
                return;
            };
            self.bytes -= oldest.len();
            self.forgotten += 1;
        }
    }
}

/// Tells a viewer how many messages it has not seen.
pub(crate) fn missed(count: u64) -> Line {
    format!("[\"missed\",{count}]").into()
}

impl Listener for Feed {
    fn hear(&mut self, message: &Message<'_>) {
        // JSON is UTF-8; what is not was never written by the recorder.
        if let Ok(json) = std::str::from_utf8(message.json) {
            self.pass_on(message.topic, json);
        }
    }

    fn end(&mut self, report: &RunReport) {
        if let Ok(json) = serde_json::to_string(report) {
            self.pass_on("end", &json);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use tokio::sync::broadcast::error::TryRecvError;

    use super::*;

    fn tell(feed: &mut Feed, topic: &'static str, json: &str) {
        feed.hear(&Message {
            topic,
            time_ns: 0,
            json: json.as_bytes(),
        });
    }

    #[test]
    fn who_comes_late_sees_what_came_before_and_then_what_comes() {
        let mut feed = Feed::new();
        tell(&mut feed, "/limits", "{\"a\":1}");
        tell(&mut feed, "/belief", "{\"b\":2}");
        let mut viewed = feed.view();
        tell(&mut feed, "/belief", "{\"b\":3}");
        let past: Vec<&str> = viewed.past.iter().map(AsRef::as_ref).collect();
        assert_eq!(past, ["[\"/limits\",{\"a\":1}]", "[\"/belief\",{\"b\":2}]"]);
        let next = viewed.coming.try_recv().unwrap();
        assert_eq!(next.as_ref(), "[\"/belief\",{\"b\":3}]");
        assert_eq!(feed.viewers(), 1);
        drop(viewed);
        assert_eq!(feed.viewers(), 0);
    }

    #[test]
    fn who_is_too_slow_misses_the_oldest_and_delays_nobody() {
        let mut feed = Feed::new();
        let mut viewed = feed.view();
        for number in 0..BEHIND + 5 {
            tell(&mut feed, "/belief", &number.to_string());
        }
        let lag = viewed.coming.try_recv().unwrap_err();
        assert_eq!(lag, TryRecvError::Lagged(5));
        let next = viewed.coming.try_recv().unwrap();
        assert_eq!(next.as_ref(), "[\"/belief\",5]");
    }

    #[test]
    fn only_so_much_is_remembered_but_the_limits_always() {
        let mut feed = Feed::new();
        tell(&mut feed, "/limits", "0");
        let long = format!("\"{}\"", "x".repeat(REMEMBERED / 4));
        for _ in 0..6 {
            tell(&mut feed, "/belief", &long);
        }
        let past = feed.view().past;
        let bytes: usize = past.iter().map(|line| line.len()).sum();
        assert!(bytes < REMEMBERED + 100, "{bytes} bytes are remembered");
        assert_eq!(past[0].as_ref(), "[\"missed\",3]");
        assert_eq!(past[1].as_ref(), "[\"/limits\",0]");
        assert_eq!(past.len(), 5);
    }
}
