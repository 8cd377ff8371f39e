//! Real failures, in words, on standard error: each kind at most once a second.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use crate::system::monotonic_ns;

/// Between two lines of one kind, ns.
const PAUSE_NS: u64 = 1_000_000_000;

/// When each kind was last said, and how often it was swallowed since.
static SAID: Mutex<Option<HashMap<&'static str, (u64, u32)>>> = Mutex::new(None);

/// Says `text`, unless something of this kind was said less than a second ago.
pub fn say(kind: &'static str, text: &str) {
    if let Some(swallowed) = due(kind, monotonic_ns()) {
        let more = match swallowed {
            0 => String::new(),
            count => format!(" ({count} more like this)"),
        };
        eprintln!("melfa: {text}{more}");
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
