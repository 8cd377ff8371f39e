//! Recordings written, read back, cut off and damaged.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use pubs_plugin::{DriverStatus, JointType, Reading};
use pubs_run::LatenessReport;
use pubs_run::recording::{
    Done, FORMAT_VERSION, Frame, Header, Observation, Recording, RecordingError, RecordingWriter,
    read,
};
use serde_json::Value;

const OBJECT: &str = "schema = 1\nname = \"drawer\"\n";

/// SplitMix64, for numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }

    /// Any finite number at all.
    fn number(&mut self) -> f64 {
        loop {
            let number = f64::from_bits(self.bits());
            if number.is_finite() {
                return number;
            }
        }
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }
}

fn header() -> Header {
    Header {
        format: FORMAT_VERSION,
        engine: "0.1.0".to_owned(),
        object: "drawer".to_owned(),
        joint: JointType::Prismatic,
        sensor: "a sensor, with \"quotes\"".to_owned(),
        actions: ["stop", "safe_open", "safe_close", "high_open", "high_close"]
            .map(str::to_owned)
            .to_vec(),
        rate_hz: 100.0,
        seed: 12_345_678_901_234_567_890,
    }
}

/// `count` frames, 100 per second, of any finite numbers.
fn frames(count: usize) -> Vec<Frame> {
    let mut random = Random(1);
    let statuses = [
        DriverStatus::Ready,
        DriverStatus::Stopped,
        DriverStatus::Fault,
    ];
    (0..count)
        .map(|index| Frame {
            reading: Reading {
                time_ns: 987_654_321_000_000_001 + index as u64 * 10_000_000,
                position_m: random.numbers(),
                orientation_xyzw: random.numbers(),
                force_n: random.numbers(),
                torque_nm: random.numbers(),
                status: statuses[index % 3],
            },
            action: index % 5,
            demonstration: index as u32 % 7,
            speed_m_s: random.number(),
            settled: index % 2 == 0,
            truth: (index % 4 != 0).then(|| random.number()),
        })
        .collect()
}

fn write_frames(file: &Path, frames: &[Frame]) -> RecordingWriter {
    let mut writer = RecordingWriter::create(file, &header(), OBJECT).unwrap();
    for frame in frames {
        let observation = Observation {
            displacement: frame.speed_m_s,
            forces_n: frame.reading.force_n,
        };
        writer
            .frame(frame, frame.settled.then_some(&observation))
            .unwrap();
    }
    writer
}

/// A whole recording with something on every topic.
fn write_whole(file: &Path, frames: &[Frame]) -> Recording {
    let mut writer = write_frames(file, frames);
    let end_ns = frames.last().map_or(0, |frame| frame.reading.time_ns);
    let done = ["safe_open", "high_close"].map(|action| Done {
        action: action.to_owned(),
        demonstration: 3,
    });
    for done in &done {
        writer.done(end_ns, done).unwrap();
    }
    writer.guard(end_ns, "the tool left the path").unwrap();
    writer.timing(end_ns, &LatenessReport::default()).unwrap();
    writer.finish().unwrap();
    Recording {
        header: header(),
        frames: frames.to_vec(),
        done: done.to_vec(),
        loss: None,
    }
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn every_bit_survives_and_the_same_recording_is_the_same_file() {
    let folder = folder();
    let [first, second] = ["first.mcap", "second.mcap"].map(|name| folder.path().join(name));
    let mut frames = frames(1000);
    // A driver that gives its newest reading twice, and a clock that jumps back.
    frames[500].reading.time_ns = frames[499].reading.time_ns;
    frames[700].reading.time_ns = 5;
    let written = write_whole(&first, &frames);
    assert_eq!(read(&first).unwrap(), written);
    write_whole(&second, &frames);
    assert!(fs::read(&first).unwrap() == fs::read(&second).unwrap());
}

#[test]
fn other_readers_find_every_topic_with_a_schema_that_its_messages_keep() {
    let folder = folder();
    let file = folder.path().join("whole.mcap");
    write_whole(&file, &frames(50));
    let bytes = fs::read(&file).unwrap();
    let mut counts = BTreeMap::<String, usize>::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = &message.channel.topic;
        *counts.entry(topic.clone()).or_default() += 1;
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!(schema.encoding, "jsonschema", "{topic}");
        assert_eq!(message.channel.message_encoding, "json", "{topic}");
        let rules: Value = serde_json::from_slice(&schema.data).unwrap();
        assert_eq!(rules["title"], schema.name, "{topic}");
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        if let Err(error) = jsonschema::validate(&rules, &value) {
            panic!("{topic}: {error}: {value}");
        }
        assert_eq!(
            value.as_object().unwrap().len(),
            rules["properties"].as_object().unwrap().len(),
            "{topic}: every field is described"
        );
        let time = &value["timestamp"];
        let time_ns =
            time["sec"].as_u64().unwrap() * 1_000_000_000 + time["nsec"].as_u64().unwrap();
        assert_eq!(time_ns, message.log_time, "{topic}");
    }
    let expected = [
        ("/action", 50),
        ("/demonstration", 2),
        ("/guard", 1),
        ("/observation", 25),
        ("/pose", 50),
        ("/timing", 1),
        ("/truth", 37),
        ("/wrench", 50),
    ];
    assert_eq!(
        counts,
        expected
            .map(|(topic, count)| (topic.to_owned(), count))
            .into()
    );
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.metadata_indexes[0].name, "pubs-engine");
    let object = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!(object.name, "object.toml");
    assert_eq!(object.data, OBJECT.as_bytes());
}

#[test]
fn a_recording_is_never_overwritten() {
    let folder = folder();
    let file = folder.path().join("kept.mcap");
    fs::write(&file, "precious").unwrap();
    let error = RecordingWriter::create(&file, &header(), OBJECT)
        .err()
        .unwrap();
    assert_eq!(error, RecordingError::Exists { file: file.clone() });
    assert!(error.to_string().contains("kept.mcap"), "{error}");
    assert_eq!(fs::read(&file).unwrap(), b"precious");
    let nowhere = folder.path().join("no/folder.mcap");
    let error = RecordingWriter::create(&nowhere, &header(), OBJECT)
        .err()
        .unwrap();
    let text = error.to_string();
    assert!(
        text.contains("no/folder.mcap") && text.contains("No such file"),
        "{text}"
    );
}

/// Where in the file the object file's text is attached, behind the header.
fn attachment(bytes: &[u8]) -> usize {
    bytes
        .windows(OBJECT.len())
        .position(|window| window == OBJECT.as_bytes())
        .unwrap()
}

/// Where in the file each frame is complete: at the end of its last message.
fn ends_of_frames(bytes: &[u8]) -> Vec<usize> {
    let mark = b"\"status\":\"";
    bytes
        .windows(mark.len())
        .enumerate()
        .filter(|(_, window)| *window == mark)
        .map(|(start, _)| {
            let rest = &bytes[start..];
            start + rest.iter().position(|&byte| byte == b'}').unwrap() + 1
        })
        .collect()
}

#[test]
fn a_file_that_is_cut_anywhere_gives_every_frame_before_the_cut() {
    let folder = folder();
    let file = folder.path().join("whole.mcap");
    let whole = write_whole(&file, &frames(400));
    let bytes = fs::read(&file).unwrap();
    let ends = ends_of_frames(&bytes);
    assert_eq!(ends.len(), 400);
    let mut random = Random(50);
    let mut cuts: Vec<usize> = (0..50).map(|_| random.below(bytes.len())).collect();
    cuts.extend(0..200);
    // After and in the middle of a frame; and all through the end of the file.
    cuts.extend([ends[0], ends[99], ends[100] + 3, ends[399]]);
    cuts.extend(bytes.len() - 60..=bytes.len());
    let cut_file = folder.path().join("cut.mcap");
    let mut headless = 0;
    for cut in cuts {
        fs::write(&cut_file, &bytes[..cut]).unwrap();
        let recording = match read(&cut_file) {
            Ok(recording) => recording,
            Err(error) => {
                headless += 1;
                let expected = RecordingError::Headless {
                    file: cut_file.clone(),
                };
                assert_eq!(error, expected, "cut at {cut}");
                assert!(cut < attachment(&bytes), "cut at {cut}, behind the header");
                continue;
            }
        };
        let complete = ends.iter().filter(|&&end| end <= cut).count();
        assert_eq!(recording.frames.len(), complete, "cut at {cut}");
        assert!(recording.frames == whole.frames[..complete], "cut at {cut}");
        assert_eq!(recording.header, whole.header, "cut at {cut}");
        if recording.loss.is_none() {
            assert_eq!(recording, whole, "cut at {cut}, and no word of it");
        }
    }
    assert!(headless >= 60, "the first bytes hold no header");
}

#[test]
fn what_is_lost_is_said_in_words() {
    let folder = folder();
    let file = folder.path().join("whole.mcap");
    write_whole(&file, &frames(400));
    let bytes = fs::read(&file).unwrap();
    let ends = ends_of_frames(&bytes);
    let mut zeroed = bytes[..ends[298]].to_vec();
    zeroed[ends[200]..].fill(0);
    let last_chunk = |bytes: &[u8]| {
        let data_end = bytes
            .windows(9)
            .rposition(|window| window == [0x0f, 4, 0, 0, 0, 0, 0, 0, 0]);
        data_end.unwrap()
    };
    let damaged = {
        let mut damaged = bytes.clone();
        damaged[ends[150]] ^= 1;
        damaged[ends[350]] ^= 1;
        damaged
    };
    let cases: [(&str, &[u8], usize, &str); 5] = [
        (
            "in a chunk",
            &bytes[..ends[122] + 5],
            123,
            "the file ends in the middle of a chunk after 1.2 s (123 frames); what came after is lost",
        ),
        (
            "in the attachment",
            &bytes[..attachment(&bytes) + 5],
            0,
            "the file ends in the middle of a record before the first frame; what came after is lost",
        ),
        (
            "before the end mark",
            &bytes[..last_chunk(&bytes)],
            400,
            "the recording was never finished, as when the program is killed: it ends after 4.0 s (400 frames); up to a second after that is lost",
        ),
        (
            "two damaged chunks",
            &damaged,
            200,
            "2 chunks are damaged and left out (from 1.00 s to 1.99 s, from 3.00 s to 3.99 s)",
        ),
        (
            "a chunk without its end, filled with zeros",
            &zeroed,
            201,
            "the file ends in the middle of a chunk after 2.0 s (201 frames); what came after is lost",
        ),
    ];
    for (name, bytes, frames, expected) in cases {
        let cut_file = folder.path().join("cut.mcap");
        fs::write(&cut_file, bytes).unwrap();
        let recording = read(&cut_file).unwrap();
        assert_eq!(recording.loss.as_deref(), Some(expected), "{name}");
        assert_eq!(recording.frames.len(), frames, "{name}");
    }
}

#[test]
fn a_killed_program_loses_no_more_than_a_second() {
    let folder = folder();
    for count in [1, 99, 100, 101, 250, 399, 400] {
        let file = folder.path().join(format!("{count}.mcap"));
        let frames = frames(count);
        // What the writer still holds never reaches the file, as when the process is gone.
        std::mem::forget(write_frames(&file, &frames));
        let recording = read(&file).unwrap();
        assert!(
            recording.frames.len() + 100 >= count,
            "{} of {count} frames",
            recording.frames.len()
        );
        assert!(
            recording.frames == frames[..recording.frames.len()],
            "{count}"
        );
        assert!(
            recording.loss.unwrap().contains("never finished"),
            "{count}"
        );
    }
}

#[test]
fn a_flipped_bit_never_passes_for_data_and_never_panics() {
    let folder = folder();
    let file = folder.path().join("whole.mcap");
    let whole = write_whole(&file, &frames(300));
    let bytes = fs::read(&file).unwrap();
    let mut random = Random(3);
    let flipped_file = folder.path().join("flipped.mcap");
    // Metadata and attachment are not behind a chunk's checksum.
    let first_chunk = attachment(&bytes) + OBJECT.len() + 4;
    for _ in 0..300 {
        let mut flipped = bytes.clone();
        let position = random.below(bytes.len());
        flipped[position] ^= 1 << random.below(8);
        fs::write(&flipped_file, &flipped).unwrap();
        let Ok(recording) = read(&flipped_file) else {
            continue;
        };
        let kept = recording
            .frames
            .iter()
            .all(|frame| whole.frames.contains(frame));
        assert!(kept, "bit at {position}");
        if recording.loss.is_none() && position >= first_chunk {
            assert_eq!(recording, whole, "bit at {position}");
        }
    }
}

#[test]
fn a_value_that_is_not_finite_is_written_but_not_read() {
    let folder = folder();
    let file = folder.path().join("nan.mcap");
    let mut frames = frames(3);
    frames[1].reading.force_n[2] = f64::NAN;
    write_frames(&file, &frames).finish().unwrap();
    let text = read(&file).unwrap_err().to_string();
    assert!(
        text.contains("/wrench message 2 (t = 0.01 s): force.z is null"),
        "{text}"
    );
}
