//! The merged values against the key table: unknown keys, types, ranges, what is missing.

use figment::value::{Dict, Num, Value};
use pubs_plugin::JointType;

use super::document::join;
use super::fault::Fault;
use super::keys;
use super::layers::{Merged, Origin, visit};
use super::places::{Part, Places};
use super::schema::{Key, Kind, Need, Range};
use super::wording::{found, lower_first, nearest, stem, table_name, with_article};

/// Checks every value by itself; rules between values are [`rules`](super::rules).
pub(super) fn check(merged: &Merged, places: &Places) -> Vec<Fault> {
    let mut checker = Checker {
        joint: merged.joint,
        places,
        faults: Vec::new(),
    };
    checker.table("", "", &merged.values);
    checker.faults
}

struct Checker<'a> {
    joint: Option<JointType>,
    places: &'a Places,
    faults: Vec<Fault>,
}

impl Checker<'_> {
    /// `pattern` is the table's path in the key table, `path` the one in the file.
    fn table(&mut self, pattern: &str, path: &str, values: &Dict) {
        for (name, value) in values {
            let key_path = join(path, name);
            match keys::find(&join(pattern, name)) {
                None => self.unknown(pattern, &key_path, name),
                Some(key) if key.need(self.joint) == Need::Absent => self.absent(key, &key_path),
                Some(key) => self.value(key, &key_path, value),
            }
        }
        for key in keys::children(pattern) {
            if key.need(self.joint) == Need::Required && !values.contains_key(key.name()) {
                self.missing(key, &join(path, key.name()));
            }
        }
    }

    fn value(&mut self, key: &Key, path: &str, value: &Value) {
        match (key.kind, value) {
            (Kind::Table, Value::Dict(_, inner)) => self.table(key.path, path, inner),
            (Kind::Tables, Value::Array(_, list)) => self.tables(key, path, list),
            (Kind::Plugin, value) => self.finite(path, value),
            (kind, value) if holds(&kind, value) => {}
            (_, value) => self.wrong(key, path, value),
        }
    }

    fn tables(&mut self, key: &Key, path: &str, list: &[Value]) {
        let pattern = join(key.path, "*");
        for (index, element) in list.iter().enumerate() {
            let path = join(path, &index.to_string());
            match element {
                Value::Dict(_, inner) => self.table(&pattern, &path, inner),
                _ => self.fault(
                    &path,
                    Part::Value,
                    format!("`{path}` is {}; it must be a table", found(element)),
                    format!("write each as a [[{}]] table", key.path),
                ),
            }
        }
    }

    /// NaN and the infinities do not survive the way to a plugin (JSON has none).
    fn finite(&mut self, path: &str, value: &Value) {
        let mut at_fault = Vec::new();
        visit(path, value, &mut |path, value| {
            if number(value).is_some_and(|number| !number.is_finite()) {
                at_fault.push((path.to_owned(), found(value)));
            }
        });
        for (path, found) in at_fault {
            self.fault(
                &path,
                Part::Value,
                format!("`{path}` is {found}; it must be a finite number"),
                "write a number",
            );
        }
    }

    fn wrong(&mut self, key: &Key, path: &str, value: &Value) {
        let typed = self.places.origins.get(path).and_then(Origin::typed);
        let by = typed.map_or(String::new(), |typed| format!(", by `{typed}`"));
        let mut help = key.doc.to_owned();
        if let (Kind::Choice(words), Some(found)) = (key.kind, value.as_str())
            && let Some(word) = nearest(found, words.iter().copied())
        {
            help = format!("did you mean \"{word}\"? {}", key.doc);
        }
        let message = format!(
            "`{path}` is {}{by}; it must be {}",
            found(value),
            key.describe()
        );
        self.fault(path, Part::Value, message, help);
    }

    fn unknown(&mut self, pattern: &str, path: &str, name: &str) {
        let here: Vec<&str> = keys::children(pattern)
            .filter(|key| key.need(self.joint) != Need::Absent)
            .map(Key::name)
            .collect();
        let elsewhere = keys::KEYS
            .iter()
            .find(|key| key.name() == name && key.need(self.joint) != Need::Absent);
        let help = match (nearest(name, here.iter().copied()), elsewhere) {
            (Some(near), _) => format!("did you mean `{near}`?"),
            (None, Some(key)) if key.parent().is_empty() => {
                format!("`{name}` belongs at the top of the file")
            }
            (None, Some(key)) => format!("`{name}` belongs in {}", table_name(key.parent())),
            (None, None) => format!("{} takes {}", table_name(pattern), here.join(", ")),
        };
        self.fault(path, Part::Key, format!("unknown key `{path}`"), help);
    }

    fn absent(&mut self, key: &Key, path: &str) {
        let joint = self.joint.map_or("this joint".to_owned(), with_article);
        let twin = keys::children(key.parent()).find(|other| {
            stem(other.name()) == stem(key.name()) && other.need(self.joint) != Need::Absent
        });
        let help = match twin {
            Some(twin) => format!("write `{}`: {}", twin.name(), lower_first(twin.doc)),
            None => format!("remove it; only {} objects have it", key.joints()),
        };
        let message = format!("`{path}` has no meaning for {joint}");
        self.fault(path, Part::Key, message, help);
    }

    fn missing(&mut self, key: &Key, path: &str) {
        let help = match (key.kind, key.parent()) {
            (Kind::Table | Kind::Tables, _) => {
                let pattern = if matches!(key.kind, Kind::Tables) {
                    join(key.path, "*")
                } else {
                    key.path.to_owned()
                };
                let required: Vec<&str> = keys::children(&pattern)
                    .filter(|child| child.need(self.joint) == Need::Required)
                    .map(Key::name)
                    .collect();
                format!(
                    "add {} with {}: {}",
                    table_name(key.path),
                    required.join(", "),
                    lower_first(key.doc)
                )
            }
            (_, "") => format!(
                "add `{} = …` at the top of the file, {}: {}",
                key.name(),
                key.describe(),
                lower_first(key.doc)
            ),
            (_, parent) => format!(
                "add `{} = …` to {}, {}: {}",
                key.name(),
                table_name(parent),
                key.describe(),
                lower_first(key.doc)
            ),
        };
        self.fault(path, Part::Key, format!("`{path}` is missing"), help);
    }

    fn fault(
        &mut self,
        path: &str,
        part: Part,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.faults
            .push(self.places.fault(path, part, message, help));
    }
}

/// Whether a value is what a key may hold; tables and plugin values are looked into elsewhere.
fn holds(kind: &Kind, value: &Value) -> bool {
    match kind {
        Kind::Table | Kind::Tables => false,
        Kind::Plugin => true,
        Kind::Text => value.as_str().is_some_and(|text| !text.trim().is_empty()),
        Kind::Name => value.as_str().is_some_and(is_name),
        Kind::Choice(words) => value.as_str().is_some_and(|text| words.contains(&text)),
        Kind::Flag => value.to_bool().is_some(),
        Kind::Number(range) => number(value).is_some_and(|number| range.contains(number)),
        Kind::Whole(range) => whole_in(value, range),
        Kind::Numbers(count, range) => value.as_array().is_some_and(|list| {
            list.len() == *count
                && list
                    .iter()
                    .all(|value| number(value).is_some_and(|it| range.contains(it)))
        }),
        Kind::Wholes(range) => value
            .as_array()
            .is_some_and(|list| !list.is_empty() && list.iter().all(|it| whole_in(it, range))),
    }
}

fn is_name(text: &str) -> bool {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    !text.is_empty() && text.chars().all(fits)
}

/// A number, whole or not.
pub(super) fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Num(_, Num::I64(whole)) => Some(*whole as f64),
        Value::Num(_, Num::F64(number)) => Some(*number),
        _ => None,
    }
}

/// A number written without a fraction; `300.0` is refused, as it would not be read as a count.
fn whole_in(value: &Value, range: &Range) -> bool {
    matches!(value, Value::Num(_, Num::I64(_)))
        && number(value).is_some_and(|it| range.contains(it))
}
