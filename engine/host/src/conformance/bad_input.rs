//! What no engine should send must still come back as a status.

use std::ffi::{c_char, c_void};
use std::ptr::null_mut;

use pubs_plugin::table::{CreateFunction, PlainFunction, STATUS_ERROR, STATUS_PANIC};

use crate::call::{Failure, call};

const SETUPS: [(&str, &[u8]); 5] = [
    ("an empty text", b""),
    ("no JSON", b"not JSON \xff"),
    ("half a JSON", b"{\"joint\": {\"type\""),
    ("a list", b"[1, 2]"),
    ("an empty object", b"{}"),
];

/// Bytes of the small error buffer, and of the memory around it.
const SMALL: usize = 8;
const AROUND: usize = 64;
const UNTOUCHED: u8 = 0x55;

/// `create` or `open` with texts that are no setup, and with error buffers of all sizes.
pub(super) fn garbage_setups(create: CreateFunction, end: PlainFunction) -> Result<String, String> {
    for (name, json) in SETUPS {
        let mut instance: *mut c_void = null_mut();
        // SAFETY: a function of a checked table; the text is as long as said.
        let result = call(|error, capacity| unsafe {
            create(json.as_ptr(), json.len(), &mut instance, error, capacity)
        });
        finish(instance, end);
        if let Err(failure @ (Failure::Panic(_) | Failure::Status(_))) = result {
            return Err(format!(
                "{name} as setup: {failure}; expected an error with its reason"
            ));
        }
        small_buffer(create, end, name, json)?;
    }
    Ok(format!(
        "{} texts that are no setup, each answered by a status",
        SETUPS.len()
    ))
}

/// The error text must stay inside a small buffer, closed by a NUL; no buffer at all is allowed.
fn small_buffer(
    create: CreateFunction,
    end: PlainFunction,
    name: &str,
    json: &[u8],
) -> Result<(), String> {
    let mut bytes = [UNTOUCHED; AROUND];
    for (text, capacity) in [
        (bytes.as_mut_ptr().cast::<c_char>(), SMALL),
        (null_mut(), 0),
    ] {
        let mut instance: *mut c_void = null_mut();
        // SAFETY: as above; the buffer is longer than said.
        let status = unsafe { create(json.as_ptr(), json.len(), &mut instance, text, capacity) };
        finish(instance, end);
        let failed = status == STATUS_ERROR || status == STATUS_PANIC;
        if failed && !text.is_null() && !bytes[..SMALL].contains(&0) {
            return Err(format!(
                "{name} as setup: the error text is not closed with NUL within {SMALL} bytes"
            ));
        }
        if bytes[SMALL..].iter().any(|byte| *byte != UNTOUCHED) {
            return Err(format!(
                "{name} as setup: the error text is written beyond its {SMALL} bytes"
            ));
        }
    }
    Ok(())
}

fn finish(instance: *mut c_void, end: PlainFunction) {
    if !instance.is_null() {
        // SAFETY: just made, and not used again. Its own failure is not what is checked here.
        let _ = call(|error, capacity| unsafe { end(instance, error, capacity) });
    }
}
