//! Libraries that are not ONNX Runtime, and a second choice. Alone in its process.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use pubs_policy::{Runtime, RuntimeError};

#[test]
fn wrong_libraries_are_named_and_the_choice_stands() {
    let directory = tempfile::tempdir().unwrap();
    let text = directory.path().join("libonnxruntime.so");
    std::fs::write(&text, "not a library").unwrap();

    let fault = Runtime::onnx_runtime(Path::new("/no/such/libonnxruntime.so")).unwrap_err();
    assert!(matches!(fault, RuntimeError::Missing { .. }), "{fault}");
    assert!(
        fault.to_string().contains("/no/such/libonnxruntime.so")
            && fault.to_string().contains("1.24"),
        "{fault}"
    );
    let fault = Runtime::onnx_runtime(directory.path()).unwrap_err();
    assert!(
        matches!(fault, RuntimeError::Missing { .. }),
        "a directory: {fault}"
    );
    let fault = Runtime::onnx_runtime(&text).unwrap_err();
    assert!(
        matches!(fault, RuntimeError::Load { .. }),
        "a text: {fault}"
    );
    assert!(
        fault.to_string().contains("1.24") && !fault.to_string().ends_with("dlopen failed"),
        "{fault}"
    );
    let fault = Runtime::onnx_runtime(&text).unwrap_err();
    assert!(
        matches!(fault, RuntimeError::FailedBefore { .. }),
        "a second library: {fault}"
    );

    assert_eq!(
        Runtime::tract().unwrap().to_string(),
        "tract",
        "after failures, another choice is free"
    );
    assert_eq!(
        Runtime::from_library(None).unwrap().to_string(),
        "tract",
        "the same choice again"
    );
    assert!(Runtime::tract().unwrap().version().contains("tract"));
    let fault = Runtime::onnx_runtime(&text).unwrap_err();
    assert!(
        matches!(fault, RuntimeError::AlreadyChosen { .. }),
        "{fault}"
    );
    assert!(
        fault.to_string().contains("tract") && fault.to_string().contains("libonnxruntime.so"),
        "{fault}"
    );
}
