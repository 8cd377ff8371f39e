//! The page for object authors, `objects/README.md`, has every key as the key table has it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use figment::value::Value;

use super::super::keys::KEYS;
use super::super::layers::{DEFAULTS, defaults_for};
use super::super::schema::{JOINTS, Key, Kind, Need, joint_name};
use super::super::{check, document};

/// Only the rows of keys have so many; the page has other tables.
const COLUMNS: usize = 5;

/// A row of the page: key, joints that have it, default, unit, meaning.
fn row(key: &Key) -> String {
    let joints: Vec<&str> = JOINTS
        .into_iter()
        .filter(|joint| key.need(Some(*joint)) != Need::Absent)
        .map(joint_name)
        .collect();
    let joints = match joints.len() {
        3 => "all".to_owned(),
        _ => joints.join(", "),
    };
    let (path, unit, doc) = (key.path, key.unit, key.doc);
    let default = default(key);
    format!("| `{path}` | {joints} | {default} | {unit} | {doc} |")
}

fn default(key: &Key) -> String {
    let needs = JOINTS.map(|joint| key.need(Some(joint)));
    if matches!(key.kind, Kind::Table) && needs.contains(&Need::Defaulted) {
        return String::new();
    }
    match needs {
        [Need::Defaulted, Need::Defaulted, Need::Required] => {
            format!("{}; abstract: required", value(key))
        }
        needs if needs.contains(&Need::Defaulted) => value(key),
        [Need::Required, Need::Required, Need::Optional] => {
            "required; abstract: may be left out".to_owned()
        }
        needs if needs.contains(&Need::Required) => "required".to_owned(),
        _ => "may be left out".to_owned(),
    }
}

fn value(key: &Key) -> String {
    let joint = JOINTS
        .into_iter()
        .find(|joint| key.need(Some(*joint)) == Need::Defaulted);
    let mut value = Value::from(defaults_for(joint));
    for part in key.path.split('.') {
        value = value
            .as_dict()
            .and_then(|dict| dict.get(part))
            .cloned()
            .unwrap_or_else(|| panic!("`{}` has no default in:\n{DEFAULTS}", key.path));
    }
    format!("`{}`", written(&value))
}

fn written(value: &Value) -> String {
    match value {
        Value::String(_, text) => format!("\"{text}\""),
        Value::Array(_, list) => {
            let list: Vec<String> = list.iter().map(written).collect();
            format!("[{}]", list.join(", "))
        }
        value => check::number(value).map_or_else(
            || panic!("a default that is neither text, list nor number: {value:?}"),
            |number| number.to_string(),
        ),
    }
}

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../objects/README.md");
    fs::read_to_string(path).unwrap()
}

#[test]
fn the_page_for_authors_has_every_key_and_no_other() {
    let page = page();
    let found: BTreeSet<&str> = page
        .lines()
        .filter(|line| line.starts_with("| `"))
        .filter(|line| line.matches('|').count() == COLUMNS + 1)
        .collect();
    let expected: Vec<String> = KEYS.iter().map(row).collect();
    let missing: Vec<&str> = expected
        .iter()
        .map(String::as_str)
        .filter(|row| !found.contains(row))
        .collect();
    let unknown: Vec<&&str> = found
        .iter()
        .filter(|row| !expected.iter().any(|known| known == *row))
        .collect();
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "objects/README.md lacks these rows:\n{}\nand has these, which the key table does not:\n{unknown:#?}",
        missing.join("\n")
    );
}

#[test]
fn the_page_describes_every_key_of_a_segment() {
    let schema =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../plugins/segments/src/params.schema.json");
    let schema: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(schema).unwrap()).unwrap();
    let keys = schema["properties"]["segment"]["items"]["properties"]
        .as_object()
        .unwrap();
    let page = page();
    let found: BTreeSet<&str> = page
        .lines()
        .filter_map(|line| line.strip_prefix("| `observation.segment.*."))
        .filter_map(|row| row.split('`').next())
        .collect();
    let arm = |key: &&str| !matches!(*key, "from" | "to" | "position");
    let expected: BTreeSet<&str> = keys.keys().map(String::as_str).filter(arm).collect();
    assert_eq!(
        found, expected,
        "keys of [[observation.segment]] in objects/README.md"
    );
}

#[test]
fn examples_of_the_page_are_toml() {
    let page = page();
    let mut blocks = page.split("```toml\n").skip(1);
    assert!(blocks.clone().count() > 0, "no example on the page");
    let broken = blocks.find(|block| {
        let text = block.split("```").next().unwrap_or_default();
        document::parse(text).is_err()
    });
    assert_eq!(broken, None);
}
