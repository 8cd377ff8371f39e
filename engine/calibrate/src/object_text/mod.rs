//! Editing an object file in place: new segments, everything else byte for byte as it was.
//!
//! The text is parsed for the places of its tables and then cut and joined as text, so that comments,
//! order, blank lines and line endings stay. What goes with the segments is replaced: the tables
//! themselves, comments between them, and our own heading above the first.

mod places;
mod print;
mod read;

use std::io::Write;
use std::path::Path;

use pubs_core::{Joint, JointKind};

use crate::segment::Segment;
use places::Places;

pub use read::{SegmentError, segments_of};

/// How our heading begins; a comment block that begins so is replaced.
pub const HEADING: &str = "# Calibration segments, written by `pubs-engine calibrate`";

/// How states are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateUnit {
    /// Hinges: degrees.
    Degrees,
    /// Slides: metres.
    Metres,
}

impl StateUnit {
    /// That of a joint; metres for what is no hinge.
    pub fn of(joint: &Joint) -> Self {
        match joint.kind {
            JointKind::Revolute { .. } => Self::Degrees,
            _ => Self::Metres,
        }
    }

    fn suffix(self) -> &'static str {
        match self {
            Self::Degrees => "deg",
            Self::Metres => "m",
        }
    }

    fn per_si(self) -> f64 {
        match self {
            Self::Degrees => 1f64.to_degrees(),
            Self::Metres => 1.0,
        }
    }

    fn decimals(self) -> usize {
        match self {
            Self::Degrees => 2,
            Self::Metres => 5,
        }
    }
}

/// Why a text could not be edited.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// It is not TOML.
    #[error("the object file is not TOML: {0}")]
    Syntax(#[from] toml_edit::TomlError),
    /// A table is written in a way that cannot be edited in place.
    #[error(
        "the object file writes `{0}` inside another table; write it under a header of its own, [{0}]"
    )]
    Inline(&'static str),
}

/// The text with `segments` in the place of its segments. `heading` are the lines of a comment
/// above the first, after [`HEADING`].
///
/// # Errors
/// Where the text is not TOML or holds `observation` in a line.
pub fn with_segments(
    text: &str,
    unit: StateUnit,
    segments: &[Segment],
    heading: &[String],
) -> Result<String, EditError> {
    let places = Places::of(text)?;
    let cuts = places.segment_cuts(text)?;
    let mut written = String::new();
    written.push_str(HEADING);
    written.push_str(".\n");
    for line in heading {
        written.push_str(&format!("# {line}\n"));
    }
    for segment in print::tiled(segments, unit) {
        written.push('\n');
        written.push_str(&segment);
    }
    let ending = line_ending(text);
    let written = written.replace('\n', ending);
    let place = cuts.place;
    let mut edited = String::with_capacity(text.len() + written.len());
    let mut kept_from = 0;
    for cut in &cuts.cuts {
        edited.push_str(&text[kept_from..cut.start]);
        if cut.start == place {
            edited.push_str(&written);
        }
        kept_from = cut.end;
    }
    if !cuts.cuts.iter().any(|cut| cut.start == place) {
        edited.push_str(&text[kept_from..place]);
        let blank = edited.is_empty() || edited.ends_with(&format!("{ending}{ending}"));
        if !edited.is_empty() && !edited.ends_with(ending) {
            edited.push_str(ending);
        }
        if !blank {
            edited.push_str(ending);
        }
        edited.push_str(&written);
        if !text[place..].is_empty() {
            edited.push_str(ending);
        }
        kept_from = place;
    }
    edited.push_str(&text[kept_from..]);
    Ok(edited)
}

/// The text with `[source] kind` and `sensor` set, their comments kept.
///
/// # Errors
/// Where the text is not TOML or holds `source` in a line.
pub fn with_source(text: &str, kind: &str, sensor: &str) -> Result<String, EditError> {
    let mut edited = text.to_owned();
    for (key, value) in [("sensor", sensor), ("kind", kind)] {
        let places = Places::of(&edited)?;
        let quoted = format!("\"{value}\"");
        match places.value(&edited, "source", key)? {
            Some(span) => edited.replace_range(span, &quoted),
            None => {
                let at = places.end_of_header(&edited, "source");
                let ending = line_ending(&edited);
                let line = format!("{key} = {quoted}{ending}");
                match at {
                    Some(at) => edited.insert_str(at, &line),
                    None => edited = format!("{edited}{ending}[source]{ending}{line}"),
                }
            }
        }
    }
    Ok(edited)
}

fn line_ending(text: &str) -> &'static str {
    if text.contains("\r\n") { "\r\n" } else { "\n" }
}

/// The change as lines that go (`-`) and come (`+`), with three lines around.
pub fn difference(old: &str, new: &str) -> String {
    similar::TextDiff::from_lines(old, new)
        .unified_diff()
        .context_radius(3)
        .header("as it is", "as it would be")
        .to_string()
}

/// Writes a whole file or nothing: under another name first, then renamed.
///
/// # Errors
/// What the operating system says; the old file is then as before.
pub fn write_atomically(path: &Path, text: &str) -> std::io::Result<()> {
    // A link stays a link: its target is what is written.
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(text.as_bytes())?;
    if let Ok(metadata) = std::fs::metadata(&path) {
        file.as_file().set_permissions(metadata.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&path).map_err(|error| error.error)?;
    Ok(())
}
