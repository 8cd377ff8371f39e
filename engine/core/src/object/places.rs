//! From a key to the place where its value was written.

use std::collections::BTreeMap;
use std::ops::Range;

use super::document::Span;
use super::fault::{Excerpt, Fault};
use super::layers::Origin;

/// Where a value was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// Path of the object file.
    pub file: String,
    /// Line in the file, from 1; `None` where the value is not from the file.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// The layer that gave the value.
    pub origin: Origin,
}

/// Which part of an entry is at fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Key,
    Value,
}

/// Everything needed to show a key where it stands.
#[derive(Debug, Clone)]
pub(super) struct Places {
    pub file: String,
    pub text: String,
    pub spans: BTreeMap<String, Span>,
    pub origins: BTreeMap<String, Origin>,
}

impl Places {
    /// A fault at a key; at the nearest table that stands in the file where the key itself does
    /// not.
    pub fn fault(
        &self,
        key: &str,
        part: Part,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Fault {
        let excerpt = match self.origins.get(key).and_then(Origin::typed) {
            Some(typed) => Some(typed_excerpt(&typed)),
            None => self.span(key, part).map(|span| self.excerpt(span)),
        };
        let mut fault = Fault::of_file(&self.file, message, help);
        key.clone_into(&mut fault.key);
        match excerpt {
            Some(excerpt) if excerpt.name == self.file => self.point(&mut fault, excerpt),
            Some(excerpt) => fault.excerpt = Some(excerpt),
            None => self.point(&mut fault, self.excerpt(0..0)),
        }
        fault
    }

    /// A fault of something the user typed outside the file.
    pub fn fault_of_override(&self, origin: &Origin, message: String, help: String) -> Fault {
        let mut fault = Fault::of_file(&self.file, message, help);
        fault.excerpt = origin.typed().as_deref().map(typed_excerpt);
        fault
    }

    /// A fault at a place of the text.
    pub fn fault_at(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Fault {
        let mut fault = Fault::of_file(&self.file, message, help);
        self.point(&mut fault, self.excerpt(span));
        fault
    }

    /// Where the value of a key was written; `None` where it has none.
    pub fn location(&self, key: &str) -> Option<Location> {
        let origin = self.origins.get(key)?.clone();
        let span = (origin == Origin::File)
            .then(|| self.spans.get(key))
            .flatten();
        let start = span.map(|span| self.excerpt(span.value.clone()));
        Some(Location {
            file: self.file.clone(),
            line: start.as_ref().map(|start| start.number),
            column: start.as_ref().map(column),
            origin,
        })
    }

    fn point(&self, fault: &mut Fault, excerpt: Excerpt) {
        fault.line = Some(excerpt.number);
        fault.column = Some(column(&excerpt));
        fault.excerpt = Some(excerpt);
    }

    /// The span of the key, or of its nearest ancestor in the file.
    fn span(&self, key: &str, part: Part) -> Option<Range<usize>> {
        if let Some(span) = self.spans.get(key) {
            return Some(if part == Part::Key {
                span.key.clone()
            } else {
                span.value.clone()
            });
        }
        let (parent, _) = key.rsplit_once('.')?;
        self.span(parent, Part::Key)
    }

    fn excerpt(&self, span: Range<usize>) -> Excerpt {
        let start = self.text.floor_char_boundary(span.start);
        let line_start = self.text[..start]
            .rfind('\n')
            .map_or(0, |newline| newline + 1);
        let line_end = self.text[start..]
            .find('\n')
            .map_or(self.text.len(), |end| start + end);
        let line = self.text[line_start..line_end].trim_end_matches('\r');
        let end = self
            .text
            .ceil_char_boundary(span.end.clamp(start, line_end))
            - line_start;
        Excerpt {
            name: self.file.clone(),
            line: line.to_owned(),
            number: self.text[..line_start].matches('\n').count() + 1,
            span: (start - line_start).min(line.len())..end.min(line.len()),
        }
    }
}

fn typed_excerpt(typed: &str) -> Excerpt {
    Excerpt {
        name: String::new(),
        line: typed.to_owned(),
        number: 1,
        span: 0..typed.len(),
    }
}

fn column(excerpt: &Excerpt) -> usize {
    excerpt.line[..excerpt.span.start].chars().count() + 1
}
