//! Where one request of R3 ends and the next begins.
//!
//! Clients end requests with CR, LF, NUL or nothing. A request without an end is taken as whole
//! once nothing has followed it for a moment, if it is a known command by then; a client that
//! joins several of them is understood too, as each begins with its robot and slot.

use std::time::{Duration, Instant};

use crate::command;

/// After this silence a known command counts as whole.
const PAUSE: Duration = Duration::from_millis(12);

/// After this silence anything does.
const LONG_PAUSE: Duration = Duration::from_millis(1000);

/// So much without an end is whole at once: no request is as long.
const LONGEST: usize = 4096;

/// A request and how it ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Framed {
    /// Its text.
    pub text: String,
    /// The byte at its end.
    pub end: Option<u8>,
}

/// What has come over a connection.
#[derive(Debug, Default)]
pub struct Framing {
    bytes: Vec<u8>,
    newest: Option<Instant>,
}

impl Framing {
    /// Takes in what has come.
    pub fn push(&mut self, bytes: &[u8], now: Instant) {
        self.bytes.extend_from_slice(bytes);
        self.newest = Some(now);
    }

    /// Whether something has come that is not yet told.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The next whole request.
    pub fn next(&mut self, now: Instant) -> Option<Framed> {
        while let Some(at) = self.bytes.iter().position(|byte| is_end(*byte)) {
            let text = self.take(at);
            let end = self.bytes.remove(0);
            if !text.trim().is_empty() {
                return Some(Framed {
                    text,
                    end: Some(end),
                });
            }
        }
        let silence = now.saturating_duration_since(self.newest?);
        if self.bytes.is_empty() || silence < PAUSE && self.bytes.len() < LONGEST {
            return None;
        }
        let text = String::from_utf8_lossy(&self.bytes).into_owned();
        let first = first_of_joined(&text);
        let whole = first < text.len() || command::is_known(&text);
        if !whole && silence < LONG_PAUSE && text.len() < LONGEST {
            return None;
        }
        let text = self.take(first);
        Some(Framed { text, end: None })
    }

    fn take(&mut self, length: usize) -> String {
        let taken: Vec<u8> = self.bytes.drain(..length.min(self.bytes.len())).collect();
        String::from_utf8_lossy(&taken).into_owned()
    }
}

fn is_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n' | 0)
}

/// Length of the first request where another follows without an end between them.
fn first_of_joined(text: &str) -> usize {
    let next = (1..text.len())
        .filter(|at| text.is_char_boundary(*at))
        .find(|at| command::begins(&text[*at..]) && command::is_known(&text[..*at]));
    next.unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces at times (ms), and the requests with the times at which they are whole.
    fn framed(pieces: &[(u64, &str)]) -> Vec<(u64, String)> {
        let start = Instant::now();
        let mut framing = Framing::default();
        let mut found = vec![];
        for ms in 0..1500 {
            let now = start + Duration::from_millis(ms);
            for (_, piece) in pieces.iter().filter(|(at, _)| *at == ms) {
                framing.push(piece.as_bytes(), now);
            }
            while let Some(request) = framing.next(now) {
                found.push((ms, request.text));
            }
        }
        found
    }

    /// Texts at times, ms.
    type Timed<'a> = &'a [(u64, &'a str)];

    #[test]
    fn requests_are_whole_at_their_end_or_after_a_pause() {
        let cases: [(Timed, Timed); 9] = [
            (&[(0, "1;1;DSTATE\r")], &[(0, "1;1;DSTATE")]),
            (&[(0, "1;1;DSTATE\r\n")], &[(0, "1;1;DSTATE")]),
            (&[(0, "1;1;DSTATE\0")], &[(0, "1;1;DSTATE")]),
            (&[(0, "1;1;DSTATE")], &[(12, "1;1;DSTATE")]),
            (&[(0, "1;1;DS"), (50, "TATE")], &[(62, "1;1;DSTATE")]),
            (&[(0, "1;1;OPEN=NA"), (5, "ME\n")], &[(5, "1;1;OPEN=NAME")]),
            (
                &[(0, "1;1;CNTLON\r1;1;SRVON\r")],
                &[(0, "1;1;CNTLON"), (0, "1;1;SRVON")],
            ),
            (
                &[(0, "1;1;RUNP1;11;1;DSTATE")],
                &[(12, "1;1;RUNP1;1"), (12, "1;1;DSTATE")],
            ),
            (&[(0, "hello")], &[(1000, "hello")]),
        ];
        for (pieces, wanted) in cases {
            let found = framed(pieces);
            let found: Vec<_> = found
                .iter()
                .map(|(ms, text)| (*ms, text.as_str()))
                .collect();
            assert_eq!(found, wanted, "{pieces:?}");
        }
    }

    #[test]
    fn end_is_told() {
        let now = Instant::now();
        let mut framing = Framing::default();
        framing.push(b"1;1;STATE\0", now);
        assert_eq!(framing.next(now).and_then(|request| request.end), Some(0));
        assert!(framing.is_empty());
    }
}
