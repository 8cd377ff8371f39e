//! A TOML text as a tree of values, with the place of each key and value in the text.

use std::collections::BTreeMap;
use std::ops::Range;

use figment::value::{Dict, Value};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where a key and its value stand, in bytes of the text.
#[derive(Debug, Clone)]
pub(super) struct Span {
    /// The key; for an element of a list, the element.
    pub key: Range<usize>,
    /// The value; for a table under a header, the header.
    pub value: Range<usize>,
}

/// A parsed text.
#[derive(Debug, Default)]
pub(super) struct Document {
    /// The values.
    pub values: Dict,
    /// Key path (`joint.limits_deg`, `action.3.move`) to place.
    pub spans: BTreeMap<String, Span>,
}

/// What the parser says of a text that is not TOML, and where.
#[derive(Debug)]
pub(super) struct SyntaxError {
    pub message: String,
    pub span: Option<Range<usize>>,
}

/// Parses a whole text.
///
/// # Errors
/// All that the parser finds wrong, in the order of the text.
pub(super) fn parse(text: &str) -> Result<Document, Vec<SyntaxError>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        return Err(errors.iter().map(syntax_error).collect());
    }
    let mut document = Document::default();
    document.values = document.table("", table.get_ref());
    Ok(document)
}

/// Parses one value, as it would stand after `key =`; `None` where it is not TOML.
pub(super) fn parse_value(text: &str) -> Option<Value> {
    let value = DeValue::parse(text).ok()?;
    let mut document = Document::default();
    Some(document.value("", value.get_ref()))
}

/// `parent.name`, or `name` at the root.
pub(super) fn join(parent: &str, name: &str) -> String {
    if parent.is_empty() {
        name.to_owned()
    } else {
        format!("{parent}.{name}")
    }
}

fn syntax_error(error: &toml::de::Error) -> SyntaxError {
    SyntaxError {
        message: error.message().to_owned(),
        span: error.span(),
    }
}

impl Document {
    fn table(&mut self, path: &str, table: &DeTable<'_>) -> Dict {
        let mut dict = Dict::new();
        for (key, value) in table {
            let path = join(path, key.get_ref());
            let values = self.spanned(&path, key.span(), value);
            dict.insert(key.get_ref().to_string(), values);
        }
        dict
    }

    fn spanned(&mut self, path: &str, key: Range<usize>, value: &Spanned<DeValue<'_>>) -> Value {
        self.spans.insert(
            path.to_owned(),
            Span {
                key,
                value: value.span(),
            },
        );
        self.value(path, value.get_ref())
    }

    fn value(&mut self, path: &str, value: &DeValue<'_>) -> Value {
        match value {
            DeValue::String(text) => Value::from(text.as_ref()),
            DeValue::Boolean(flag) => Value::from(*flag),
            DeValue::Datetime(date) => Value::from(date.to_string()),
            DeValue::Integer(number) => integer(number.as_str(), number.radix()),
            // What is too large for an `f64` becomes infinite, and so is in no range.
            DeValue::Float(number) => Value::from(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Array(list) => {
                let element = |(index, element): (usize, &Spanned<DeValue<'_>>)| {
                    let path = join(path, &index.to_string());
                    self.spanned(&path, element.span(), element)
                };
                Value::from(list.iter().enumerate().map(element).collect::<Vec<_>>())
            }
            DeValue::Table(table) => Value::from(self.table(path, table)),
        }
    }
}

/// A whole number; as a floating one where no `i64` holds it, since then it is no count either.
fn integer(digits: &str, radix: u32) -> Value {
    match i64::from_str_radix(digits, radix) {
        Ok(number) => Value::from(number),
        Err(_) => Value::from(digits.parse().unwrap_or(f64::INFINITY)),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn text_at<'t>(text: &'t str, document: &Document, path: &str) -> (&'t str, &'t str) {
        let span = &document.spans[path];
        (&text[span.key.clone()], &text[span.value.clone()])
    }

    #[test]
    fn keys_and_values_are_found_where_they_stand() {
        let text = "a = 1\n[t]\nb = [2.5, \"x\"]\n[[l]]\nc = true\n[[l]]\nc = false\n[p.q]\nd = { e = 0x10 }\n";
        let document = parse(text).unwrap();
        let cases = [
            ("a", "a", "1"),
            ("t.b", "b", "[2.5, \"x\"]"),
            ("t.b.1", "\"x\"", "\"x\""),
            ("l.1.c", "c", "false"),
            ("p.q.d.e", "e", "0x10"),
        ];
        for (path, key, value) in cases {
            assert_eq!(text_at(text, &document, path), (key, value), "{path}");
        }
        let line = |path: &str| {
            text[..document.spans[path].value.start]
                .matches('\n')
                .count()
                + 1
        };
        assert_eq!(
            (line("t"), line("l.0"), line("l.1"), line("p.q")),
            (2, 4, 6, 8)
        );
    }

    #[test]
    fn several_syntax_errors_are_all_reported() {
        let errors = parse("a = \nb = 1\nc = = 2\n").unwrap_err();
        let lines: Vec<usize> = errors
            .iter()
            .filter_map(|error| error.span.clone())
            .map(|span| "a = \nb = 1\nc = = 2\n"[..span.start].matches('\n').count() + 1)
            .collect();
        assert!(lines.contains(&1) && lines.contains(&3), "{errors:?}");
    }

    #[test]
    fn numbers_of_every_notation() {
        let text = "a = 1_000\nb = 0xff\nc = -7\nd = 1e999\ne = 99999999999999999999\nf = 1_0.5\ng = +inf\n";
        let values = parse(text).unwrap().values;
        let number = |name: &str| crate::object::check::number(&values[name]).unwrap();
        let found = ["a", "b", "c", "d", "e", "f", "g"].map(number);
        assert_eq!(
            found,
            [
                1000.0,
                255.0,
                -7.0,
                f64::INFINITY,
                1e20,
                10.5,
                f64::INFINITY
            ]
        );
        assert!(
            values["e"].to_i128().is_none(),
            "a count that fits no i64 is no count"
        );
    }

    #[test]
    fn a_single_value_is_toml_or_nothing() {
        assert_eq!(parse_value("500").unwrap().to_i128(), Some(500));
        assert_eq!(
            parse_value("[0, 1.5]").unwrap().as_array().map(<[_]>::len),
            Some(2)
        );
        assert!(
            parse_value("flat").is_none(),
            "a bare word is no TOML value"
        );
        assert!(
            parse_value("1\nb = 2").is_none(),
            "a second line must not slip in"
        );
    }
}
