//! What every exported function does: catch panics, report through the caller's buffer, and turn
//! raw arrays into slices.

use std::any::Any;
use std::ffi::{c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::de::DeserializeOwned;

use crate::table::{STATUS_ABSENT, STATUS_ERROR, STATUS_OK, STATUS_PANIC};
use crate::{PluginError, Support};

/// Where the caller wants the account of a failure.
#[derive(Clone, Copy)]
pub(crate) struct ErrorBuffer {
    pub(crate) text: *mut c_char,
    pub(crate) capacity: usize,
}

/// Runs `body`; its result, or its panic, becomes a status and an account in `buffer`.
///
/// # Safety
/// `buffer.text` is null or valid for writes of `buffer.capacity` bytes.
pub(crate) unsafe fn guarded(
    buffer: ErrorBuffer,
    body: impl FnOnce() -> Result<Support, PluginError>,
) -> i32 {
    let (status, message) = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(Support::Given)) => return STATUS_OK,
        Ok(Ok(Support::Absent)) => return STATUS_ABSENT,
        Ok(Err(error)) => (STATUS_ERROR, error.to_string()),
        Err(payload) => (STATUS_PANIC, panic_message(payload)),
    };
    // SAFETY: promised by the caller.
    unsafe { write_text(&message, buffer.text, buffer.capacity) };
    status
}

fn panic_message(payload: Box<dyn Any + Send>) -> String {
    if let Some(text) = payload.downcast_ref::<&str>() {
        return (*text).to_owned();
    }
    match payload.downcast::<String>() {
        Ok(text) => *text,
        Err(payload) => {
            // Its destructor is foreign code and could panic in turn, which would end the process.
            std::mem::forget(payload);
            "a panic without a message".to_owned()
        }
    }
}

/// Copies `text` and a closing NUL, cut at a character boundary where it is too long.
///
/// # Safety
/// `target` is null or valid for writes of `capacity` bytes.
pub(crate) unsafe fn write_text(text: &str, target: *mut c_char, capacity: usize) {
    if target.is_null() || capacity == 0 {
        return;
    }
    let length = text.floor_char_boundary(capacity - 1);
    // SAFETY: length + 1 <= capacity, and the regions cannot overlap: `text` is ours.
    unsafe {
        std::ptr::copy_nonoverlapping(text.as_ptr(), target.cast(), length);
        target.add(length).write(0);
    }
}

/// An input array.
///
/// # Safety
/// `data` is null or valid for reads of `length` values for the call.
pub(crate) unsafe fn input<'a, T>(
    data: *const T,
    length: usize,
    name: &str,
) -> Result<&'a [T], PluginError> {
    match (data.is_null(), length) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(PluginError::new(format!(
            "`{name}` is null, {length} values are wanted"
        ))),
        // SAFETY: not null, and valid as the caller promised.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(data, length) }),
    }
}

/// An output array.
///
/// # Safety
/// `data` is null or valid for reads and writes of `length` values for the call, and nobody else
/// uses it meanwhile.
pub(crate) unsafe fn output<'a, T>(
    data: *mut T,
    length: usize,
    name: &str,
) -> Result<&'a mut [T], PluginError> {
    match (data.is_null(), length) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(PluginError::new(format!(
            "`{name}` is null, {length} values are wanted"
        ))),
        // SAFETY: not null, and valid and unshared as the caller promised.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts_mut(data, length) }),
    }
}

/// Where one value goes.
///
/// # Safety
/// As [`output`] with length 1.
pub(crate) unsafe fn place<'a, T>(data: *mut T, name: &str) -> Result<&'a mut T, PluginError> {
    // SAFETY: promised by the caller.
    unsafe { data.as_mut() }.ok_or_else(|| PluginError::new(format!("`{name}` is null")))
}

/// Reads the setup that `create` or `open` gets.
///
/// # Safety
/// `data` is null or valid for reads of `length` bytes for the call.
pub(crate) unsafe fn parse_setup<S: DeserializeOwned>(
    data: *const u8,
    length: usize,
) -> Result<S, PluginError> {
    // SAFETY: promised by the caller.
    let json = unsafe { input(data, length, "setup") }?;
    serde_json::from_slice(json)
        .map_err(|error| PluginError::new(format!("the setup is not valid: {error}")))
}

/// Hands an instance to the caller.
///
/// # Safety
/// `target` is null or valid for a write.
pub(crate) unsafe fn hand_out<T>(
    instance: T,
    target: *mut *mut c_void,
) -> Result<Support, PluginError> {
    // SAFETY: promised by the caller.
    let target = unsafe { place(target, "instance") }?;
    *target = Box::into_raw(Box::new(instance)).cast();
    Ok(Support::Given)
}

/// Takes an instance back and drops it; null is no instance and is ignored.
///
/// # Safety
/// `instance` is null or came from [`hand_out`] with the same `T` and is not used again.
pub(crate) unsafe fn take_back<T>(instance: *mut c_void) -> Result<Support, PluginError> {
    if !instance.is_null() {
        // SAFETY: it is the box that `hand_out` made.
        drop(unsafe { Box::from_raw(instance.cast::<T>()) });
    }
    Ok(Support::Given)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::ffi::CStr;

    use super::*;

    fn run(capacity: usize, body: impl FnOnce() -> Result<Support, PluginError>) -> (i32, String) {
        let mut bytes = [0x7f as c_char; 64];
        // SAFETY: the buffer is at least as long as `capacity` in every case below.
        let status = unsafe {
            guarded(
                ErrorBuffer {
                    text: bytes.as_mut_ptr(),
                    capacity,
                },
                body,
            )
        };
        bytes[63] = 0;
        // SAFETY: closed with NUL just above.
        let text = unsafe { CStr::from_ptr(bytes.as_ptr()) };
        (status, text.to_str().unwrap().to_owned())
    }

    #[test]
    fn failures_become_a_status_and_a_text() {
        assert_eq!(
            run(64, || Err("no such spring".into())),
            (STATUS_ERROR, "no such spring".to_owned())
        );
        assert_eq!(
            run(64, || panic!("spring {} broke", 3)),
            (STATUS_PANIC, "spring 3 broke".to_owned())
        );
        assert_eq!(
            run(64, || panic!("plain")),
            (STATUS_PANIC, "plain".to_owned())
        );
        let unusual = run(64, || std::panic::panic_any(7_u8));
        assert_eq!(
            unusual,
            (STATUS_PANIC, "a panic without a message".to_owned())
        );
        assert_eq!(run(64, || Ok(Support::Given)).0, STATUS_OK);
        assert_eq!(run(64, || Ok(Support::Absent)).0, STATUS_ABSENT);
    }

    #[test]
    fn a_long_text_is_cut_between_characters() {
        // "a" is one byte, each "ö" two: 4 bytes hold "a", "ö" and the NUL, and nothing of the next.
        for (capacity, expected) in [
            (1, ""),
            (2, "a"),
            (3, "a"),
            (4, "aö"),
            (5, "aö"),
            (6, "aöö"),
        ] {
            assert_eq!(
                run(capacity, || Err("aöö".into())).1,
                expected,
                "capacity {capacity}"
            );
        }
        // SAFETY: null is allowed.
        let status = unsafe {
            guarded(
                ErrorBuffer {
                    text: std::ptr::null_mut(),
                    capacity: 9,
                },
                || Err("unheard".into()),
            )
        };
        assert_eq!(status, STATUS_ERROR);
    }
}
