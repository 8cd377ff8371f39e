//! Pictures: places worked out by hand, sheets of the shipped objects, and pixels.

#![allow(clippy::unwrap_used)]

mod common;

use pubs_calibrate::object_text;
use pubs_calibrate::plot::{Panel, Picture, PlotError, Sample, StateUnit, png, svg};
use pubs_calibrate::stored::Stored;
use pubs_calibrate::{Channel, Segment, Values};
use pubs_draw::DrawError;
use resvg::tiny_skia::Pixmap;

const ACTIONS: [&str; 4] = ["safe_open", "safe_close", "high_open", "high_close"];

fn force(from: f64, to: f64, mean_n: &[f64], sigma_n: f64) -> Segment {
    let last = (mean_n.len() - 1) as f64;
    Segment {
        action: "safe_open".to_owned(),
        channel: Channel::Along,
        from,
        to,
        values: Values::Force {
            position: (0..mean_n.len())
                .map(|index| from + (to - from) * index as f64 / last)
                .collect(),
            mean_n: mean_n.to_vec(),
            sigma_n: vec![sigma_n],
        },
        note: None,
    }
}

fn panel<'a>(segments: &'a [Segment], samples: &'a [Sample]) -> Panel<'a> {
    Panel {
        action: "safe_open",
        channel: Channel::Along,
        segments: segments.iter().collect(),
        samples,
        left_out: Vec::new(),
    }
}

fn picture(panels: Vec<Panel>) -> Picture {
    Picture {
        title: "tiny".to_owned(),
        subtitle: "two segments".to_owned(),
        unit: StateUnit::Centimetres,
        limits: [0.0, 1.0],
        force_threshold_n: None,
        panels,
    }
}

/// The `points` of elements of this tag and colour.
fn points(svg: &str, tag: &str, color: &str) -> Vec<Vec<[i32; 2]>> {
    svg.lines()
        .filter(|line| line.starts_with(&format!("<{tag} ")) && line.contains(color))
        .map(|line| {
            let points = line.split("points=\"").nth(1).unwrap();
            let points = points.split('"').next().unwrap();
            points
                .split_whitespace()
                .map(|pair| {
                    let (x, y) = pair.split_once(',').unwrap();
                    [x.parse().unwrap(), y.parse().unwrap()]
                })
                .collect()
        })
        .collect()
}

#[test]
fn mean_and_band_stand_where_they_should() {
    let segments = [
        force(0.0, 0.5, &[0.0, 10.0], 1.0),
        force(0.5, 1.0, &[10.0, 4.0], 0.5),
    ];
    let text = svg(&picture(vec![panel(&segments, &[])])).unwrap();
    // x: 250 at -0.025 to 3448 at 1.025, 3045.71 units per 1.
    // y: 2325 to 325 over the band and 6 % at each end: -2.84 to 12.84, 127.55 per N.
    let x = |state: f64| (250.0 + (state + 0.025) / 1.05 * 3198.0).round() as i32;
    let y = |force: f64| (2325.0 - (force + 2.84) / 15.68 * 2000.0).round() as i32;
    let means = points(&text, "polyline", "#08306B");
    // The legend's stroke, then the one curve.
    assert_eq!(means.len(), 2, "one mean and its legend: {means:?}");
    assert_eq!(
        means[1],
        [
            [x(0.0), y(0.0)],
            [x(0.5), y(10.0)],
            [x(0.5), y(10.0)],
            [x(1.0), y(4.0)]
        ]
    );
    assert_eq!(means[1][0], [326, 1963], "by hand");
    let bands = points(&text, "polygon", "#C6DBEF");
    assert_eq!(bands.len(), 2, "one band and its legend: {bands:?}");
    assert_eq!(
        bands[1],
        [
            [x(0.0), y(2.0)],
            [x(0.5), y(12.0)],
            [x(0.5), y(11.0)],
            [x(1.0), y(5.0)],
            [x(1.0), y(3.0)],
            [x(0.5), y(9.0)],
            [x(0.5), y(8.0)],
            [x(0.0), y(-2.0)]
        ]
    );
}

#[test]
fn gap_between_segments_leaves_a_gap() {
    let segments = [
        force(0.0, 0.4, &[1.0, 1.0], 0.3),
        force(0.6, 1.0, &[1.0, 2.0], 0.3),
    ];
    let text = svg(&picture(vec![panel(&segments, &[])])).unwrap();
    assert_eq!(
        points(&text, "polyline", "#08306B").len(),
        3,
        "legend and two curves"
    );
}

#[test]
fn same_picture_gives_the_same_bytes() {
    let segments = [force(0.0, 1.0, &[1.0, 3.0], 0.3)];
    let samples: Vec<_> = (0..5000)
        .map(|index| Sample {
            state: f64::from(index) / 5000.0,
            value: f64::from(index % 7),
        })
        .collect();
    let draw = || svg(&picture(vec![panel(&segments, &samples)])).unwrap();
    assert_eq!(draw(), draw());
}

#[test]
fn names_with_special_characters_are_written_as_they_are() {
    let segments = [force(0.0, 1.0, &[1.0, 3.0], 0.3)];
    let mut picture = picture(vec![panel(&segments, &[])]);
    picture.title = "door <1> & \"2\"".to_owned();
    let text = svg(&picture).unwrap();
    assert!(text.contains("door &lt;1&gt; &amp;"), "not escaped");
    png(&text, 0.2).unwrap();
}

#[test]
fn faults_are_named() {
    let segments = [force(0.0, 1.0, &[1.0, 3.0], 0.3)];
    assert_eq!(svg(&picture(Vec::new())), Err(PlotError::Empty));
    let mut reversed = picture(vec![panel(&segments, &[])]);
    reversed.limits = [1.0, f64::NAN];
    let message = svg(&reversed).unwrap_err().to_string();
    assert!(message.contains("from 1 to NaN"), "{message}");
    assert!(matches!(png("no svg", 1.0), Err(DrawError::Svg(_))));
    let text = svg(&picture(vec![panel(&segments, &[])])).unwrap();
    for scale in [0.0, -1.0, 1e6, f32::NAN] {
        assert!(
            matches!(png(&text, scale), Err(DrawError::Size { .. })),
            "scale {scale}"
        );
    }
}

#[test]
fn png_has_its_size_and_its_letters() {
    let segments = [force(0.0, 1.0, &[1.0, 3.0], 0.3)];
    let mut picture = picture(vec![panel(&segments, &[])]);
    let dark = |picture: &Picture| {
        let image = png(&svg(picture).unwrap(), 1.0).unwrap();
        let image = Pixmap::decode_png(&image).unwrap();
        // A4 landscape at 96 pixels to the inch.
        assert_eq!((image.width(), image.height()), (1123, 794));
        let in_title = |index: &usize| (8..40).contains(&(index / 1123));
        image
            .pixels()
            .iter()
            .enumerate()
            .filter(|(index, pixel)| in_title(index) && pixel.red() < 100)
            .count()
    };
    picture.title = String::new();
    let without = dark(&picture);
    assert_eq!(without, 0, "nothing else stands where the title is");
    picture.title = "i".to_owned();
    let one_letter = dark(&picture);
    picture.title = "calibration of drawer2".to_owned();
    let letters = dark(&picture);
    assert!(
        one_letter > 5 && letters > 8 * one_letter,
        "a letter has {one_letter} dark pixels, a title {letters}"
    );
}

/// The segments of a shipped object file, in order.
fn shipped(name: &str) -> (Picture<'static>, Vec<Segment>) {
    let task = common::task(name, &[]);
    let file_unit = object_text::StateUnit::of(&task.joint);
    let segments = object_text::segments_of(&task.observation.table, file_unit).unwrap();
    let unit = match file_unit {
        object_text::StateUnit::Degrees => StateUnit::Degrees,
        object_text::StateUnit::Metres => StateUnit::Centimetres,
    };
    let picture = Picture {
        title: format!("{name}: observation model and demonstrations"),
        subtitle: "Samples drawn from the model for this test, 20 demonstrations of each action"
            .to_owned(),
        unit,
        limits: [task.joint.lower, task.joint.upper],
        force_threshold_n: task.control.map(|control| control.force_threshold_n),
        panels: Vec::new(),
    };
    (picture, segments)
}

/// Readings around the model, with the sum of three sines of the index for noise.
fn samples(segments: &[&Segment], limits: [f64; 2]) -> Vec<Sample> {
    let noise = |index: usize| {
        let index = index as f64;
        ((index * 1.7).sin() + (index * 2.9).sin() + (index * 7.3).sin()) * 0.8
    };
    (0..4000)
        .filter_map(|index| {
            let state = limits[0] + (limits[1] - limits[0]) * (index % 1000) as f64 / 999.0;
            let first = segments.first()?;
            let own: Vec<Segment> = segments.iter().map(|&segment| segment.clone()).collect();
            let (mean, sigma) = Stored::of(&own, &first.action, first.channel)?.moments(state);
            let value = if first.channel == Channel::Moves {
                f64::from(noise(index).abs() % 1.0 < mean)
            } else {
                mean + noise(index) * sigma
            };
            Some(Sample { state, value })
        })
        .collect()
}

/// Draws all four objects; with `PUBS_PICTURES` set to a folder, leaves the pictures there.
#[test]
fn sheets_of_the_shipped_objects_stay_small() {
    for name in ["door1", "door2", "drawer1", "drawer2"] {
        let (mut picture, segments) = shipped(name);
        let limits = picture.limits;
        let channels = [Channel::Along, Channel::Up, Channel::Normal, Channel::Moves];
        let grid: Vec<_> = ACTIONS
            .iter()
            .flat_map(|action| channels.map(|channel| (*action, channel)))
            .collect();
        let models: Vec<Vec<&Segment>> = grid
            .iter()
            .map(|(action, channel)| {
                let belongs =
                    |segment: &&Segment| segment.action == *action && segment.channel == *channel;
                segments.iter().filter(belongs).collect()
            })
            .collect();
        let recorded: Vec<_> = models.iter().map(|model| samples(model, limits)).collect();
        picture.panels = grid
            .iter()
            .zip(&models)
            .zip(&recorded)
            .map(|((&(action, channel), model), samples)| Panel {
                action,
                channel,
                segments: model.clone(),
                samples,
                left_out: match action {
                    "high_open" => vec![[limits[1] - 0.04 * (limits[1] - limits[0]), limits[1]]],
                    "high_close" => vec![[limits[0], limits[0] + 0.04 * (limits[1] - limits[0])]],
                    _ => Vec::new(),
                },
            })
            .collect();
        let text = svg(&picture).unwrap();
        assert!(text.len() < 2_000_000, "{name}: {} bytes", text.len());
        // Two forces of each action need a band at least; more come from gaps alone.
        let bands = points(&text, "polygon", "#C6DBEF").len();
        assert_eq!(
            bands,
            1 + 12,
            "{name}: a band in each panel of a force, and the legend's"
        );
        if let Ok(folder) = std::env::var("PUBS_PICTURES") {
            std::fs::write(format!("{folder}/{name}.svg"), &text).unwrap();
            std::fs::write(format!("{folder}/{name}.png"), png(&text, 2.0).unwrap()).unwrap();
        }
    }
}
