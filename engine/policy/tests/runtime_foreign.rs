//! A library that is not ONNX Runtime. Alone in its process, which may try one library only.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use pubs_policy::{Runtime, RuntimeError};

#[test]
fn another_library_is_refused_and_tract_is_still_there() {
    if !cfg!(target_os = "linux") {
        eprintln!("skipped: the name of a library that is always there is known for Linux alone");
        return;
    }
    let fault = Runtime::onnx_runtime(Path::new("libc.so.6")).unwrap_err();
    assert!(matches!(fault, RuntimeError::Foreign { .. }), "{fault}");
    assert!(
        fault.to_string().contains("libc.so.6: is not ONNX Runtime"),
        "{fault}"
    );
    assert_eq!(Runtime::tract().unwrap().to_string(), "tract");
}
