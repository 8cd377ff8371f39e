//! `[source]`: what the numbers of an object file come from.

use toml_edit::{Item, Table, TableLike, Value};

use super::layout::Layout;
use super::{EditError, table};

/// `text` with these values of `kind` and `sensor` in `[source]`; keys that are not there are
/// added behind the others, and the table before the others.
///
/// # Errors
/// Where the text is no TOML, or `source` and its keys are not a table of plain values.
pub fn with_source(text: &str, kind: &str, sensor: &str) -> Result<String, EditError> {
    let text = with_value(text, "kind", kind)?;
    with_value(&text, "sensor", sensor)
}

fn with_value(text: &str, key: &str, value: &str) -> Result<String, EditError> {
    let layout = Layout::of(text)?;
    let value = Value::from(value).to_string();
    let entry = format!("{key} = {value}");
    let item = layout.root().get("source");
    let source = table(item, "source", true)?;
    let edited = match source.and_then(|source| source.get(key)) {
        Some(Item::Value(old)) => {
            let span = old.span().unwrap_or_default();
            spliced(text, span.start, span.end, &value)
        }
        Some(other) => {
            return Err(EditError::Notation {
                key: format!("source.{key}"),
                found: other.type_name(),
                wanted: "a plain value",
            });
        }
        None => match (item, source) {
            (Some(Item::Table(source)), _) => added_line(text, &layout, source, &entry),
            (Some(_), Some(source)) => added_inline(text, item, source, &entry),
            _ => {
                let place = layout.start_of_headers();
                let block = layout.lines(&["[source]".to_owned(), entry]);
                layout.joined(&text[..place], &block, &text[place..])
            }
        },
    };
    Layout::of(&edited)?;
    Ok(edited)
}

fn spliced(text: &str, from: usize, to: usize, new: &str) -> String {
    format!("{}{new}{}", &text[..from], &text[to..])
}

/// Where the last value of a table ends, if it has one.
fn last_end(table: &dyn TableLike) -> Option<usize> {
    let spans = table.iter().filter_map(|(_, item)| item.span());
    spans.map(|span| span.end).max()
}

/// A line behind the last of a table, whose keys may be dotted ones of the root table.
fn added_line(text: &str, layout: &Layout, source: &Table, entry: &str) -> String {
    let prefix = if source.is_dotted() { "source." } else { "" };
    let header_end = source.span().unwrap_or_default().end;
    let place = layout.line_end(last_end(source).unwrap_or(header_end));
    let line = layout.lines(&[format!("{prefix}{entry}")]);
    if text[..place].ends_with('\n') {
        return spliced(text, place, place, &line);
    }
    let line = line.trim_end();
    format!("{text}{}{line}", layout.lines(&[String::new()]))
}

fn added_inline(text: &str, item: Option<&Item>, source: &dyn TableLike, entry: &str) -> String {
    let start = item.and_then(Item::span).unwrap_or_default().start;
    match last_end(source) {
        Some(end) => spliced(text, end, end, &format!(", {entry}")),
        None => spliced(text, start + 1, start + 1, &format!(" {entry} ")),
    }
}
