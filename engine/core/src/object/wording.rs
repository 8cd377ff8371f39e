//! Values, keys and tables in the words of a fault.

use figment::value::Value;
use pubs_plugin::JointType;

use super::check::number;
use super::schema::joint_name;

/// A value in words, cut short where it is long.
pub(super) fn found(value: &Value) -> String {
    match value {
        Value::String(_, text) => format!("the text {:?}", shorten(text)),
        Value::Bool(_, flag) => flag.to_string(),
        Value::Dict(..) => "a table".to_owned(),
        Value::Array(_, list) => format!("the list {}", shorten(&written_list(list))),
        value => number(value).map_or("nothing".to_owned(), |number| number.to_string()),
    }
}

fn written_list(list: &[Value]) -> String {
    let written = |value: &Value| match value {
        Value::String(_, text) => format!("{text:?}"),
        Value::Array(_, list) => written_list(list),
        Value::Dict(..) => "{…}".to_owned(),
        value => found(value),
    };
    format!(
        "[{}]",
        list.iter().map(written).collect::<Vec<_>>().join(", ")
    )
}

fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}

/// The word most like `name`, where one is like it.
pub(super) fn nearest<'w>(name: &str, words: impl Iterator<Item = &'w str>) -> Option<&'w str> {
    const ALIKE: f64 = 0.8;
    words
        .map(|word| (strsim::jaro_winkler(name, word), word))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, word)| word)
}

pub(super) fn table_name(pattern: &str) -> String {
    match pattern.strip_suffix(".*") {
        Some(list) => format!("[[{list}]]"),
        None if pattern.is_empty() => "the top of the file".to_owned(),
        None if pattern == "action" => "[[action]]".to_owned(),
        None => format!("[{pattern}]"),
    }
}

/// A key without its unit.
pub(super) fn stem(name: &str) -> &str {
    name.strip_suffix("_deg")
        .or_else(|| name.strip_suffix("_m"))
        .unwrap_or(name)
}

/// "a revolute joint".
pub(super) fn with_article(joint: JointType) -> String {
    let article = if joint == JointType::Abstract {
        "an"
    } else {
        "a"
    };
    format!("{article} {} joint", joint_name(joint))
}

/// A sentence's start made fit for the middle of one; names and symbols keep their capitals.
pub(super) fn lower_first(sentence: &str) -> String {
    let mut letters = sentence.chars();
    let Some(first) = letters.next() else {
        return String::new();
    };
    let acronym = letters
        .clone()
        .next()
        .is_none_or(|second| second.is_uppercase() || second == '_');
    if acronym {
        sentence.to_owned()
    } else {
        first.to_lowercase().chain(letters).collect()
    }
}
