//! A command that must end soon.
#![allow(
    clippy::unwrap_used,
    reason = "a test may fail, and says with what it failed"
)]

use std::fs::File;
use std::io::{Read, Seek};
use std::process::{Command, Output};
use std::thread;
use std::time::{Duration, Instant};

use crate::common::Answer;

/// A refusal comes at once; what takes longer is no refusal.
const PATIENCE: Duration = Duration::from_secs(30);

/// Runs a command that must end soon; its streams go to files, so that it never waits for a reader.
pub fn answer_in_time(line: &str, command: &mut Command) -> Answer {
    let (mut stdout, mut stderr) = (tempfile::tempfile().unwrap(), tempfile::tempfile().unwrap());
    let begun = Instant::now();
    let mut process = command
        .stdout(stdout.try_clone().unwrap())
        .stderr(stderr.try_clone().unwrap())
        .spawn()
        .unwrap();
    let status = loop {
        if let Some(status) = process.try_wait().unwrap() {
            break status;
        }
        if begun.elapsed() > PATIENCE {
            process.kill().unwrap();
            panic!("{line}: no end after {} s", PATIENCE.as_secs());
        }
        thread::sleep(Duration::from_millis(5));
    };
    let read = |file: &mut File| {
        let mut bytes = Vec::new();
        file.rewind().unwrap();
        file.read_to_end(&mut bytes).unwrap();
        bytes
    };
    let output = Output {
        status,
        stdout: read(&mut stdout),
        stderr: read(&mut stderr),
    };
    Answer::from_output(line.to_owned(), output)
}
