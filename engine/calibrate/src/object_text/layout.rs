//! Where the tables of a TOML text are.

use std::ops::Range;

use toml_edit::{Document, Item, Table, TableLike, TomlError};

/// A parsed text with the places of its headers and values.
pub(super) struct Layout<'a> {
    text: &'a str,
    document: Document<&'a str>,
    /// Bytes of `[name]` and `[[name]]`, increasing.
    headers: Vec<Range<usize>>,
    /// Where values end, increasing.
    value_ends: Vec<usize>,
    newline: &'static str,
}

impl<'a> Layout<'a> {
    pub(super) fn of(text: &'a str) -> Result<Self, TomlError> {
        let document = Document::parse(text)?;
        let (mut headers, mut value_ends) = (Vec::new(), Vec::new());
        gather(text, document.as_table(), &mut headers, &mut value_ends);
        headers.sort_by_key(|header| header.start);
        value_ends.sort_unstable();
        let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
        Ok(Self {
            text,
            document,
            headers,
            value_ends,
            newline,
        })
    }

    pub(super) fn root(&self) -> &Table {
        self.document.as_table()
    }

    /// Start of the line that holds this byte.
    pub(super) fn line_start(&self, at: usize) -> usize {
        self.text[..at].rfind('\n').map_or(0, |newline| newline + 1)
    }

    /// Past the end of the line that holds this byte.
    pub(super) fn line_end(&self, at: usize) -> usize {
        let rest = &self.text[at..];
        rest.find('\n')
            .map_or(self.text.len(), |newline| at + newline + 1)
    }

    /// Past the line of the last value of the section whose header starts here.
    pub(super) fn section_end(&self, header: usize) -> usize {
        let next = self.next_header(header);
        let own = self.headers.iter().find(|own| own.start == header);
        let values = self.value_ends.partition_point(|&end| end <= next);
        let last = values.checked_sub(1).map(|last| self.value_ends[last]);
        let header_end = own.map_or(header, |own| own.end);
        self.line_end(last.unwrap_or_default().max(header_end))
    }

    /// Start of the header after this one, or the end of the text.
    fn next_header(&self, header: usize) -> usize {
        let next = self.headers.partition_point(|own| own.start <= header);
        self.headers
            .get(next)
            .map_or(self.text.len(), |own| own.start)
    }

    /// Start of the comment lines directly above a line's start, which may be that start.
    pub(super) fn comments_above(&self, at: usize) -> usize {
        self.above(at, |line| line.starts_with('#'))
    }

    /// Start of the blank lines directly above a line's start.
    pub(super) fn blanks_above(&self, at: usize) -> usize {
        self.above(at, str::is_empty)
    }

    fn above(&self, at: usize, belongs: fn(&str) -> bool) -> usize {
        let mut start = self.line_start(at);
        while start > 0 {
            let line = self.line_start(start - 1);
            if !belongs(self.text[line..start].trim()) {
                break;
            }
            start = line;
        }
        start
    }

    /// Where a table below the root table of this name can follow: behind its last header, values
    /// and the comments right below them. The end of the text where it is the last, or has no
    /// header of its own.
    pub(super) fn end_of(&self, name: &str) -> usize {
        let (mut own, mut values) = (Vec::new(), Vec::new());
        if let Some(item) = self.root().get(name) {
            gather_item(self.text, item, &mut own, &mut values);
        }
        let last = own.iter().map(|header| header.start).max();
        last.map_or(self.text.len(), |header| self.place_after(header))
    }

    /// Where a header can stand first: behind the keys of the root table.
    pub(super) fn start_of_headers(&self) -> usize {
        let first = self.headers.first();
        first.map_or(self.text.len(), |header| self.comments_above(header.start))
    }

    fn place_after(&self, header: usize) -> usize {
        let next = self.next_header(header);
        if next == self.text.len() {
            return next;
        }
        let limit = self.comments_above(next);
        let mut place = self.section_end(header);
        while place < limit && self.text[place..].starts_with('#') {
            place = self.line_end(place);
        }
        place
    }

    /// `lines` with the text's line endings.
    pub(super) fn lines(&self, lines: &[String]) -> String {
        lines.iter().flat_map(|line| [line, self.newline]).collect()
    }

    /// The three parts with a blank line between each two, ending as the text does.
    pub(super) fn joined(&self, before: &str, block: &str, after: &str) -> String {
        let mut joined = before.to_owned();
        if !joined.is_empty() && !joined.ends_with('\n') {
            joined.push_str(self.newline);
        }
        let last_line = joined.lines().next_back().unwrap_or_default();
        if !last_line.trim().is_empty() {
            joined.push_str(self.newline);
        }
        joined.push_str(block);
        let next_line = after.lines().next().unwrap_or_default();
        if !next_line.trim().is_empty() {
            joined.push_str(self.newline);
        }
        joined.push_str(after);
        if !self.text.is_empty() && !self.text.ends_with('\n') {
            joined.truncate(joined.trim_end_matches(['\r', '\n']).len());
        }
        joined
    }
}

/// Gathers headers and ends of values of a table and of all below it.
fn gather(
    text: &str,
    table: &dyn TableLike,
    headers: &mut Vec<Range<usize>>,
    ends: &mut Vec<usize>,
) {
    for (_, item) in table.iter() {
        gather_item(text, item, headers, ends);
    }
}

fn gather_item(text: &str, item: &Item, headers: &mut Vec<Range<usize>>, ends: &mut Vec<usize>) {
    match item {
        Item::Table(table) => gather_table(text, table, headers, ends),
        Item::ArrayOfTables(tables) => {
            for table in tables {
                gather_table(text, table, headers, ends);
            }
        }
        item => ends.extend(item.span().map(|span| span.end)),
    }
}

fn gather_table(text: &str, table: &Table, headers: &mut Vec<Range<usize>>, ends: &mut Vec<usize>) {
    // A table that only a longer name implies, or a dotted key, has the span of that name.
    let has_header = |span: &Range<usize>| !span.is_empty() && text[span.start..].starts_with('[');
    headers.extend(table.span().filter(has_header));
    gather(text, table, headers, ends);
}
