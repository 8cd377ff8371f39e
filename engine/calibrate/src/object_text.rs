//! Editing an object file in place: its segments and its source are replaced, every other byte
//! stays.
//!
//! The file is parsed only to learn where things are; the edit itself is a splice of the text, so
//! comments, order, blank lines and line endings cannot change. What was written by an earlier
//! edit is found again by [`MARK`], so that editing twice gives the same bytes as editing once.

mod difference;
mod layout;
mod read;
mod source;
mod tables;
mod write;

use std::ops::Range;

use toml_edit::{Item, TableLike};

use crate::Segment;
use layout::Layout;

pub use difference::difference;
pub use read::{ReadError, segments_of};
pub use source::with_source;
pub use write::write_atomically;

/// First line of the comment above generated segments. The block of comment lines that it begins
/// is replaced by the next edit.
pub const MARK: &str =
    "# Segments written by `pubs-engine calibrate`, which replaces them and this comment.";

/// The unit in which a file gives joint states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateUnit {
    /// For a revolute joint.
    Degrees,
    /// For a prismatic joint.
    Metres,
}

impl StateUnit {
    /// `from` becomes `from_deg` or `from_m`.
    pub fn key(self, stem: &str) -> String {
        match self {
            Self::Degrees => format!("{stem}_deg"),
            Self::Metres => format!("{stem}_m"),
        }
    }

    /// From the file's unit to rad or m.
    pub fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Degrees => value.to_radians(),
            Self::Metres => value,
        }
    }

    /// From rad or m to the file's unit.
    pub fn from_si(self, value: f64) -> f64 {
        match self {
            Self::Degrees => value.to_degrees(),
            Self::Metres => value,
        }
    }

    /// Digits after the point that a state is written with.
    fn decimals(self) -> usize {
        match self {
            Self::Degrees => 2,
            Self::Metres => 5,
        }
    }
}

/// Why a file cannot be edited. It is left as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The text is no TOML, or would be none after the edit.
    #[error("{0}")]
    Toml(#[from] toml_edit::TomlError),
    /// A key that must hold a table, or a plain value, holds something else.
    #[error("`{key}` is {found}; write it as {wanted}")]
    Notation {
        /// The key.
        key: String,
        /// What it holds.
        found: &'static str,
        /// What can be edited.
        wanted: &'static str,
    },
    /// An object without segments has no model.
    #[error("there is no segment to write")]
    NoSegments,
    /// A segment that no file can hold.
    #[error("the segment of {action} {channel} from {from} to {to} (SI): {fault}")]
    Segment {
        /// Its action.
        action: String,
        /// Its channel.
        channel: &'static str,
        /// Its start.
        from: f64,
        /// Its end.
        to: f64,
        /// What is wrong.
        fault: &'static str,
    },
}

/// `text` with `segments` in place of all that it holds, as tables or as an inline list.
///
/// They go where the first one was, else to the end of `[observation]`, below [`MARK`] and the
/// lines of `heading` as comments. A comment directly above a segment belongs to it and goes with
/// it; one above the first segment stays where no earlier edit wrote it. Within an action and
/// channel the segments are in increasing order; states are rounded such that they still tile the
/// range and reach its ends, and a segment or position that rounding makes one with its neighbour
/// is left out.
///
/// # Errors
/// Where the text is no TOML, `observation` is an inline table, or a segment makes no sense.
pub fn with_segments(
    text: &str,
    unit: StateUnit,
    segments: &[Segment],
    heading: &str,
) -> Result<String, EditError> {
    let layout = Layout::of(text)?;
    let observation = table(layout.root().get("observation"), "observation", false)?;
    let block = block(&layout, unit, segments, heading)?;
    let old = observation.and_then(|table| table.get("segment"));
    let mut removed = marked(text);
    let place = match old {
        Some(Item::ArrayOfTables(tables)) if !tables.is_empty() => {
            let spans = tables.iter().filter_map(|table| table.span());
            take_tables(
                &layout,
                spans.map(|span| span.start).collect(),
                &mut removed,
            )
        }
        Some(item) => {
            let span = item.span().unwrap_or_default();
            removed.push(layout.line_start(span.start)..layout.line_end(span.end));
            layout.end_of("observation")
        }
        None => layout.end_of("observation"),
    };
    let before = without(text, 0..place, &removed);
    let after = without(text, place..text.len(), &removed);
    let joined = layout.joined(&before, &block, &after);
    Layout::of(&joined)?;
    Ok(joined)
}

/// Notes where tables starting at `starts` are to be removed, and returns the place of the first.
fn take_tables(layout: &Layout, starts: Vec<usize>, removed: &mut Vec<Range<usize>>) -> usize {
    let mark = removed.first().map(|block| block.start);
    let mut place = None;
    for start in starts {
        let own = layout.comments_above(start);
        let from = match (place, mark) {
            // A comment that runs on from the user's above the mark is the user's.
            (None, Some(mark)) if mark < start => own.max(mark),
            (None, Some(_)) => own,
            (None, None) => start,
            (Some(_), _) => layout.blanks_above(own),
        };
        removed.push(from..layout.section_end(start));
        place.get_or_insert(from);
    }
    place.unwrap_or_else(|| layout.end_of("observation"))
}

/// Heading, blank line, and the tables parted by blank lines.
fn block(
    layout: &Layout,
    unit: StateUnit,
    segments: &[Segment],
    heading: &str,
) -> Result<String, EditError> {
    let mut lines = vec![MARK.to_owned()];
    lines.extend(heading.lines().map(tables::comment));
    for table in tables::tables(unit, segments)? {
        lines.push(String::new());
        lines.extend(table);
    }
    Ok(layout.lines(&lines))
}

/// Comment blocks that an earlier edit wrote, each with the blank lines below it.
fn marked(text: &str) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let (mut at, mut inside, mut below) = (0, false, false);
    for line in text.split_inclusive('\n') {
        let content = line.trim();
        if content == MARK {
            found.push(at..at);
            (inside, below) = (true, false);
        }
        below = inside && (below || content.is_empty());
        inside = inside && (content.is_empty() || !below && content.starts_with('#'));
        at += line.len();
        if let Some(block) = found.last_mut().filter(|_| inside) {
            block.end = at;
        }
    }
    found
}

/// The part `range` of `text` without what was removed.
fn without(text: &str, range: Range<usize>, removed: &[Range<usize>]) -> String {
    let mut removed: Vec<_> = removed.to_vec();
    removed.sort_by_key(|part| part.start);
    let mut kept = String::new();
    let mut at = range.start;
    for part in removed {
        let start = part.start.clamp(at, range.end);
        kept.push_str(&text[at..start]);
        at = part.end.clamp(start, range.end);
    }
    kept.push_str(&text[at..range.end]);
    kept
}

/// The table at a key; inline tables only where they are `inline_too`. None where it is absent.
fn table<'a>(
    item: Option<&'a Item>,
    key: &str,
    inline_too: bool,
) -> Result<Option<&'a dyn TableLike>, EditError> {
    let fault = |item: &Item| EditError::Notation {
        key: key.to_owned(),
        found: item.type_name(),
        wanted: "a table under its own header",
    };
    match item {
        None => Ok(None),
        Some(item) if item.is_inline_table() && !inline_too => Err(fault(item)),
        Some(item) => item.as_table_like().map(Some).ok_or_else(|| fault(item)),
    }
}
