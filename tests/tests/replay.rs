//! Recordings of runs, whole, cut off, killed and tampered with, and `pubs-engine replay` of them.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::OnceLock;
use std::time::Duration;

use common::{Answer, all, command, door2, door2_policy, forgive, path_text, pubs, words};
use serde_json::Value;
use tempfile::TempDir;

/// `run` of door2 with the shipped policy.
fn run(folder: &Path, line: &str) -> Answer {
    let (object, policy) = (door2(), door2_policy());
    let mut arguments = vec!["run", &object, "--policy", &policy, "--json"];
    arguments.extend(words(line));
    pubs(folder, &arguments)
}

fn replay(folder: &Path, file: &str) -> Answer {
    pubs(folder, &["replay", file, "--json"])
}

/// The recording of one lockstep run, made once.
fn recorded() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        run(
            folder.path(),
            "--goal 0.5 --goal 0.3 --lockstep --seed 7 --record once.mcap",
        )
        .assert_code(0);
        fs::read(folder.path().join("once.mcap")).unwrap()
    })
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The whole number that follows the last whole occurrence of `mark`.
fn last_number(bytes: &[u8], mark: &str) -> u64 {
    let number = |at: &usize| {
        let rest = &bytes[at + mark.len()..];
        let length = rest.iter().position(|byte| !byte.is_ascii_digit())?;
        std::str::from_utf8(&rest[..length]).ok()?.parse().ok()
    };
    all(bytes, mark).iter().rev().find_map(number).unwrap_or(0)
}

#[test]
fn a_lockstep_run_is_recorded_and_replayed_byte_for_byte() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let line = "--goal 0.5 --lockstep --seed 1 --record";
    for name in ["first.mcap", "second.mcap"] {
        let report = run(folder.path(), &format!("{line} {name}"))
            .assert_code(0)
            .json();
        assert_eq!(report["recording"], name);
        assert_eq!(report["recording_dropped"], 0);
    }
    let first = fs::read(at("first.mcap")).unwrap();
    assert!(first == fs::read(at("second.mcap")).unwrap());
    let report = replay(folder.path(), "first.mcap").assert_code(0).json();
    assert_eq!(report["same"], true, "{report}");
    let ticks = last_number(&first, "\"tick\":");
    assert!(ticks > 100, "only {ticks} ticks");
    for name in ["observations", "beliefs", "actions"] {
        assert_eq!(report[name]["differ"], 0, "{name}: {report}");
        assert!(report[name]["compared"].as_u64().unwrap() > 10, "{report}");
    }
    assert_eq!(report["observations"]["compared"], ticks);
    // The replay needs neither the object file's overrides nor the environment of the run.
    let line = "--goal 0.5 --lockstep --set control.acceleration_m_s2=0.8 --record set.mcap";
    run(folder.path(), line).assert_code(0);
    let mut again = command(folder.path(), &["replay", "set.mcap"]);
    Answer::of(again.env("PUBS_SET__BELIEF__PARTICLES", "77")).assert_code(0);
}

#[test]
fn recordings_lie_beside_the_objects_and_are_never_overwritten() {
    let folder = folder();
    let objects = folder.path().join("objects");
    fs::create_dir(&objects).unwrap();
    let object = path_text(&objects.join("door2.toml"));
    fs::copy(door2(), &object).unwrap();
    let policy = door2_policy();
    let line = "--goal 0.5 --lockstep --json";
    let mut arguments = vec!["run", &object, "--policy", &policy];
    arguments.extend(words(line));
    let work = tempfile::tempdir().unwrap();
    let answers = [(); 2].map(|()| pubs(work.path(), &arguments).assert_code(0).json());
    let files = answers.map(|answer| PathBuf::from(answer["recording"].as_str().unwrap()));
    assert_ne!(files[0], files[1]);
    for file in &files {
        let recordings = folder.path().canonicalize().unwrap().join("recordings");
        assert_eq!(file.parent().unwrap(), recordings);
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(name.starts_with("door2-2"), "{name}");
    }
    let named = path_text(&files[0]);
    arguments.extend(["--record", &named]);
    pubs(work.path(), &arguments)
        .assert_code(2)
        .assert_says(&["never overwritten", "--no-record"]);
    arguments.truncate(arguments.len() - 2);
    arguments.push("--no-record");
    let report = pubs(work.path(), &arguments).assert_code(0).json();
    assert_eq!(report["recording"], Value::Null);
    assert_eq!(work.path().read_dir().unwrap().count(), 0);
}

#[test]
fn a_changed_value_is_found_where_it_is() {
    let folder = folder();
    // Topic, a mark in one of its messages, which occurrence, the field that differs.
    let cases = [
        ("/belief", "\"mean\":0.", 20, "mean"),
        ("/belief", "\"entropy\":0.", 30, "entropy"),
        ("/observation", "\"f_d\":", 50, "f_d"),
        ("/observation", "\"force\":{\"x\":", 40, "f_"),
    ];
    for (topic, mark, occurrence, field) in cases {
        let mut bytes = recorded().to_vec();
        let start = all(&bytes, mark)[occurrence] + mark.len();
        // The third digit, wherever the point is: far beyond the last bits.
        let digit = (start..)
            .filter(|&at| bytes[at].is_ascii_digit())
            .nth(2)
            .unwrap();
        bytes[digit] = if bytes[digit] == b'9' {
            b'8'
        } else {
            bytes[digit] + 1
        };
        forgive(&mut bytes, digit);
        fs::write(folder.path().join("changed.mcap"), &bytes).unwrap();
        let report = replay(folder.path(), "changed.mcap").assert_code(3).json();
        let first = &report["first"];
        assert_eq!(first["topic"], topic, "{mark}: {report}");
        let found = first["field"].as_str().unwrap();
        assert!(found.starts_with(field), "{mark}: {report}");
        assert_ne!(first["recorded"], first["replayed"], "{mark}: {report}");
        if mark.starts_with("\"mean") || mark.starts_with("\"entropy") {
            // One recorded belief was changed, and no other differs.
            assert_eq!(report["beliefs"]["differ"], 1, "{mark}: {report}");
            let line = [
                "replay",
                "changed.mcap",
                "--tolerance-state",
                "9",
                "--tolerance-entropy",
                "1",
            ];
            pubs(folder.path(), &line).assert_code(0);
        }
    }
}

#[test]
fn a_recording_that_is_cut_anywhere_opens_or_says_why() {
    let folder = folder();
    let bytes = recorded();
    let mut state = 6_u64;
    let (mut opened, mut whole, mut most_lost) = (0, 0, 0);
    for _ in 0..50 {
        // Knuth's multiplier; the high bits are random enough for a place.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let cut = (state >> 33) as usize % bytes.len();
        fs::write(folder.path().join("cut.mcap"), &bytes[..cut]).unwrap();
        let answer = replay(folder.path(), "cut.mcap");
        if answer.code == 2 {
            answer.assert_says(&["cut.mcap: ", "again"]);
            continue;
        }
        opened += 1;
        let end_mark = *all(bytes, "\u{f}\u{4}\0\0\0\0\0\0\0").last().unwrap();
        if answer.code == 0 && cut > end_mark {
            // Only what helps readers to seek is cut off.
            whole += 1;
            continue;
        }
        let report = answer.assert_code(3).json();
        assert_eq!(report["first"], Value::Null, "cut at {cut}: {report}");
        let missing = report["missing"].to_string();
        assert!(missing.contains("lost"), "cut at {cut}: {missing}");
        let written = last_number(&bytes[..cut], "\"tick\":");
        let read = report["observations"]["compared"].as_u64().unwrap();
        most_lost = most_lost.max(written.saturating_sub(read));
    }
    println!(
        "cut at 50 random bytes of {}: {opened} open ({whole} of them lack no data), the others end before their header and say so; at most {} ms before the cut are lost",
        bytes.len(),
        10 * most_lost
    );
    assert!(opened >= 25, "only {opened} of 50 open");
    assert!(most_lost <= 100, "{most_lost} ticks lost");
}

fn monotonic_ns() -> u64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the pointer is to a valid timespec that outlives the call.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

#[test]
fn a_killed_run_loses_at_most_a_second() {
    let folder = folder();
    let file = folder.path().join("killed.mcap");
    let (object, policy) = (door2(), door2_policy());
    let line = "--goal 0.9 --goal 0.1 --goal 0.9 --goal 0.1 --record killed.mcap";
    let mut arguments = vec!["run", &object, "--policy", &policy];
    arguments.extend(words(line));
    let mut child = command(folder.path(), &arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // Until two seconds of it are on the disk.
    for _ in 0..400 {
        std::thread::sleep(Duration::from_millis(50));
        let bytes = fs::read(&file).unwrap_or_default();
        if last_number(&bytes, "\"tick\":") > 200 {
            break;
        }
    }
    // Between two writes.
    std::thread::sleep(Duration::from_millis(350));
    child.kill().unwrap();
    let killed_ns = monotonic_ns();
    child.wait().unwrap();
    let bytes = fs::read(&file).unwrap();
    let mark = "\"stopping\":";
    let last = &bytes[..*all(&bytes, mark).last().unwrap()];
    // Of the last /controller message: its own time stands before that of its order.
    let message = &last[all(last, "{\"timestamp\":").last().copied().unwrap()..];
    let seconds = &message[..message.iter().position(|&byte| byte == b'}').unwrap()];
    let last_ns = last_number(&[seconds, b","].concat(), "\"sec\":") * 1_000_000_000
        + last_number(&[seconds, b","].concat(), "\"nsec\":");
    let lost_ms = killed_ns.saturating_sub(last_ns) / 1_000_000;
    println!("killed: the last {lost_ms} ms are lost");
    assert!(lost_ms <= 1000, "{lost_ms} ms are lost");
    let answer = replay(folder.path(), "killed.mcap");
    let report = answer.assert_code(3).json();
    assert_eq!(report["first"], Value::Null, "{report}");
    assert!(
        report["observations"]["compared"].as_u64().unwrap() >= 200,
        "{report}"
    );
    answer.assert_says(&["lost"]);
}

#[test]
fn a_real_time_run_replays_exactly() {
    let folder = folder();
    let report = run(folder.path(), "--goal 0.5 --record live.mcap").json();
    assert_eq!(report["recording"], "live.mcap");
    let answer = replay(folder.path(), "live.mcap");
    let replayed = answer.json();
    assert_eq!(replayed["first"], Value::Null, "{replayed}");
    for (name, least) in [("observations", 100), ("beliefs", 30), ("actions", 10)] {
        let compared = replayed[name]["compared"].as_u64().unwrap();
        assert!(compared >= least, "{name}: {compared}: {replayed}");
    }
    let lost = report["recording_dropped"].as_u64().unwrap() > 0;
    answer.assert_code(if lost { 3 } else { 0 });
}

#[test]
fn another_format_is_refused_with_the_cure() {
    let folder = folder();
    let mark = "format\u{1}\0\0\0";
    let cases = [
        (b'1', "make the run again with this version"),
        (
            b'3',
            "read it with the version of the program that wrote it",
        ),
    ];
    for (format, cure) in cases {
        let mut bytes = recorded().to_vec();
        let at = all(&bytes, mark)[0] + mark.len();
        assert_eq!(bytes[at], b'2', "the format of runs");
        bytes[at] = format;
        fs::write(folder.path().join("other.mcap"), &bytes).unwrap();
        replay(folder.path(), "other.mcap")
            .assert_code(2)
            .assert_says(&["other.mcap", cure]);
    }
}

#[test]
fn a_recording_whose_parts_do_not_belong_together_is_refused() {
    let folder = folder();
    // What is known of the run lies outside the chunks and their checksums.
    let cases = [
        (",0],[", ",7],[", "a goal asks for policy 7 of 1"),
        (
            "stop, safe_open, safe_close, high_open",
            "stop, high_open, safe_close, safe_open",
            "the recording names the actions",
        ),
    ];
    for (there, instead, words) in cases {
        let mut bytes = recorded().to_vec();
        let at = all(&bytes, there)[0];
        bytes[at..at + there.len()].copy_from_slice(instead.as_bytes());
        fs::write(folder.path().join("apart.mcap"), &bytes).unwrap();
        replay(folder.path(), "apart.mcap")
            .assert_code(2)
            .assert_says(&[words]);
    }
}
