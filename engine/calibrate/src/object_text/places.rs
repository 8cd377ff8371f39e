//! Where the tables of an object file stand in its text.

use std::ops::Range;

use toml_edit::{Document, Item, Table};

use super::{EditError, HEADING};

/// A parsed text with the places of its parts, in bytes.
pub(super) struct Places {
    document: Document<String>,
    /// Where each header line begins, ascending.
    headers: Vec<usize>,
}

/// What goes, and where the new segments come.
pub(super) struct SegmentCuts {
    pub cuts: Vec<Range<usize>>,
    pub place: usize,
}

impl Places {
    pub fn of(text: &str) -> Result<Self, EditError> {
        let document = Document::parse(text.to_owned())?;
        let mut headers = Vec::new();
        collect_headers(document.as_table(), &mut headers);
        let mut headers: Vec<usize> = headers.into_iter().map(|at| line_start(text, at)).collect();
        headers.sort_unstable();
        Ok(Self { document, headers })
    }

    /// The value of a key in a table under a header.
    pub fn value(
        &self,
        _text: &str,
        table: &'static str,
        key: &str,
    ) -> Result<Option<Range<usize>>, EditError> {
        match self.document.get(table) {
            None => Ok(None),
            Some(Item::Table(table)) => Ok(table.get(key).and_then(Item::span)),
            Some(_) => Err(EditError::Inline(table)),
        }
    }

    /// Where the line after a table's header begins.
    pub fn end_of_header(&self, text: &str, table: &str) -> Option<usize> {
        let header = self.document.get(table)?.as_table()?.span()?;
        Some(line_end(text, header.start))
    }

    pub fn segment_cuts(&self, text: &str) -> Result<SegmentCuts, EditError> {
        let observation = match self.document.get("observation") {
            None => return Ok(self.appended(text.len())),
            Some(Item::Table(table)) => table,
            Some(_) => return Err(EditError::Inline("observation")),
        };
        match observation.get("segment") {
            Some(Item::ArrayOfTables(tables)) => {
                let bodies: Vec<Range<usize>> = tables
                    .iter()
                    .filter_map(|table| body(text, table))
                    .collect();
                Ok(self.table_cuts(text, &bodies))
            }
            Some(inline) => {
                let own = inline.span().map(|span| whole_lines(text, &span));
                let place = self.end_of_table(text, observation);
                Ok(SegmentCuts {
                    cuts: own.into_iter().collect(),
                    place,
                })
            }
            None => Ok(self.appended(self.end_of_table(text, observation))),
        }
    }

    fn appended(&self, place: usize) -> SegmentCuts {
        SegmentCuts {
            cuts: Vec::new(),
            place,
        }
    }

    /// The segments, each with what stands between it and the next one.
    fn table_cuts(&self, text: &str, bodies: &[Range<usize>]) -> SegmentCuts {
        let mut cuts: Vec<Range<usize>> = Vec::new();
        for body in bodies {
            let next = self
                .headers
                .iter()
                .copied()
                .find(|&header| header >= body.end);
            let next_is_segment = bodies.iter().any(|other| Some(other.start) == next);
            let end = match next {
                Some(next) if next_is_segment => next,
                _ => body.end,
            };
            match cuts.last_mut() {
                Some(cut) if cut.end == body.start => cut.end = end,
                _ => cuts.push(body.start..end),
            }
        }
        if let Some(first) = cuts.first_mut() {
            first.start = heading_start(text, first.start);
        }
        let place = cuts.first().map_or(text.len(), |cut| cut.start);
        SegmentCuts { cuts, place }
    }

    /// After the last value of a table that stands under its own header.
    fn end_of_table(&self, text: &str, table: &Table) -> usize {
        body(text, table).map_or(text.len(), |body| body.end)
    }
}

/// From the header's line to the end of the last value's line.
fn body(text: &str, table: &Table) -> Option<Range<usize>> {
    let header = table.span()?;
    let last_value = table
        .iter()
        .filter(|(_, item)| item.is_value())
        .filter_map(|(_, item)| item.span())
        .map(|span| span.end)
        .max();
    let end = last_value.unwrap_or(header.start).max(header.start);
    Some(line_start(text, header.start)..line_end(text, end))
}

fn collect_headers(table: &Table, headers: &mut Vec<usize>) {
    for (_, item) in table.iter() {
        match item {
            Item::Table(table) => {
                headers.extend(
                    table
                        .span()
                        .filter(|_| !table.is_implicit() && !table.is_dotted())
                        .map(|span| span.start),
                );
                collect_headers(table, headers);
            }
            Item::ArrayOfTables(tables) => {
                for table in tables {
                    headers.extend(table.span().map(|span| span.start));
                    collect_headers(table, headers);
                }
            }
            _ => {}
        }
    }
}

/// Where our heading begins that stands right above `first`, or `first`.
fn heading_start(text: &str, first: usize) -> usize {
    let mut at = first;
    let mut start = first;
    while at > 0 {
        let above = line_start(text, at - 1);
        let line = text[above..at].trim();
        if !line.starts_with('#') && !line.is_empty() {
            break;
        }
        if line.starts_with(HEADING) {
            start = above;
            break;
        }
        at = above;
    }
    start
}

fn whole_lines(text: &str, span: &Range<usize>) -> Range<usize> {
    line_start(text, span.start)..line_end(text, span.end)
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

fn line_end(text: &str, at: usize) -> usize {
    text[at..]
        .find('\n')
        .map_or(text.len(), |newline| at + newline + 1)
}
