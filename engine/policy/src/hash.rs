//! sha256 sums, and the one text of a JSON value that they are taken of.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Number, Value};
use sha2::{Digest, Sha256};

/// Whole numbers up to here have one `f64` each.
const LARGEST_EXACT: f64 = 9_007_199_254_740_992.0;

/// Lower-case hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            _ = write!(text, "{byte:02x}");
            text
        })
}

/// The sha256 sum of `bytes` in lower-case hexadecimal.
#[must_use]
pub fn sha256_hex(bytes: impl AsRef<[u8]>) -> String {
    hex(&Sha256::digest(bytes))
}

/// The sha256 sum of a task, or of any JSON value: equal values have equal sums, whatever the
/// order of their keys.
#[must_use]
pub fn task_hash(json: &Value) -> String {
    sha256_hex(canonical_json(json))
}

/// The one text of a JSON value: keys sorted, no spaces, whole numbers without a fraction.
#[must_use]
pub fn canonical_json(json: &Value) -> String {
    match json {
        Value::Object(members) => {
            let sorted: BTreeMap<&String, &Value> = members.iter().collect();
            let members = sorted
                .iter()
                .map(|(key, value)| format!("{}:{}", quoted(key), canonical_json(value)));
            format!("{{{}}}", members.collect::<Vec<_>>().join(","))
        }
        Value::Array(values) => {
            format!(
                "[{}]",
                values
                    .iter()
                    .map(canonical_json)
                    .collect::<Vec<_>>()
                    .join(",")
            )
        }
        Value::Number(number) => canonical_number(number),
        Value::String(text) => quoted(text),
        Value::Bool(_) | Value::Null => json.to_string(),
    }
}

fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// `100` and `100.0` in an object file mean the same and must hash the same.
fn canonical_number(number: &Number) -> String {
    match number.as_f64() {
        Some(value) if number.is_f64() && value.fract() == 0.0 && value.abs() < LARGEST_EXACT => {
            format!("{}", value as i64)
        }
        _ => number.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn sums_are_those_of_the_standard() {
        // FIPS 180-2, appendix B.1.
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256_hex("abc"), abc);
        assert_eq!(task_hash(&json!({})), sha256_hex("{}"));
    }

    #[test]
    fn canonical_text_by_hand() {
        let cases = [
            (
                json!({"b": [1.0, 2.5, -0.0], "a": {"z": null, "y": true}}),
                r#"{"a":{"y":true,"z":null},"b":[1,2.5,0]}"#,
            ),
            (json!("a\"\u{e9}\n"), "\"a\\\"\u{e9}\\n\""),
            (json!(100), "100"),
            (json!(100.0), "100"),
            (json!(1e300), "1e+300"),
            (json!(u64::MAX), "18446744073709551615"),
        ];
        for (value, text) in cases {
            assert_eq!(canonical_json(&value), text);
        }
    }
}
