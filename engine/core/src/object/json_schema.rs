//! The JSON Schema for editors, made from the key table.

use pubs_plugin::JointType;
use serde_json::{Map, Value, json};

use super::keys;
use super::layers::defaults_for;
use super::schema::{JOINTS, Key, Kind, Need, Range, joint_name};

/// The JSON Schema (draft 7) of object files. Editors take completion, documentation and types
/// from it; `check` alone knows the rules between keys.
pub fn json_schema() -> Value {
    let mut schema = table("", "");
    let defaults = serde_json::to_value(defaults_for(None)).unwrap_or_default();
    add_defaults(&mut schema, &defaults);
    let root = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "pubs-engine object file",
        "description": "One object: its joint, the controller, the belief, the reward and the observation model.",
        "allOf": JOINTS.map(for_joint),
    });
    merge(&mut schema, root);
    schema
}

/// Every key that any joint type may have.
fn table(pattern: &str, doc: &str) -> Value {
    let properties: Map<String, Value> = keys::children(pattern)
        .map(|key| (key.name().to_owned(), property(key)))
        .collect();
    let required: Vec<&str> = keys::children(pattern)
        .filter(|key| key.need(None) == Need::Required)
        .map(Key::name)
        .collect();
    let mut schema = json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    if !doc.is_empty() {
        schema["description"] = doc.into();
    }
    schema
}

fn property(key: &Key) -> Value {
    let doc = match key.unit {
        "" => key.doc.to_owned(),
        unit => format!("{} ({unit})", key.doc.trim_end_matches('.')) + ".",
    };
    let mut schema = match key.kind {
        Kind::Table => return table(key.path, &doc),
        Kind::Tables => {
            json!({ "type": "array", "minItems": 1, "items": table(&format!("{}.*", key.path), "") })
        }
        Kind::Text => json!({ "type": "string", "minLength": 1 }),
        Kind::Name => json!({ "type": "string", "pattern": "^[A-Za-z0-9_-]+$" }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Number(range) => bounded("number", range),
        Kind::Whole(range) => bounded("integer", range),
        Kind::Numbers(count, range) => json!({
            "type": "array", "items": bounded("number", range), "minItems": count, "maxItems": count,
        }),
        Kind::Wholes(range) => {
            json!({ "type": "array", "items": bounded("integer", range), "minItems": 1 })
        }
        Kind::Plugin => json!({}),
    };
    schema["description"] = doc.into();
    schema
}

fn bounded(kind: &str, range: Range) -> Value {
    let mut schema = json!({ "type": kind });
    if range.low > -f64::MAX {
        schema[if range.above_low {
            "exclusiveMinimum"
        } else {
            "minimum"
        }] = range.low.into();
    }
    if range.high < f64::MAX {
        schema[if range.below_high {
            "exclusiveMaximum"
        } else {
            "maximum"
        }] = range.high.into();
    }
    schema
}

/// What one joint type requires and refuses.
fn for_joint(joint: JointType) -> Value {
    let is_type =
        json!({ "properties": { "type": { "const": joint_name(joint) } }, "required": ["type"] });
    json!({
        "if": { "properties": { "joint": is_type }, "required": ["joint"] },
        "then": demands("", joint),
    })
}

fn demands(pattern: &str, joint: JointType) -> Value {
    let mut required = Vec::new();
    let mut properties = Map::new();
    for key in keys::children(pattern) {
        match key.need(Some(joint)) {
            Need::Absent => {
                properties.insert(key.name().to_owned(), Value::Bool(false));
                continue;
            }
            Need::Required => required.push(key.name()),
            // A table that the defaults hold may still have keys that they do not.
            Need::Defaulted if states_some(key, joint) => required.push(key.name()),
            Need::Defaulted | Need::Optional => {}
        }
        let inner = match key.kind {
            Kind::Table => demands(key.path, joint),
            Kind::Tables => json!({ "items": demands(&format!("{}.*", key.path), joint) }),
            _ => continue,
        };
        if inner != json!({}) && inner != json!({ "items": {} }) {
            properties.insert(key.name().to_owned(), inner);
        }
    }
    let mut schema = json!({});
    if !required.is_empty() {
        schema["required"] = required.into();
    }
    if !properties.is_empty() {
        schema["properties"] = properties.into();
    }
    schema
}

fn states_some(key: &Key, joint: JointType) -> bool {
    matches!(key.kind, Kind::Table)
        && keys::children(key.path).any(|child| child.need(Some(joint)) == Need::Required)
}

fn add_defaults(schema: &mut Value, defaults: &Value) {
    let Some(tables) = defaults.as_object() else {
        return;
    };
    for (name, value) in tables {
        let property = &mut schema["properties"][name];
        if value.is_object() {
            add_defaults(property, value);
        } else {
            property["default"] = value.clone();
        }
    }
}

fn merge(into: &mut Value, from: Value) {
    if let (Value::Object(into), Value::Object(from)) = (into, from) {
        into.extend(from);
    }
}

/// The text of `objects/object.schema.json`.
pub fn json_schema_text() -> String {
    format!("{:#}\n", json_schema())
}
