//! Recordings that another writer made, or that are none.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use pubs_run::recording::read;
use serde_json::{Value, json};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// A recording by hand: metadata, and messages (topic, time in ms, text).
fn made_up(file: &Path, metadata: Option<&[(&str, &str)]>, messages: &[(&str, u64, String)]) {
    let mut writer = mcap::WriteOptions::new()
        .compression(None)
        .create(std::io::BufWriter::new(fs::File::create(file).unwrap()))
        .unwrap();
    if let Some(fields) = metadata {
        let fields = fields
            .iter()
            .map(|&(key, text)| (key.to_owned(), text.to_owned()))
            .collect();
        let metadata = Metadata {
            name: "pubs-engine".to_owned(),
            metadata: fields,
        };
        writer.write_metadata(&metadata).unwrap();
    }
    for (topic, time_ms, text) in messages {
        let channel_id = writer
            .add_channel(0, topic, "json", &BTreeMap::new())
            .unwrap();
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: time_ms * 1_000_000,
            publish_time: 0,
        };
        writer
            .write_to_known_channel(&header, text.as_bytes())
            .unwrap();
    }
    writer.finish().unwrap();
}

const FIELDS: [(&str, &str); 8] = [
    ("format", "1"),
    ("engine", "0.1.0"),
    ("object", "drawer"),
    ("joint", "prismatic"),
    ("sensor", "virtual-arm"),
    ("actions", "stop, safe_open"),
    ("rate_hz", "100.0"),
    ("seed", "7"),
];

/// The three messages of a sound frame.
fn sound(time_ms: u64) -> [(&'static str, u64, Value); 3] {
    let xyz = json!({"x": 1.0, "y": 2, "z": 3.0});
    let pose = json!({"pose": {
        "position": xyz, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}
    }});
    let action = json!({
        "action": "safe_open", "demonstration": 1, "speed_m_s": 0.05, "settled": true, "status": "ready",
    });
    [
        ("/pose", time_ms, pose),
        ("/wrench", time_ms, json!({"force": xyz, "torque": xyz})),
        ("/action", time_ms, action),
    ]
}

#[test]
fn messages_of_another_writer_are_joined_by_their_time() {
    let folder = folder();
    let file = folder.path().join("foreign.mcap");
    let mut messages: Vec<_> = [10, 20, 30].into_iter().flat_map(sound).collect();
    // Topic by topic, integers where numbers are whole, a topic that nobody knows.
    messages.sort_by_key(|&(topic, _, _)| topic);
    messages.push(("/camera", 10, json!("no JSON of ours")));
    messages.push(("/truth", 20, json!({"joint_state": 1})));
    let messages: Vec<_> = messages
        .into_iter()
        .map(|(topic, time_ms, value)| (topic, time_ms, value.to_string()))
        .collect();
    made_up(&file, Some(&FIELDS), &messages);
    let recording = read(&file).unwrap();
    let times: Vec<u64> = recording
        .frames
        .iter()
        .map(|frame| frame.reading.time_ns)
        .collect();
    assert_eq!(times, [10_000_000, 20_000_000, 30_000_000]);
    let truths: Vec<_> = recording.frames.iter().map(|frame| frame.truth).collect();
    assert_eq!(truths, [None, Some(1.0), None]);
    assert_eq!(recording.frames[2].reading.force_n, [1.0, 2.0, 3.0]);
    assert_eq!(recording.loss, None);
    // Without the wrench at 20 ms there are two frames, and word of it.
    let lacking: Vec<_> = messages
        .into_iter()
        .filter(|(topic, time_ms, _)| (*topic, *time_ms) != ("/wrench", 20))
        .collect();
    made_up(&file, Some(&FIELDS), &lacking);
    let recording = read(&file).unwrap();
    assert_eq!(recording.frames.len(), 2);
    let loss = recording.loss.unwrap();
    assert!(loss.starts_with("1 frames are left out"), "{loss}");
}

#[test]
fn every_bad_value_is_named_by_topic_message_and_field() {
    let folder = folder();
    let file = folder.path().join("bad.mcap");
    let cases = [
        (
            "/wrench",
            "/force/x",
            json!(null),
            "force.x is null; expected a finite number",
        ),
        ("/wrench", "/torque", json!(5), "torque.x is missing"),
        (
            "/pose",
            "/pose/orientation/w",
            json!("NaN"),
            "pose.orientation.w is \"NaN\"",
        ),
        (
            "/pose",
            "/pose/position/z",
            json!(false),
            "pose.position.z is false",
        ),
        (
            "/action",
            "/action",
            json!("pull"),
            "action is \"pull\"; expected an action of the header: stop, safe_open",
        ),
        (
            "/action",
            "/demonstration",
            json!(-1),
            "demonstration is -1; expected a whole number from 0 on",
        ),
        (
            "/action",
            "/demonstration",
            json!(4_294_967_296_u64),
            "demonstration is 4294967296",
        ),
        (
            "/action",
            "/settled",
            json!(1),
            "settled is 1; expected true or false",
        ),
        (
            "/action",
            "/status",
            json!("happy"),
            "status is \"happy\"; expected ready, stopped or fault",
        ),
    ];
    for (topic, pointer, value, expected) in cases {
        let mut messages: Vec<_> = [10, 20, 30].into_iter().flat_map(sound).collect();
        let bad = messages
            .iter_mut()
            .find(|(name, time_ms, _)| *name == topic && *time_ms == 30)
            .unwrap();
        *bad.2.pointer_mut(pointer).unwrap() = value;
        let messages: Vec<_> = messages
            .into_iter()
            .map(|(topic, time_ms, value)| (topic, time_ms, value.to_string()))
            .collect();
        made_up(&file, Some(&FIELDS), &messages);
        let text = read(&file).unwrap_err().to_string();
        let place = format!("bad.mcap: {topic} message 3 (t = 0.02 s): {expected}");
        assert!(text.contains(&place), "`{text}` should say `{place}`");
    }
    let not_json = [("/pose", 0, "{".to_owned())];
    made_up(&file, Some(&FIELDS), &not_json);
    let text = read(&file).unwrap_err().to_string();
    assert!(
        text.contains("/pose message 1 (t = 0.00 s): the message is"),
        "{text}"
    );
}

#[test]
fn what_is_no_recording_is_refused_with_the_reason() {
    let folder = folder();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    fs::write(at("text"), "time_s,force_x_n\n").unwrap();
    fs::write(at("empty"), "").unwrap();
    made_up(&at("foreign"), None, &[]);
    let with = |key: &str, text: &'static str| {
        let mut fields = FIELDS.to_vec();
        fields.retain(|(known, _)| *known != key);
        if !text.is_empty() {
            let key = FIELDS.iter().find(|(known, _)| *known == key).unwrap().0;
            fields.push((key, text));
        }
        fields
    };
    made_up(&at("version"), Some(&with("format", "3")), &[]);
    made_up(&at("sensor"), Some(&with("sensor", "")), &[]);
    let pose_alone = [("/pose", 0, sound(0)[0].2.to_string())];
    made_up(&at("pose"), Some(&FIELDS), &pose_alone);
    let cases = [
        ("nowhere", "cannot be read: No such file"),
        ("text", "not an MCAP file"),
        ("empty", "before it says what was recorded"),
        ("foreign", "not a recording of this program"),
        ("version", "`format` is \"3\"; expected the version 1 or 2"),
        ("sensor", "`sensor` is missing"),
        ("pose", "there are no messages on /wrench"),
    ];
    for (name, expected) in cases {
        let text = read(&at(name)).unwrap_err().to_string();
        assert!(
            text.contains(expected),
            "{name}: `{text}` should say `{expected}`"
        );
        assert!(
            text.contains(&format!("/{name}: ")),
            "{name}: `{text}` names the file"
        );
    }
}
