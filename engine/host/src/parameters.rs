//! An object's parameters against the JSON Schema of a plugin.
//!
//! A schema is read strictly: an object that lists `properties` and does not say otherwise takes no
//! others, so that a misspelt key is a fault and not silently ignored.

use std::fmt;

use jsonschema::JsonType;
use jsonschema::Validator;
use jsonschema::error::{TypeKind, ValidationErrorKind};
use serde_json::{Map, Value, json};

use crate::nearest::nearest;

/// Keys of `[observation]` that are the engine's own and no plugin's business.
const ENGINE_KEYS: [&str; 3] = ["model", "bias_sd_n", "correlation_m"];

/// A message in a plugin's or a schema's own words is cut short here, in bytes.
const LONGEST_MESSAGE: usize = 200;
/// A value that is quoted is cut short here, in bytes.
const LONGEST_VALUE: usize = 60;
/// So many of the known keys are named where none is like the one that was found.
const MOST_KEYS: usize = 12;

/// One thing wrong with the parameters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterFault {
    /// JSON pointer (RFC 6901) from the table that was checked, such as `/params/slope`; empty for
    /// the table itself.
    pub pointer: String,
    /// The value found and the rule.
    pub message: String,
}

impl fmt::Display for ParameterFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.pointer.as_str() {
            "" => formatter.write_str(&self.message),
            pointer => write!(formatter, "{pointer}: {}", self.message),
        }
    }
}

/// A compiled schema.
#[derive(Debug)]
pub(crate) struct ParameterSchema {
    given: Value,
    strict: Value,
    validator: Validator,
}

impl ParameterSchema {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let given: Value =
            serde_json::from_str(text).map_err(|error| format!("not JSON: {error}"))?;
        if !given.is_object() {
            return Err(format!("`{given}`, which is not a JSON object"));
        }
        let mut strict = given.clone();
        close(&mut strict, true);
        let options = jsonschema::options().offline();
        let validator = options
            .build(&strict)
            .map_err(|error| format!("not a valid schema: {error}"))?;
        Ok(Self {
            given,
            strict,
            validator,
        })
    }

    pub(crate) fn given(&self) -> &Value {
        &self.given
    }

    /// Faults of an `[observation]` table, the engine's own keys left out.
    pub(crate) fn check_observation(&self, table: &Value) -> Vec<ParameterFault> {
        let mut table = table.clone();
        if let Some(table) = table.as_object_mut() {
            table.retain(|key, _| !ENGINE_KEYS.contains(&key.as_str()));
        }
        self.check(&table)
    }

    /// Faults of `params` in a `[driver]` table; the pointers begin with `/params`.
    pub(crate) fn check_driver(&self, table: &Value) -> Vec<ParameterFault> {
        let none = json!({});
        let params = table
            .get("params")
            .filter(|params| !params.is_null())
            .unwrap_or(&none);
        let mut faults = self.check(params);
        for fault in &mut faults {
            fault.pointer.insert_str(0, "/params");
        }
        faults
    }

    fn check(&self, table: &Value) -> Vec<ParameterFault> {
        self.validator
            .iter_errors(table)
            .flat_map(|error| self.faults(&error))
            .collect()
    }

    /// What the schema says of the value.
    fn described(&self, error: &jsonschema::ValidationError<'_>) -> Option<&str> {
        let (of_value, _) = error.schema_path().as_str().rsplit_once('/')?;
        self.strict.pointer(of_value)?.get("description")?.as_str()
    }

    fn faults(&self, error: &jsonschema::ValidationError<'_>) -> Vec<ParameterFault> {
        let place = error.instance_path().as_str();
        match error.kind() {
            ValidationErrorKind::AdditionalProperties { unexpected } => unexpected
                .iter()
                .map(|key| ParameterFault {
                    pointer: format!("{place}/{}", escape(key)),
                    message: self.unknown_key(key, error),
                })
                .collect(),
            ValidationErrorKind::Required { property } => {
                let message = format!("`{}` is missing", property.as_str().unwrap_or_default());
                vec![ParameterFault {
                    pointer: place.to_owned(),
                    message,
                }]
            }
            kind => vec![ParameterFault {
                pointer: place.to_owned(),
                message: wrong_value(place, error.instance(), kind, self.described(error))
                    .unwrap_or_else(|| shortened(&error.to_string(), LONGEST_MESSAGE)),
            }],
        }
    }

    fn unknown_key(&self, key: &str, error: &jsonschema::ValidationError<'_>) -> String {
        let value = error.instance().get(key).unwrap_or(&Value::Null);
        let mut message = format!(
            "the plugin knows no key `{key}` (value {})",
            shortened(&value.to_string(), LONGEST_VALUE)
        );
        let known = self.known_keys(error.schema_path().as_str());
        if let Some(near) = nearest(key, known.iter().copied()) {
            message += &format!("; did you mean `{near}`?");
        } else if known.len() > MOST_KEYS {
            message += &format!(
                "; it knows {} and {} more",
                known[..MOST_KEYS].join(", "),
                known.len() - MOST_KEYS
            );
        } else if !known.is_empty() {
            message += &format!("; it knows {}", known.join(", "));
        } else {
            message += "; it takes none here";
        }
        message
    }

    /// The properties beside the `additionalProperties` at this place of the schema.
    fn known_keys(&self, keyword: &str) -> Vec<&str> {
        let parent = keyword.rsplit_once('/').map_or("", |(parent, _)| parent);
        let properties = self
            .strict
            .pointer(&format!("{parent}/properties"))
            .and_then(Value::as_object);
        properties
            .map(|keys| keys.keys().map(String::as_str).collect())
            .unwrap_or_default()
    }
}

fn escape(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}

/// The value found and the rule, for the rules that schemas mostly have.
fn wrong_value(
    place: &str,
    value: &Value,
    kind: &ValidationErrorKind,
    description: Option<&str>,
) -> Option<String> {
    let rule = match kind {
        ValidationErrorKind::Enum { options } => {
            let words: Vec<String> = options.as_array()?.iter().map(Value::to_string).collect();
            format!("one of {}", words.join(", "))
        }
        ValidationErrorKind::Type { kind } => {
            let names: Vec<&str> = match kind {
                TypeKind::Single(one) => vec![in_words(*one)],
                TypeKind::Multiple(several) => several.iter().map(in_words).collect(),
            };
            names.join(" or ")
        }
        // What a pattern means its author has said in words.
        ValidationErrorKind::Pattern { .. } => description?.to_owned(),
        ValidationErrorKind::Minimum { limit } => format!("{limit} or more"),
        ValidationErrorKind::Maximum { limit } => format!("{limit} or less"),
        ValidationErrorKind::ExclusiveMinimum { limit } => format!("above {limit}"),
        ValidationErrorKind::ExclusiveMaximum { limit } => format!("below {limit}"),
        _ => return None,
    };
    let key = place.rsplit('/').next().filter(|key| !key.is_empty())?;
    let found = shortened(&value.to_string(), LONGEST_VALUE);
    Some(format!("`{key}` is {found}; it must be {rule}"))
}

/// A type of JSON with its article.
fn in_words(kind: JsonType) -> &'static str {
    match kind {
        JsonType::Array => "a list",
        JsonType::Boolean => "true or false",
        JsonType::Integer => "a whole number",
        JsonType::Null => "nothing",
        JsonType::Number => "a number",
        JsonType::Object => "a table",
        JsonType::String => "a text",
    }
}

/// A message that quotes a whole table helps nobody.
fn shortened(text: &str, longest: usize) -> String {
    if text.len() <= longest {
        return text.to_owned();
    }
    format!("{} …", &text[..text.floor_char_boundary(longest)])
}

/// Whether the schema says elsewhere what else an object may hold.
fn is_open(schema: &Map<String, Value>) -> bool {
    let openers = [
        "additionalProperties",
        "unevaluatedProperties",
        "patternProperties",
    ];
    let combiners = ["$ref", "$dynamicRef", "allOf", "anyOf", "oneOf", "if"];
    openers
        .iter()
        .chain(&combiners)
        .any(|key| schema.contains_key(*key))
}

/// Forbids unnamed properties in every object schema that lists its properties. Parts of `allOf`
/// and its like are left alone, since each knows only some of the keys.
fn close(schema: &mut Value, root: bool) {
    let Some(schema) = schema.as_object_mut() else {
        return;
    };
    if (root || schema.contains_key("properties")) && !is_open(schema) {
        schema.insert("additionalProperties".to_owned(), Value::Bool(false));
    }
    for key in ["properties", "patternProperties", "$defs", "definitions"] {
        let children = schema.get_mut(key).and_then(Value::as_object_mut);
        children
            .into_iter()
            .flat_map(Map::values_mut)
            .for_each(|child| close(child, false));
    }
    for key in ["items", "additionalProperties"] {
        schema
            .get_mut(key)
            .into_iter()
            .for_each(|child| close(child, false));
    }
    let positions = schema.get_mut("prefixItems").and_then(Value::as_array_mut);
    positions
        .into_iter()
        .flatten()
        .for_each(|child| close(child, false));
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn schema() -> ParameterSchema {
        ParameterSchema::parse(
            r##"{
                "type": "object",
                "properties": {
                    "params": {
                        "type": "object",
                        "properties": {
                            "slope": { "type": "number", "minimum": 0 },
                            "name": { "enum": ["left", "right"] }
                        },
                        "required": ["slope"]
                    },
                    "segment": { "type": "array", "items": { "$ref": "#/$defs/segment" } }
                },
                "$defs": { "segment": { "properties": { "from_deg": { "type": "number" } } } }
            }"##,
        )
        .unwrap()
    }

    #[test]
    fn every_fault_is_told_at_its_place() {
        let good = json!({ "model": "line", "bias_sd_n": 0.5, "correlation_m": 0, "params": { "slope": 1 } });
        assert_eq!(schema().check_observation(&good), []);
        let bad = json!({
            "model": "line",
            "parms": {},
            "params": { "slope": -1, "name": "up", "a/b": [1] },
            "segment": [{ "from_deg": 1 }, { "form_deg": 2, "from_deg": "x" }],
        });
        let mut faults: Vec<String> = schema()
            .check_observation(&bad)
            .iter()
            .map(ToString::to_string)
            .collect();
        faults.sort();
        let expected = [
            ("/params/a~1b: ", "no key `a/b` (value [1])"),
            (
                "/params/name: ",
                "`name` is \"up\"; it must be one of \"left\", \"right\"",
            ),
            ("/params/slope: ", "`slope` is -1; it must be 0 or more"),
            ("/parms: ", "did you mean `params`?"),
            ("/segment/1/form_deg: ", "did you mean `from_deg`?"),
            (
                "/segment/1/from_deg: ",
                "`from_deg` is \"x\"; it must be a number",
            ),
        ];
        assert_eq!(faults.len(), expected.len(), "{faults:#?}");
        for (fault, (place, words)) in faults.iter().zip(expected) {
            assert!(
                fault.starts_with(place) && fault.contains(words),
                "{fault} should be {place}... {words}"
            );
        }
        let missing = schema().check_observation(&json!({ "params": {} }));
        assert_eq!(
            missing,
            [ParameterFault {
                pointer: "/params".into(),
                message: "`slope` is missing".into()
            }]
        );
    }

    #[test]
    fn a_driver_is_checked_by_its_params() {
        let schema =
            ParameterSchema::parse(r#"{ "properties": { "world": { "type": "string" } } }"#)
                .unwrap();
        assert_eq!(schema.check_driver(&json!({ "plugin": "x" })), []);
        assert_eq!(
            schema.check_driver(&json!({ "plugin": "x", "params": { "world": "door2" } })),
            []
        );
        let faults = schema.check_driver(&json!({ "params": { "wrld": 1 } }));
        assert_eq!(faults[0].pointer, "/params/wrld");
        let empty = ParameterSchema::parse("{}").unwrap();
        assert_eq!(
            empty.check_driver(&json!({ "params": { "x": 1 } })).len(),
            1,
            "an empty schema takes nothing"
        );
    }

    #[test]
    fn a_schema_may_stay_open_and_may_be_wrong() {
        let open = ParameterSchema::parse(r#"{ "additionalProperties": true, "properties": {} }"#)
            .unwrap();
        assert_eq!(open.check_driver(&json!({ "params": { "x": 1 } })), []);
        for bad in [
            "",
            "7",
            "{ \"type\": \"nonsense\" }",
            "{ \"$ref\": \"https://nowhere.invalid/s.json\" }",
        ] {
            assert!(
                ParameterSchema::parse(bad).is_err(),
                "{bad:?} was taken for a schema"
            );
        }
    }
}
