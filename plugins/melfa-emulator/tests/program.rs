//! The program itself: one line when ready, and an end on a signal.

#![allow(clippy::unwrap_used)]

mod client;

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use client::{PATIENCE, R3};

fn command(words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_melfa-emulator"));
    command
        .args(["--r3-port", "0", "--mxt-port", "0", "--monitor-port", "0"])
        .args(words)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

#[test]
fn ready_line_has_the_ports_and_sigterm_ends_it_well() {
    let mut child = command(&["--world", "door1", "--start", "0.1"])
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let ports: serde_json::Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    let port = |name: &str| u16::try_from(ports[name].as_u64().unwrap()).unwrap();
    assert!(
        port("mxt") > 0 && port("monitor") > 0 && port("control") > 0,
        "{ports}"
    );
    let answer = R3::connect(port("r3")).ask("1;1;DSTATE\r");
    assert_eq!(answer, "QoK81120;1;0\r");
    let status = Command::new("kill").arg(child.id().to_string()).status();
    assert!(status.unwrap().success());
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(begun.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(10));
    };
    assert!(status.success(), "{status}");
    assert!(lines.next().is_none(), "one line only");
}

#[test]
fn faulty_options_end_it_with_a_reason() {
    for (words, reason) in [
        (&["--world", "nowhere"][..], "nowhere"),
        (&["--start", "1.5"], "from 0 to 1"),
        (&["--cycle-ms", "nan"], "from 1 to 100"),
        (&["--mount", "0,0,5,0"], "--mount"),
        (&["--scenario", "/nonexistent.toml"], "/nonexistent.toml"),
        (&["--run"], "--program"),
        (&["--sensor-axes", "x,x,z"], "x,x,z"),
    ] {
        let mut child = command(words).spawn().unwrap();
        let mut text = String::new();
        child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut text)
            .unwrap();
        let status = child.wait().unwrap();
        assert!(!status.success(), "{words:?} was taken");
        assert!(text.contains(reason), "{words:?}: {text}");
    }
}
