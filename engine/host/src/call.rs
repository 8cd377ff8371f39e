//! One call across the line: error buffer out, status back.

use std::cell::Cell;
use std::ffi::c_char;

use pubs_plugin::Support;
use pubs_plugin::table::{STATUS_ABSENT, STATUS_ERROR, STATUS_OK, STATUS_PANIC};

const CAPACITY: usize = 1024;

thread_local! {
    /// One buffer per thread, so that a call neither allocates nor clears a kilobyte.
    static BUFFER: [Cell<u8>; CAPACITY] = const { [const { Cell::new(0) }; CAPACITY] };
}

/// What came of a call that did not do what it should.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// The plugin says so.
    #[error("{0}")]
    Error(String),
    /// The plugin broke down.
    #[error("the plugin broke down (a fault in its own code): {0}")]
    Panic(String),
    /// The plugin says that it does not provide what it must.
    #[error("the plugin answers \"absent\", but this must be provided")]
    Absent,
    /// A number that is no status.
    #[error(
        "the plugin returned status {0}, which is none of 0 (ok), 1 (absent), 2 (error), 3 (panic)"
    )]
    Status(i32),
    /// The plugin gave a value that it must not give, or was asked with arrays that do not match.
    #[error("{0}")]
    Value(String),
}

/// Calls `function(error, error_capacity)` and reads its status.
#[inline]
pub(crate) fn call(function: impl FnOnce(*mut c_char, usize) -> i32) -> Result<Support, Failure> {
    BUFFER.with(|buffer| {
        buffer[0].set(0);
        // A cell may be written through a shared reference; the pointer covers the whole array.
        let status = function(buffer.as_ptr().cast::<c_char>().cast_mut(), CAPACITY);
        match status {
            STATUS_OK => Ok(Support::Given),
            STATUS_ABSENT => Ok(Support::Absent),
            _ => Err(failure(status, buffer)),
        }
    })
}

/// As [`call`] where "absent" is no answer.
#[inline]
pub(crate) fn demand(function: impl FnOnce(*mut c_char, usize) -> i32) -> Result<(), Failure> {
    match call(function)? {
        Support::Given => Ok(()),
        Support::Absent => Err(Failure::Absent),
    }
}

#[cold]
fn failure(status: i32, buffer: &[Cell<u8>]) -> Failure {
    let text: Vec<u8> = buffer
        .iter()
        .map(Cell::get)
        .take_while(|byte| *byte != 0)
        .collect();
    let text = match String::from_utf8_lossy(&text).trim() {
        "" => "no reason given".to_owned(),
        text => text.to_owned(),
    };
    match status {
        STATUS_ERROR => Failure::Error(text),
        STATUS_PANIC => Failure::Panic(text),
        other => Failure::Status(other),
    }
}

/// `text[0 .. capacity)` that a plugin filled, up to its NUL.
pub(crate) fn filled_text(bytes: &[u8]) -> Result<String, String> {
    let Some(length) = bytes.iter().position(|byte| *byte == 0) else {
        return Err(format!(
            "a text is not closed with NUL within {} bytes",
            bytes.len()
        ));
    };
    let text = std::str::from_utf8(&bytes[..length]).map_err(|_| {
        format!(
            "a text is not UTF-8: `{}`",
            String::from_utf8_lossy(&bytes[..length])
        )
    })?;
    Ok(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plugin function that writes `text` without a NUL and returns `status`.
    fn answer(status: i32, text: &[u8]) -> Result<Support, Failure> {
        call(|error, capacity| {
            assert!(text.len() <= capacity);
            // SAFETY: the buffer has `capacity` bytes.
            unsafe { std::ptr::copy_nonoverlapping(text.as_ptr(), error.cast(), text.len()) };
            status
        })
    }

    #[test]
    fn a_status_and_its_text_become_a_result() {
        assert_eq!(answer(0, b""), Ok(Support::Given));
        assert_eq!(answer(1, b""), Ok(Support::Absent));
        assert_eq!(answer(2, b"bent\0"), Err(Failure::Error("bent".to_owned())));
        assert_eq!(
            answer(3, b"broken\0"),
            Err(Failure::Panic("broken".to_owned()))
        );
        assert_eq!(
            answer(2, b""),
            Err(Failure::Error("no reason given".to_owned()))
        );
        assert_eq!(answer(-7, b"x\0"), Err(Failure::Status(-7)));
        assert_eq!(demand(|_, _| 1), Err(Failure::Absent));
    }

    #[test]
    fn a_text_without_end_or_encoding_does_no_harm() {
        let endless = answer(2, &[b'a'; CAPACITY]);
        assert_eq!(endless, Err(Failure::Error("a".repeat(CAPACITY))));
        assert_eq!(
            answer(2, b"\xff\0"),
            Err(Failure::Error("\u{fffd}".to_owned()))
        );
        assert_eq!(filled_text(b"ab\0c"), Ok("ab".to_owned()));
        assert!(filled_text(b"abc").is_err() && filled_text(b"\xff\0").is_err());
    }
}
