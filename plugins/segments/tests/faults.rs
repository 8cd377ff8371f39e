//! Everything that can be wrong with segments is named, with place, rule and cure.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::*;
use pubs_plugin::{JointType, ModelSetup, ObservationModel};
use pubs_segments::Segments;
use serde_json::{Map, Value, json};

/// The slide with a change to the segment of this index: a null removes a key.
fn changed(index: usize, change: Value) -> ModelSetup {
    let mut segments = slide();
    let table: &mut Map<String, Value> = segments[index].as_object_mut().unwrap();
    for (key, value) in change.as_object().unwrap() {
        table.insert(key.clone(), value.clone());
        if value == "(remove)" {
            table.remove(key);
        }
    }
    setup(joint(JointType::Prismatic, 0.0, 0.4), 300, segments)
}

fn lines(setup: &ModelSetup) -> Vec<String> {
    let error = Segments::create(setup).unwrap_err().to_string();
    error.lines().map(str::to_owned).collect()
}

/// One fault gives one line, which holds all the words.
#[test]
fn each_fault_is_named_once() {
    let d = "segment[0] (open, f_d): ";
    let m = "segment[5] (open, m_p): ";
    let cases = [
        (
            0,
            json!({ "colour": "red" }),
            d,
            "unknown key colour; the keys of this channel are action, channel, mean_n",
        ),
        (
            0,
            json!({ "probability": 0.5 }),
            d,
            "unknown key probability",
        ),
        (5, json!({ "sigma_n": 1.0 }), m, "unknown key sigma_n"),
        (
            0,
            json!({ "from_m": "(remove)", "from_deg": 0.0 }),
            d,
            "key from_deg is in the wrong unit; the type of this joint has positions in the unit of from_m; give from_m",
        ),
        (
            0,
            json!({ "position_m": "(remove)", "position": [0.0, 0.1] }),
            d,
            "key position is in the wrong unit",
        ),
        (
            0,
            json!({ "action": "opne" }),
            "segment[0] (opne, f_d): ",
            "action is \"opne\"; it must be a movement action of the object; name one of open",
        ),
        (
            0,
            json!({ "action": "stop" }),
            "segment[0] (stop, f_d): ",
            "an action that stops has no observation model; remove",
        ),
        (
            0,
            json!({ "action": "(remove)" }),
            "segment[0] (?, f_d): ",
            "action is missing",
        ),
        (
            0,
            json!({ "channel": "f_x" }),
            "segment[0] (open, f_x): ",
            "channel is \"f_x\"; it must be a component of the observation; name one of f_d, f_z, f_n, m_p",
        ),
        (
            0,
            json!({ "channel": 3 }),
            "segment[0] (open, ?): ",
            "channel is 3",
        ),
        (0, json!({ "to_m": "(remove)" }), d, "to_m is missing"),
        (
            0,
            json!({ "to_m": "far" }),
            d,
            "to_m is \"far\"; it must be a finite number",
        ),
        (
            0,
            json!({ "to_m": null }),
            d,
            "to_m is nan or inf; it must be a finite number",
        ),
        (
            0,
            json!({ "to_m": 0.0, "position_m": "(remove)", "mean_n": 1.0 }),
            d,
            "from_m is 0 and to_m is 0; a segment must end above its start",
        ),
        (
            0,
            json!({ "mean_n": "(remove)", "position_m": "(remove)" }),
            d,
            "mean_n is missing",
        ),
        (0, json!({ "sigma_n": "(remove)" }), d, "sigma_n is missing"),
        (
            0,
            json!({ "sigma_n": 0.0 }),
            d,
            "sigma_n is 0; it must be greater than 0; put",
        ),
        (
            0,
            json!({ "sigma_n": [1.0, -2.0] }),
            d,
            "sigma_n[1] is -2; it must be greater than 0",
        ),
        (
            0,
            json!({ "sigma_n": 1e-60 }),
            d,
            "it must be greater than 0",
        ),
        (
            0,
            json!({ "mean_n": [1.0, null] }),
            d,
            "mean_n[1] is nan or inf",
        ),
        (
            0,
            json!({ "mean_n": [1.0, 1e60] }),
            d,
            "must be a finite number (single precision)",
        ),
        (
            0,
            json!({ "mean_n": [1.0, 2.0, 3.0] }),
            d,
            "mean_n has 3 values and position_m has 2; both lists must have one length",
        ),
        (0, json!({ "mean_n": [] }), d, "mean_n is an empty list"),
        (0, json!({ "mean_n": true }), d, "mean_n is true"),
        (
            0,
            json!({ "position_m": "(remove)" }),
            d,
            "mean_n is a list of 2 without position_m; a list needs positions; add position_m",
        ),
        (
            0,
            json!({ "mean_n": 1.0 }),
            d,
            "position_m is there, but no value is a list; positions need a list of values; remove position_m",
        ),
        (
            0,
            json!({ "position_m": 0.1 }),
            d,
            "position_m is 0.1; it must be a list",
        ),
        (
            0,
            json!({ "position_m": [0.1, 0.1] }),
            d,
            "position_m[1] = 0.1 does not lie above position_m[0] = 0.1; positions must be strictly increasing",
        ),
        (
            0,
            json!({ "position_m": [0.0, 0.2] }),
            d,
            "position_m[1] = 0.2 is outside the segment; positions must lie between 0 and 0.15",
        ),
        (
            5,
            json!({ "probability": [0.5, 1.01] }),
            m,
            "probability[1] is 1.01; it must lie between 0 and 1",
        ),
        (
            4,
            json!({ "probability": -0.1 }),
            "segment[4] (open, m_p): ",
            "probability is -0.1; it must lie between 0 and 1",
        ),
        (
            5,
            json!({ "probability": "(remove)", "position_m": "(remove)" }),
            m,
            "probability is missing",
        ),
        (
            1,
            json!({ "from_m": 0.16, "position_m": [0.16, 0.4] }),
            "segment[1] (open, f_d): ",
            "from_m = 0.16 leaves a gap after segment[0], which ends at 0.15; segments must meet; set from_m = 0.15",
        ),
        (
            1,
            json!({ "from_m": 0.14 }),
            "segment[1] (open, f_d): ",
            "from_m = 0.14 overlaps segment[0], which ends at 0.15; segments must meet",
        ),
        (
            0,
            json!({ "from_m": 0.01, "position_m": [0.01, 0.1] }),
            d,
            "from_m = 0.01 leaves a gap to the limit; segments must reach from limit to limit, and the lower one is 0; set from_m = 0",
        ),
        (
            0,
            json!({ "from_m": -0.01 }),
            d,
            "from_m = -0.01 lies outside the limits",
        ),
        (
            1,
            json!({ "to_m": 0.5 }),
            "segment[1] (open, f_d): ",
            "to_m = 0.5 lies outside the limits; segments must reach from limit to limit, and the upper one is 0.4",
        ),
        (
            6,
            json!({ "to_m": 0.39 }),
            "segment[6] (open, m_p): ",
            "to_m = 0.39 leaves a gap to the limit",
        ),
    ];
    for (index, change, place, words) in cases {
        let found = lines(&changed(index, change.clone()));
        assert_eq!(found.len(), 1, "{change} gives {found:#?}");
        assert!(
            found[0].starts_with(place) && found[0].contains(words),
            "{change} gives {found:#?}, expected {place}{words}"
        );
    }
}

#[test]
fn degrees_are_shown_as_degrees() {
    let whole = |channel: &str, to: f64| json!({ "action": "open", "channel": channel, "from_deg": 0.0, "to_deg": to, "mean_n": 1.0, "sigma_n": 1.0 });
    let moved = json!({ "action": "open", "channel": "m_p", "from_deg": 0.0, "to_deg": 125.0, "probability": 0.9 });
    let segments = vec![
        whole("f_d", 4.5),
        whole("f_z", 125.0),
        whole("f_n", 125.000_01),
        moved,
    ];
    let found = lines(&setup(
        joint(JointType::Revolute, 0.0, 125_f64.to_radians()),
        300,
        segments,
    ));
    assert_eq!(
        found,
        [
            "segment[0] (open, f_d): to_deg = 4.5 leaves a gap to the limit; segments must reach from limit to limit, and the upper one is 125; set to_deg = 125"
        ]
    );
}

#[test]
fn all_faults_come_out_at_once() {
    let mut segments = slide();
    segments[0]["sigma_n"] = json!(-1.0);
    segments[1]["mean_n"] = json!([null, "x"]);
    segments.remove(2);
    segments[2]["position_deg"] = json!([1.0]);
    segments.push(json!("no table"));
    segments.pop();
    let mut setup = setup(joint(JointType::Prismatic, 0.0, 0.4), 300, segments);
    setup.observation["params"] = json!({ "gain": 2 });
    let found = lines(&setup);
    let words = [
        "params: found {\"gain\":2}; this model has no parameters",
        "segment[0] (open, f_d): sigma_n is -1",
        "segment[1] (open, f_d): mean_n[0] is nan or inf",
        "segment[1] (open, f_d): mean_n[1] is \"x\"",
        "segment[2] (open, f_n): key position_deg is in the wrong unit",
        "segments: there is none for (open, f_z); every movement action needs every channel",
    ];
    assert_eq!(found.len(), words.len(), "{found:#?}");
    for (line, words) in found.iter().zip(words) {
        assert!(line.starts_with(words), "{line}, expected {words}");
    }
}

#[test]
fn segments_must_be_a_list_of_tables() {
    let cases = [
        (
            json!({}),
            "segment: it is missing; the model is made of segments; write [[observation.segment]]",
        ),
        (json!({ "segment": 3 }), "segment: it is no list"),
        (
            json!({ "segment": [7] }),
            "segment[0]: it is 7; it must be a table",
        ),
    ];
    for (observation, words) in cases {
        let mut setup = slide_setup(300);
        setup.observation = observation;
        let found = lines(&setup);
        assert!(
            found.len() == 1 && found[0].starts_with(words),
            "{found:#?}, expected {words}"
        );
    }
}

#[test]
fn an_impossible_grid_is_refused() {
    for spacing in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e-9] {
        let mut setup = slide_setup(300);
        setup.belief.spacing = spacing;
        let found = lines(&setup);
        assert!(
            found[0].starts_with("belief: a range of 0.4 with particles"),
            "spacing {spacing}: {found:?}"
        );
    }
}

#[test]
fn the_schema_is_json_and_refuses_keys_it_does_not_name() {
    let schema: Value = serde_json::from_str(Segments::PARAMS_SCHEMA).unwrap();
    assert_eq!(schema["additionalProperties"], false);
    let keys: Vec<_> = schema["properties"].as_object().unwrap().keys().collect();
    assert_eq!(keys, ["params", "segment"]);
    let table = &schema["properties"]["segment"]["items"];
    for segment in slide() {
        for key in segment.as_object().unwrap().keys() {
            assert!(
                table["properties"][key].is_object(),
                "the schema does not name {key}"
            );
        }
    }
}

#[test]
fn the_table_is_that_of_the_model() {
    let table = pubs_segments::table();
    assert_eq!(table.kind, pubs_plugin::table::KIND_OBSERVATION_MODEL);
    assert_eq!(table.name.length, "segments".len());
}
