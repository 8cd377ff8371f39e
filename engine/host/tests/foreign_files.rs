//! Files that are no plugins, or not all of one: refused in words, never a crash.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::path::{Path, PathBuf};

use common::compile_spring;
use pubs_host::{HostError, LibraryFault, library};

fn fault(path: &Path) -> LibraryFault {
    match library::load(path) {
        Err(HostError::Refused { fault, .. }) => fault,
        other => panic!("{}: {other:?}", path.display()),
    }
}

/// Every 64th length and all near an edge of the file's parts, as far as they are seen from here.
fn lengths(whole: usize) -> Vec<usize> {
    let mut lengths: Vec<usize> = (0..whole).step_by(64).collect();
    lengths.extend(1..80);
    lengths.extend(whole - 80..whole);
    lengths
}

#[test]
fn a_truncated_library_is_refused_at_every_length() {
    let directory = tempfile::tempdir().unwrap();
    let whole = std::fs::read(compile_spring(directory.path(), "whole.so", &[])).unwrap();
    let path = directory.path().join("cut.so");
    for length in lengths(whole.len()) {
        std::fs::write(&path, &whole[..length]).unwrap();
        let fault = fault(&path);
        assert!(
            matches!(fault, LibraryFault::File(_)),
            "{length} of {} bytes: {fault}",
            whole.len()
        );
        let says_so = length < 4
            || fault
                .to_string()
                .contains(&format!("the file has {length} bytes"));
        assert!(says_so, "{length}: {fault}");
    }
}

#[test]
fn a_text_a_foreign_library_and_nothing_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = directory.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let text = fault(&write("text.so", b"hello, this is no library")).to_string();
    assert!(
        text.contains("not a shared library") && text.contains("hello, this is"),
        "{text}"
    );
    let empty = fault(&write("empty.so", b"")).to_string();
    assert!(empty.contains("it is empty"), "{empty}");
    let missing = fault(&directory.path().join("missing.so"));
    assert!(matches!(missing, LibraryFault::Unreadable(_)), "{missing}");
    let folder = fault(directory.path());
    assert!(matches!(folder, LibraryFault::Unreadable(_)), "{folder}");
    let mut other_machine =
        std::fs::read(compile_spring(directory.path(), "spring.so", &[])).unwrap();
    other_machine[18] ^= 0xff;
    let text = fault(&write("other.so", &other_machine)).to_string();
    assert!(text.contains("built for another machine"), "{text}");
    let executable = std::env::current_exe().unwrap();
    let program = library::load(&executable);
    assert!(program.is_err(), "this test program is no plugin");
}

#[test]
fn a_library_of_the_system_is_not_a_plugin() {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let mut libraries: Vec<PathBuf> = maps
        .lines()
        .filter_map(|line| line.find('/').map(|at| PathBuf::from(&line[at..])))
        .collect();
    libraries.retain(|path| {
        path.file_name()
            .is_some_and(|name| name.to_string_lossy().contains(".so"))
    });
    libraries.dedup();
    for library in libraries {
        let fault = fault(&library);
        assert_eq!(fault, LibraryFault::NotAPlugin, "{}", library.display());
    }
}
