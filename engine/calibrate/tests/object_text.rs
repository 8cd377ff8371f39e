//! Object files edited in place.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use pubs_calibrate::object_text::{
    EditError, MARK, StateUnit, difference, segments_of, with_segments, with_source,
    write_atomically,
};
use pubs_calibrate::{Channel, Segment, Values};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::Value;

const DEG: StateUnit = StateUnit::Degrees;

fn force(from: f64, to: f64, position: &[f64], mean: &[f64], sigma: &[f64]) -> Segment {
    Segment {
        action: "safe_open".to_owned(),
        channel: Channel::Along,
        from: from.to_radians(),
        to: to.to_radians(),
        values: Values::Force {
            position: position.iter().map(|p| p.to_radians()).collect(),
            mean_n: mean.to_vec(),
            sigma_n: sigma.to_vec(),
        },
        note: None,
    }
}

fn moves(from: f64, to: f64, probability: f64) -> Segment {
    Segment {
        channel: Channel::Moves,
        values: Values::Moves { probability },
        ..force(from, to, &[from], &[0.0], &[1.0])
    }
}

fn two() -> Vec<Segment> {
    let first = force(0.0, 4.5, &[0.0, 0.5, 4.5], &[11.2, -0.001, 6.126], &[0.803]);
    let note = Some("blocked: no demonstration came here".to_owned());
    vec![
        first,
        Segment {
            note,
            ..moves(0.0, 4.5, 0.97)
        },
    ]
}

const WRITTEN: &str = r#"[[observation.segment]]
action = "safe_open"
channel = "f_d"
from_deg = 0.0
to_deg = 4.5
sigma_n = 0.8
position_deg = [0.0, 0.5, 4.5]
mean_n = [11.2, 0.0, 6.13]

# blocked: no demonstration came here
[[observation.segment]]
action = "safe_open"
channel = "m_p"
from_deg = 0.0
to_deg = 4.5
probability = 0.97
"#;

fn block() -> String {
    format!("{MARK}\n# 20 demonstrations\n\n{WRITTEN}")
}

const OLD: &str =
    "[[observation.segment]]\naction = \"x\"  # own\n# inside\nto_deg = [\n  1.0,\n]\n";

fn parsed(text: &str) -> Value {
    toml::from_str(text).unwrap()
}

#[test]
fn segments_take_the_place_of_the_old_ones_and_nothing_else_changes() {
    let block = block();
    // Text before, text after; BLOCK stands for what is written.
    let cases: Vec<(&str, String, String)> = vec![
        ("empty file", String::new(), "BLOCK".into()),
        (
            "at the end of the table, before the next one's comment",
            "[observation]\nmodel = \"segments\" # m\n# params = {}\n\n# The arm.\n[driver]\nx = 1\n".into(),
            "[observation]\nmodel = \"segments\" # m\n# params = {}\n\nBLOCK\n# The arm.\n[driver]\nx = 1\n".into(),
        ),
        (
            "no blank line to the next table",
            "[observation]\nmodel = 1\n[driver]\nx = 1\n".into(),
            "[observation]\nmodel = 1\n\nBLOCK\n[driver]\nx = 1\n".into(),
        ),
        (
            "behind the tables below it",
            "[observation]\n[observation.params]\na = 1\n\n[driver]\n".into(),
            "[observation]\n[observation.params]\na = 1\n\nBLOCK\n[driver]\n".into(),
        ),
        (
            "dotted keys of the root table",
            "observation.model = 1\nname = \"x\"\n".into(),
            "observation.model = 1\nname = \"x\"\n\nBLOCK".into(),
        ),
        (
            "an inline list",
            "[observation]\n# mine\nsegment = [\n  {a = 1}, # one\n] # all\nmodel = 1\n\n[driver]\n".into(),
            "[observation]\n# mine\nmodel = 1\n\nBLOCK\n[driver]\n".into(),
        ),
        (
            "old tables in two places, a comment of the user's between them",
            format!("[observation]\na = 1\n\n# user's\n{OLD}\n# also user's\n\n# note\n{OLD}\n[driver]\nx = 1\n\n{OLD}\n# last\n"),
            "[observation]\na = 1\n\n# user's\n\nBLOCK\n# also user's\n\n[driver]\nx = 1\n\n# last\n".into(),
        ),
        (
            "an earlier heading and note",
            format!("[observation]\na = 1\n\n{MARK}\n# 3 demonstrations\n#\n# and more\n\n# old note\n{OLD}\n{OLD}"),
            "[observation]\na = 1\n\nBLOCK".into(),
        ),
        (
            "an earlier heading right below a comment, and no blank line below it",
            format!("[observation]\na = 1\n# user's\n{MARK}\n# 3 demonstrations\n{OLD}"),
            "[observation]\na = 1\n# user's\n\nBLOCK".into(),
        ),
        (
            "an earlier heading, then a comment of the user's",
            format!("[observation]\na = 1\n\n{MARK}\n# 3\n\n# user's\n\n{OLD}\n[driver]\n"),
            "[observation]\na = 1\n\n# user's\n\nBLOCK\n[driver]\n".into(),
        ),
        (
            "a heading whose segments are gone",
            format!("[observation]\na = 1\n\n{MARK}\n# 3\n\n[driver]\n"),
            "[observation]\na = 1\n\nBLOCK\n[driver]\n".into(),
        ),
        (
            "no newline at the end",
            format!("name = 'x'\n\n{}", OLD.trim_end()),
            "name = 'x'\n\nBLOCK".into(),
        ),
        (
            "no newline at the end, nor segments",
            "[observation]\nmodel = 1 # m".into(),
            "[observation]\nmodel = 1 # m\n\nBLOCK".into(),
        ),
        (
            "brackets in text and comments",
            "[observation]\na = '''\n[driver]\n# x\n'''\n# [[observation.segment]]\n\n[driver]\n".into(),
            "[observation]\na = '''\n[driver]\n# x\n'''\n# [[observation.segment]]\n\nBLOCK\n[driver]\n".into(),
        ),
    ];
    for (name, before, after) in cases {
        let mut expected = after.replace("BLOCK", &block);
        if !before.is_empty() && !before.ends_with('\n') {
            expected = expected.trim_end().to_owned();
        }
        for (before, expected) in [
            (before.clone(), expected.clone()),
            (before.replace('\n', "\r\n"), expected.replace('\n', "\r\n")),
        ] {
            // An empty file has no line endings to go by.
            let expected = if before.is_empty() {
                block.clone()
            } else {
                expected
            };
            let expected = if before.contains('\n') || before.is_empty() {
                expected
            } else {
                expected.replace("\r\n", "\n")
            };
            let once = with_segments(&before, DEG, &two(), "20 demonstrations").unwrap();
            assert_eq!(once, expected, "{name}");
            let twice = with_segments(&once, DEG, &two(), "20 demonstrations").unwrap();
            assert_eq!(twice, once, "{name}, again");
            let other = with_segments(&once, DEG, &two()[..1], "a\n\nb").unwrap();
            let back = with_segments(&other, DEG, &two(), "20 demonstrations").unwrap();
            assert_eq!(back, once, "{name}, there and back");
        }
    }
}

#[test]
fn what_cannot_be_edited_is_refused() {
    let edit = |text: &str, segments: &[Segment]| with_segments(text, DEG, segments, "");
    let notation = |text: &str| matches!(edit(text, &two()), Err(EditError::Notation { .. }));
    assert!(notation("observation = { model = 1 }\n"));
    assert!(notation("observation = 3\n"));
    assert!(notation("[[observation]]\n"));
    assert!(matches!(edit("a = \n", &two()), Err(EditError::Toml(_))));
    assert_eq!(edit("", &[]), Err(EditError::NoSegments));
    let nan = f64::NAN;
    let faulty = [
        force(1.0, 1.0, &[1.0], &[0.0], &[1.0]),
        force(nan, 1.0, &[1.0], &[0.0], &[1.0]),
        force(0.0, f64::INFINITY, &[1.0], &[0.0], &[1.0]),
        force(0.0, 1.0, &[], &[], &[1.0]),
        force(0.0, 1.0, &[0.0, 1.0], &[0.0], &[1.0]),
        force(0.0, 1.0, &[1.0, 0.0], &[0.0, 0.0], &[1.0]),
        force(0.0, 1.0, &[0.0], &[nan], &[1.0]),
        force(0.0, 1.0, &[0.0], &[1.0], &[0.0]),
        force(0.0, 1.0, &[0.0], &[1.0], &[nan]),
        force(0.0, 1.0, &[0.0, 0.5, 1.0], &[1.0; 3], &[1.0; 2]),
        moves(0.0, 1.0, 1.1),
        moves(0.0, 1.0, nan),
        Segment {
            channel: Channel::Up,
            ..moves(0.0, 1.0, 0.5)
        },
        Segment {
            channel: Channel::Moves,
            ..force(0.0, 1.0, &[0.0], &[1.0], &[1.0])
        },
    ];
    for segment in faulty {
        let found = edit("", std::slice::from_ref(&segment));
        assert!(
            matches!(found, Err(EditError::Segment { .. })),
            "{segment:?}: {found:?}"
        );
    }
}

#[test]
fn numbers_are_short_and_names_and_notes_are_safe() {
    let odd = Segment {
        action: "a \"b\"\\".to_owned(),
        note: Some("two\nlines\u{7}".to_owned()),
        ..force(
            0.0,
            1.0,
            &[-1e-9, 0.004, 0.5, 1.0 + 1e-9],
            &[-0.004, 1.0, 1e7, 2.999],
            &[0.001, 1.0, 0.5, 2.0],
        )
    };
    let text = with_segments("", DEG, &[odd, moves(0.0, 1.0, 0.0004)], "").unwrap();
    for line in [
        "# two\n# lines\n[[observation.segment]]\n",
        "position_deg = [0.0, 0.5, 1.0]\nmean_n = [0.0, 10000000.0, 3.0]\n",
        "sigma_n = [0.01, 0.5, 2.0]\n",
        "probability = 0.0\n",
    ] {
        assert!(text.contains(line), "{line}is not in\n{text}");
    }
    assert_eq!(
        parsed(&text)["observation"]["segment"][0]["action"],
        "a \"b\"\\"
    );
    let constant = force(0.0, 1.0, &[0.3, 0.301], &[1.5, 1.6], &[0.4, 0.5]);
    let text = with_segments("", DEG, &[constant], "").unwrap();
    assert!(
        text.ends_with("to_deg = 1.0\nsigma_n = 0.4\nmean_n = 1.5\n"),
        "{text}"
    );
    let slide = Segment {
        from: 0.0,
        to: 0.281,
        ..moves(0.0, 1.0, 0.5)
    };
    let text = with_segments("", StateUnit::Metres, &[slide], "").unwrap();
    assert!(text.contains("from_m = 0.0\nto_m = 0.281\n"), "{text}");
}

/// Segments with boundaries a few hundredths of the written unit apart, over a range whose limits
/// have more digits than are written.
fn adversarial(seed: u64) -> (Vec<Segment>, f64, f64) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let (lower, upper) = (
        rng.random_range(-0.02..0.02),
        0.3 + rng.random_range(0.0..0.02),
    );
    // Limits as a file gives them.
    let (lower, upper) = (
        (lower * 1e6f64).round() / 1e6,
        (upper * 1e6f64).round() / 1e6,
    );
    let mut bounds: Vec<f64> = (0..60).map(|_| rng.random_range(lower..upper)).collect();
    bounds.extend([
        lower,
        upper,
        upper - 1e-6,
        lower + 1e-6,
        0.005,
        0.015,
        0.025,
    ]);
    bounds.retain(|bound| (lower..=upper).contains(bound));
    bounds.sort_by(f64::total_cmp);
    let segments = bounds.windows(2).map(|ends| {
        let mut position: Vec<f64> = (0..6).map(|_| rng.random_range(ends[0]..ends[1])).collect();
        position.extend(ends);
        position.sort_by(f64::total_cmp);
        position.dedup();
        let mean = vec![1.0; position.len()];
        // Neighbours agree but for rounding errors.
        force(ends[0] * (1.0 + 1e-15), ends[1], &position, &mean, &[1.0])
    });
    (segments.collect(), lower, upper)
}

#[test]
fn rounding_keeps_the_tiling() {
    for seed in 0..200 {
        let (segments, lower, upper) = adversarial(seed);
        let text = with_segments("", DEG, &segments, "").unwrap();
        let read = segments_of(&parsed(&text)["observation"], DEG).unwrap();
        assert!(
            read.len() > 20,
            "seed {seed}: {} segments are left",
            read.len()
        );
        let mut end = lower.to_radians();
        for (i, segment) in read.iter().enumerate() {
            let near = if i == 0 { 1e-9 } else { 0.0 };
            assert!(
                (segment.from - end).abs() <= near,
                "seed {seed}: gap before {i}\n{text}"
            );
            assert!(
                segment.from < segment.to,
                "seed {seed}: {i} is empty\n{text}"
            );
            let Values::Force { position, .. } = &segment.values else {
                panic!("no force")
            };
            let risen = position.windows(2).all(|pair| pair[0] < pair[1]);
            let inside = position
                .iter()
                .all(|p| (segment.from..=segment.to).contains(p));
            assert!(risen && inside, "seed {seed}: positions of {i}\n{text}");
            end = segment.to;
        }
        assert!(
            (end - upper.to_radians()).abs() <= 1e-9,
            "seed {seed}: ends at {end}\n{text}"
        );
    }
}

#[test]
fn object_files_survive_a_round_trip() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../objects");
    let mut edited = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        if path.extension().is_none_or(|extension| extension != "toml")
            || !text.contains("[[observation.segment]]")
        {
            continue;
        }
        let revolute = text.contains("\"revolute\"");
        let unit = if revolute { DEG } else { StateUnit::Metres };
        let old = parsed(&text);
        let segments = segments_of(&old["observation"], unit).unwrap();
        assert!(segments.len() > 20, "{}", path.display());
        let new = with_segments(&text, unit, &segments, "again").unwrap();
        assert_eq!(parsed(&new), old, "{}", path.display());
        assert_eq!(with_segments(&new, unit, &segments, "again").unwrap(), new);
        let changed = difference(&text, &new);
        let removed: Vec<_> = changed
            .lines()
            .filter(|line| line.starts_with('-'))
            .collect();
        let comments_alone = removed
            .iter()
            .all(|line| line.starts_with("-#") || *line == "-");
        assert!(comments_alone, "{}: {changed}", path.display());
        edited += 1;
    }
    assert!(edited > 0, "no object file has segments");
}

#[test]
fn segments_are_read_in_every_notation() {
    let text = r#"
        segment = [
            { action = "a", channel = "f_z", from_m = 0, to_m = 0.5, mean_n = 2, sigma_n = 1 },
            { action = "a", channel = "f_n", from_m = 0, to_m = 0.5, position_m = [0, 0.5], mean_n = 2, sigma_n = [1, 2] },
            { action = "a", channel = "m_p", from_m = 0, to_m = 0.5, probability = 0.25 },
        ]"#;
    let values = |position: &[f64], mean_n: &[f64], sigma_n: &[f64]| Values::Force {
        position: position.to_vec(),
        mean_n: mean_n.to_vec(),
        sigma_n: sigma_n.to_vec(),
    };
    let expected = [
        (Channel::Up, values(&[0.0], &[2.0], &[1.0])),
        (
            Channel::Normal,
            values(&[0.0, 0.5], &[2.0, 2.0], &[1.0, 2.0]),
        ),
        (Channel::Moves, Values::Moves { probability: 0.25 }),
    ];
    let read = segments_of(&parsed(text), StateUnit::Metres).unwrap();
    let read: Vec<_> = read.into_iter().map(|s| (s.channel, s.values)).collect();
    assert_eq!(read, expected);
    assert_eq!(segments_of(&parsed("model = 1"), DEG), Ok(vec![]));

    let start = r#"action = "a", channel = "f_d", from_deg = 0, to_deg = 1"#;
    for (table, word) in [
        ("3".to_owned(), "table"),
        ("{}".to_owned(), "channel"),
        (format!("{{ {start} }}"), "mean_n"),
        (
            format!("{{ {start}, mean_n = 1, sigma_n = [] }}"),
            "sigma_n",
        ),
        (
            format!("{{ {start}, mean_n = [1, 2], sigma_n = 1 }}"),
            "length",
        ),
        (
            format!("{{ {start}, mean_n = nan, sigma_n = 1 }}"),
            "mean_n",
        ),
        (r#"{ action = "a", channel = "f_x" }"#.to_owned(), "f_x"),
        (
            r#"{ action = "a", channel = "m_p", from_m = 0 }"#.to_owned(),
            "from_deg",
        ),
    ] {
        let fault = segments_of(&parsed(&format!("segment = [{table}]")), DEG).unwrap_err();
        assert!(fault.to_string().contains(word), "{table}: {fault}");
    }
}

#[test]
fn the_source_changes_in_place() {
    let cases = [
        (
            "[source]\nkind = \"virtual\"   # k\nsensor = 'v'# s\n[joint]\n",
            "[source]\nkind = \"measured\"   # k\nsensor = \"ati\"# s\n[joint]\n",
        ),
        (
            "[source] # where from\n\n[joint]\n",
            "[source] # where from\nkind = \"measured\"\nsensor = \"ati\"\n\n[joint]\n",
        ),
        (
            "[source]\nkind = \"x\" # k\n# sensor\n\n[joint]\n",
            "[source]\nkind = \"measured\" # k\nsensor = \"ati\"\n# sensor\n\n[joint]\n",
        ),
        (
            "[source]\nkind = \"x\"",
            "[source]\nkind = \"measured\"\nsensor = \"ati\"",
        ),
        (
            "source = { kind = \"x\" } # s\n",
            "source = { kind = \"measured\", sensor = \"ati\" } # s\n",
        ),
        (
            "source = {}\n",
            "source = { kind = \"measured\", sensor = \"ati\" }\n",
        ),
        (
            "source.kind = \"x\"\nname = 1\n",
            "source.kind = \"measured\"\nsource.sensor = \"ati\"\nname = 1\n",
        ),
        (
            "name = 1\n\n# The joint.\n[joint]\n",
            "name = 1\n\n[source]\nkind = \"measured\"\nsensor = \"ati\"\n\n# The joint.\n[joint]\n",
        ),
        (
            "name = 1\n",
            "name = 1\n\n[source]\nkind = \"measured\"\nsensor = \"ati\"\n",
        ),
    ];
    for (before, after) in cases {
        for newline in ["\n", "\r\n"] {
            let (before, after) = (before.replace('\n', newline), after.replace('\n', newline));
            let once = with_source(&before, "measured", "ati").unwrap();
            assert_eq!(once, after, "{before}");
            assert_eq!(
                with_source(&once, "measured", "ati").unwrap(),
                once,
                "{before}, again"
            );
        }
    }
    let quoted = with_source("[source]\n", "measured", "a \"b\"\\").unwrap();
    assert_eq!(parsed(&quoted)["source"]["sensor"], "a \"b\"\\");
    for text in ["source = 1\n", "[source.kind]\n", "[[source]]\n"] {
        let found = with_source(text, "measured", "ati");
        assert!(
            matches!(found, Err(EditError::Notation { .. })),
            "{text}: {found:?}"
        );
    }
}

#[test]
fn a_difference_shows_the_changed_lines() {
    let old = "1\n2\n3\n4\n5\n6\n7\n8\n9\n";
    assert_eq!(difference(old, old), "");
    assert_eq!(
        difference(old, &old.replace("5\n", "five\n")),
        "@@ -2,7 +2,7 @@\n 2\n 3\n 4\n-5\n+five\n 6\n 7\n 8\n"
    );
    assert!(difference("a", "a\n").contains("No newline at end of file"));
}

#[test]
fn a_file_is_replaced_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("door.toml");
    write_atomically(&path, "new").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    write_atomically(&path, "newer").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "newer");
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        1,
        "something else was left"
    );
    assert!(write_atomically(&folder.path().join("no/such"), "x").is_err());
}

#[cfg(unix)]
#[test]
fn permissions_and_links_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (
        folder.path().join("door.toml"),
        folder.path().join("link.toml"),
    );
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&path, &link).unwrap();
    write_atomically(&link, "new").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    let mode = fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
}
