//! Editing an object file keeps every byte that is not a segment.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use pubs_calibrate::object_text::{HEADING, StateUnit, segments_of, with_segments, with_source};
use pubs_calibrate::{Channel, Segment, Values};

fn segment(from: f64, to: f64, probability: f64) -> Segment {
    Segment {
        action: "safe_open".to_owned(),
        channel: Channel::Moves,
        from,
        to,
        values: Values::Moves { probability },
        note: None,
    }
}

fn table(from: &str, to: &str, probability: &str) -> String {
    format!(
        "[[observation.segment]]\naction = \"safe_open\"\nchannel = \"m_p\"\nfrom_m = {from}\nto_m = {to}\nprobability = {probability}\n"
    )
}

fn edited(text: &str) -> String {
    let segments = [segment(0.0, 0.1, 0.98), segment(0.1, 0.25, 0.02)];
    with_segments(
        text,
        StateUnit::Metres,
        &segments,
        &["made in a test.".to_owned()],
    )
    .unwrap()
}

fn new_tables() -> String {
    format!(
        "{HEADING}.\n# made in a test.\n\n{}\n{}",
        table("0.0", "0.1", "0.98"),
        table("0.1", "0.25", "0.02")
    )
}

#[test]
fn what_is_no_segment_stays_as_it_was() {
    let old = format!(
        "{}\n# between two\n{}",
        table("0.0", "0.2", "1.0"),
        table("0.2", "0.25", "0.5")
    );
    let new = new_tables();
    // (name, before, after)
    let cases = [
        (
            "segments at the end, no final newline",
            format!(
                "a = 1 # one\n\n[observation]\nmodel = \"segments\"\n\n{}",
                old.trim_end()
            ),
            format!("a = 1 # one\n\n[observation]\nmodel = \"segments\"\n\n{new}"),
        ),
        (
            "a table and comments after them",
            format!(
                "[observation]\nx = 1\n\n# mine, kept\n\n{old}# the end of it\n\n# the driver\n[driver]\nplugin = \"p\"\n"
            ),
            format!(
                "[observation]\nx = 1\n\n# mine, kept\n\n{new}# the end of it\n\n# the driver\n[driver]\nplugin = \"p\"\n"
            ),
        ),
        (
            "our own heading is replaced, not piled up",
            format!(
                "[observation]\nx = 1\n\n# mine\n{HEADING} long ago.\n# from somewhere\n\n{old}"
            ),
            format!("[observation]\nx = 1\n\n# mine\n{new}"),
        ),
        (
            "no segments yet, a table follows",
            "[observation]\nx = 1 # why\n\n[driver]\ny = 2\n".to_owned(),
            format!("[observation]\nx = 1 # why\n\n{new}\n\n[driver]\ny = 2\n"),
        ),
        (
            "no observation table at all",
            "a = 1".to_owned(),
            format!("a = 1\n\n{new}"),
        ),
        (
            "a list in place of tables",
            "[observation]\nx = 1\nsegment = [\n  { action = \"safe_open\" },\n]\n# last words\n"
                .to_owned(),
            format!("[observation]\nx = 1\n\n{new}\n# last words\n"),
        ),
        (
            "segments apart from each other",
            format!(
                "[observation]\n\n{}\n[driver]\ny = 2\n\n{}\n[reward]\nz = 3\n",
                table("0.0", "0.1", "1.0"),
                table("0.1", "0.25", "1.0")
            ),
            format!("[observation]\n\n{new}\n[driver]\ny = 2\n\n\n[reward]\nz = 3\n"),
        ),
    ];
    for (name, before, after) in cases {
        let found = edited(&before);
        assert_eq!(found, after, "{name}");
        assert_eq!(
            edited(&found),
            found,
            "{name}: a second time changes something"
        );
        let windows = edited(&before.replace('\n', "\r\n"));
        if before.contains('\n') {
            assert_eq!(windows, after.replace('\n', "\r\n"), "{name}, CRLF");
        }
    }
}

#[test]
fn the_source_is_set_in_place() {
    let cases = [
        (
            "[source]\nkind = \"assumed\" # for now\n",
            "[source]\nsensor = \"s\"\nkind = \"measured\" # for now\n",
        ),
        (
            "[source] # where from\nkind   =  'x'\nsensor = \"old\"   # which\n[joint]\n",
            "[source] # where from\nkind   =  \"measured\"\nsensor = \"s\"   # which\n[joint]\n",
        ),
        ("a = 1\n", "a = 1\n\n[source]\nsensor = \"s\"\n"),
    ];
    for (before, after) in cases {
        let found = with_source(before, "measured", "s").unwrap();
        let expected = if before.starts_with('a') {
            "a = 1\n\n[source]\nkind = \"measured\"\nsensor = \"s\"\n"
        } else {
            after
        };
        assert_eq!(found, expected, "{before}");
    }
    assert!(with_source("source = { kind = \"x\" }\n", "measured", "s").is_err());
}

#[test]
fn shipped_objects_read_back_as_they_are_written() {
    for name in ["drawer1", "drawer2", "door1", "door2"] {
        let task = common::task(name, &[]);
        let unit = StateUnit::of(&task.joint);
        let segments = segments_of(&task.observation.table, unit).unwrap();
        assert!(segments.len() > 20, "{name}: {} segments", segments.len());
        let text = std::fs::read_to_string(common::object_path(name)).unwrap();
        let again = with_segments(&text, unit, &segments, &[]).unwrap();
        let table: toml_edit::DocumentMut = again.parse().unwrap();
        let count = table["observation"]["segment"]
            .as_array_of_tables()
            .unwrap()
            .len();
        assert_eq!(count, segments.len(), "{name}");
    }
}
