//! Defaults, and what is refused.
#![allow(clippy::unwrap_used)]

use serde_json::json;

use super::*;

fn read(params: Value) -> Result<Params, String> {
    Params::from_driver_table(&json!({ "plugin": "melfa", "params": params }))
        .map_err(|error| error.to_string())
}

#[test]
fn host_alone_is_enough_and_the_schema_tells_the_defaults() {
    let params = read(json!({ "host": "192.168.0.20" })).unwrap();
    assert_eq!(
        params,
        Params {
            host: "192.168.0.20".to_owned(),
            ..Params::default()
        }
    );
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let described = schema["properties"].as_object().unwrap();
    let given = serde_json::to_value(Params::default()).unwrap();
    let given = given.as_object().unwrap();
    for (name, value) in given {
        let about = &described[name];
        assert!(about["description"].is_string(), "{name} is not described");
        let default = &about["default"];
        let same = match (default.as_f64(), value.as_f64()) {
            (Some(a), Some(b)) => a == b,
            _ if value.is_array() => {
                numbers(default) == numbers(value) && texts(default) == texts(value)
            }
            _ => default == value,
        };
        assert!(
            same || name == "host",
            "{name}: schema {default}, code {value}"
        );
    }
    let unknown: Vec<_> = described
        .keys()
        .filter(|name| !given.contains_key(*name))
        .collect();
    assert!(unknown.is_empty(), "the schema describes {unknown:?}");
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_f64)
        .collect()
}

fn texts(list: &Value) -> Vec<&str> {
    list.as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect()
}

#[test]
fn wrong_values_are_named_with_their_rule() {
    let cases = [
        (json!({}), "host is missing"),
        (json!({ "host": "a", "hots": 1 }), "unknown field `hots`"),
        (
            json!({ "host": "a", "cycle_ms": 0.0 }),
            "cycle_ms = 0, but it must lie in 0.5 to 20",
        ),
        (
            json!({ "host": "a", "joint_speed_fraction": 0.9 }),
            "joint_speed_fraction = 0.9",
        ),
        (
            json!({ "host": "a", "force_source": "air" }),
            "unknown variant `air`",
        ),
        (
            json!({ "host": "a", "sensor_axes": ["x", "y", "w"] }),
            "`w` is no axis",
        ),
        (
            json!({ "host": "a", "sensor_axes": ["x", "-x", "z"] }),
            "each of x, y, z must stand once",
        ),
        (
            json!({ "host": "a", "program": "A B" }),
            "program = \"A B\"",
        ),
        (
            json!({ "host": "a", "tool_position_m": [0, 0, 7.5] }),
            "tool_position_m = [0.0, 0.0, 7.5]",
        ),
        (json!({ "host": "a", "mxt_port": 70000 }), "70000"),
    ];
    for (params, words) in cases {
        let fault = read(params.clone()).expect_err(&params.to_string());
        assert!(
            fault.contains(words),
            "{params}: `{fault}` should hold `{words}`"
        );
    }
    let both = read(json!({ "host": "", "lead_m": -1.0 })).unwrap_err();
    assert!(both.contains("host") && both.contains("lead_m"), "{both}");
}

#[test]
fn nan_breaks_every_rule() {
    let nan = Params {
        host: "a".to_owned(),
        cycle_ms: f64::NAN,
        lead_m: f64::NAN,
        tool_position_m: [0.0, f64::NAN, 0.0],
        ..Params::default()
    };
    assert_eq!(check::faults(&nan).len(), 3, "{:?}", check::faults(&nan));
}

#[test]
fn axes_have_names_and_signs() {
    let vector = nalgebra::Vector3::new(1.0, 2.0, 3.0);
    for (name, expected) in [("x", 1.0), ("-y", -2.0), ("+z", 3.0), ("-z", -3.0)] {
        assert_eq!(
            SignedAxis::named(name).unwrap().of(&vector),
            expected,
            "{name}"
        );
    }
}
