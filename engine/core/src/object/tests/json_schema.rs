//! The schema for editors.

use std::path::Path;

use serde_json::Value;

use super::{DOOR, DRAWER, LIGHT_DARK};
use crate::object::{json_schema, json_schema_text};

fn as_json(text: &str) -> Value {
    serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap()
}

#[test]
fn the_committed_schema_is_not_stale() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../objects/object.schema.json");
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(
        committed == json_schema_text(),
        "objects/object.schema.json is stale: write it anew with \
         `pubs-engine config --schema > objects/object.schema.json`"
    );
}

#[test]
fn the_schema_takes_good_files_and_refuses_bad_ones() {
    let schema = jsonschema::validator_for(&json_schema()).unwrap();
    for text in [DOOR, DRAWER, LIGHT_DARK] {
        let errors: Vec<String> = schema
            .iter_errors(&as_json(text))
            .map(|error| error.to_string())
            .collect();
        assert!(errors.is_empty(), "{errors:?} in:\n{text}");
    }
    let bad = [
        DOOR.replace("radius_m = 0.3", "radius_m = 0.0"),
        DOOR.replace("radius_m = 0.3", ""),
        DOOR.replace("radius_m = 0.3", "radius_m = 0.3\nstart = [0, 1]"),
        DOOR.replace("[reward]\ngoal_tolerance_deg = 5.0", ""),
        DOOR.replace("[reward]", "[belief]\nparticels = 3\n[reward]"),
        DRAWER.replace("limits_m = [0.0, 0.3]", "limits_m = [0.0]"),
        DRAWER.replace("[reward]", "[reward]\ndiscount = 1.0"),
        LIGHT_DARK.replace("discount = 0.95", ""),
        LIGHT_DARK.replace("[reward]", "[control]\nrate_hz = 5\n[reward]"),
        LIGHT_DARK.replace("name = \"left_1\"", ""),
    ];
    for text in bad {
        assert!(
            !schema.is_valid(&as_json(&text)),
            "the schema takes:\n{text}"
        );
        assert!(super::load(&text).is_err(), "the check takes:\n{text}");
    }
}

#[test]
fn keys_are_described_with_unit_and_default() {
    let schema = json_schema();
    let speed = &schema["properties"]["control"]["properties"]["safe_speed_m_s"];
    assert_eq!(
        speed["description"],
        "Speed of the handle in safe mode (m/s)."
    );
    assert_eq!(speed["default"], 0.05);
    assert_eq!(speed["exclusiveMinimum"], 0.0);
    assert_eq!(
        schema["properties"]["policy"]["properties"]["layers"]["default"][2],
        64
    );
}
