//! Files that are not as they should be, made on purpose.
#![allow(
    clippy::unwrap_used,
    reason = "a test may fail, and says with what it failed"
)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::root;

/// Turns all bits of one byte over.
pub fn flip(file: &Path, at: usize) {
    let mut bytes = fs::read(file).unwrap();
    bytes[at] = !bytes[at];
    fs::write(file, bytes).unwrap();
}

/// Writes other bytes over those that stand in a file once, as many as there are.
pub fn overwrite(file: &Path, old: &str, new: &str) {
    let mut bytes = fs::read(file).unwrap();
    assert_eq!(old.len(), new.len(), "{old} and {new} differ in length");
    let at: Vec<usize> = (0..=bytes.len() - old.len())
        .filter(|at| bytes[*at..].starts_with(old.as_bytes()))
        .collect();
    assert!(!at.is_empty(), "{}: there is no {old}", file.display());
    for at in at {
        bytes[at..at + new.len()].copy_from_slice(new.as_bytes());
    }
    fs::write(file, bytes).unwrap();
}

/// Takes the contract out of a policy file, as another trainer writes none.
pub fn without_contract(file: &Path) {
    /// `metadata_props` of ONNX's `ModelProto`.
    const METADATA: u64 = 14;
    let bytes = fs::read(file).unwrap();
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let begun = at;
        let tag = varint(&bytes, &mut at);
        let length = varint(&bytes, &mut at);
        // A field is a number, or so many bytes.
        if tag & 7 == 2 {
            at += length as usize;
        }
        if tag >> 3 != METADATA {
            kept.extend_from_slice(&bytes[begun..at]);
        }
    }
    fs::write(file, kept).unwrap();
}

fn varint(bytes: &[u8], at: &mut usize) -> u64 {
    let mut value = 0;
    for shift in (0..).step_by(7) {
        let byte = bytes[*at];
        *at += 1;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            break;
        }
    }
    value
}

/// Another program's MCAP file: whole, with one message of its own.
pub fn foreign_mcap(file: &Path) {
    let mut writer = mcap::Writer::new(fs::File::create(file).unwrap()).unwrap();
    let channel = writer
        .add_channel(0, "/camera", "json", &BTreeMap::new())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    writer.write_to_known_channel(&header, b"{}").unwrap();
    writer.finish().unwrap();
}

/// Compiles the observation model of `plugins/ramp.c`, broken as a macro says; false where there
/// is no C compiler.
pub fn ramp(library: &Path, fault: Option<&str>) -> bool {
    let mut command = Command::new("cc");
    command
        .args(["-shared", "-fPIC", "-I"])
        .arg(root().join("plugins/abi/include"));
    command.args(fault.map(|fault| format!("-D{fault}")));
    command.arg("-o").arg(library);
    let output = command
        .arg(root().join("tests/plugins/ramp.c"))
        .arg("-lm")
        .output();
    let Ok(output) = output else {
        return false;
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cc {}: {said}", library.display());
    true
}
