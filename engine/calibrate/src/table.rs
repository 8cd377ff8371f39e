//! Tables of text: `# key = value` lines, a line of column names, and rows.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::fault::{Fault, Place, Refused};

/// A table, every cell still a text. Blank lines and remarks may stand anywhere.
#[derive(Debug)]
pub(crate) struct Table {
    pub file: PathBuf,
    pub columns: Vec<String>,
    pub rows: Vec<Row>,
    comments: Vec<Comment>,
}

#[derive(Debug)]
pub(crate) struct Row {
    /// From 1, as an editor shows it.
    pub line: usize,
    cells: StringRecord,
}

#[derive(Debug)]
pub(crate) struct Comment {
    pub line: usize,
    pub key: String,
    pub value: String,
}

impl Table {
    /// Reads a table.
    ///
    /// # Errors
    /// Where the file cannot be read, is no text, or has no line of column names; rows with more
    /// or fewer cells than columns.
    pub fn read(file: &Path) -> Result<Self, Refused> {
        let bytes = fs::read(file).map_err(|error| {
            of_file(
                file,
                format!("cannot be read: {error}"),
                "a file that can be read",
                "give the right path",
            )
        })?;
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            let before = &bytes[..error.valid_up_to()];
            let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
            of_file(
                file,
                format!("line {line} is not text (UTF-8)"),
                "a CSV table",
                "save it as CSV in UTF-8",
            )
        })?;
        Self::parse(file, text.trim_start_matches('\u{feff}'))
    }

    fn parse(file: &Path, text: &str) -> Result<Self, Refused> {
        let mut comments = Vec::new();
        let mut body = String::with_capacity(text.len());
        // The lines in `body`, as they are counted in the file.
        let mut numbers = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let line_number = index + 1;
            if let Some(remark) = line.trim_start().strip_prefix('#') {
                comments.extend(comment(line_number, remark));
            } else if !line.trim().is_empty() {
                body.push_str(line);
                body.push('\n');
                numbers.push(line_number);
            }
        }
        let mut records = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .from_reader(body.as_bytes())
            .into_records()
            .filter_map(Result::ok);
        let columns: Vec<String> = records
            .next()
            .map(|record| record.iter().map(str::to_owned).collect())
            .unwrap_or_default();
        let first_line = numbers.first().copied();
        check_columns(file, &columns, first_line)?;
        let rows = records
            .map(|cells| {
                let line = cells.position().map_or(0, ::csv::Position::line) as usize;
                let line = numbers.get(line.saturating_sub(1)).copied().unwrap_or(0);
                Row { line, cells }
            })
            .collect();
        let table = Self {
            file: file.to_owned(),
            columns,
            rows,
            comments,
        };
        table.check_rows()?;
        Ok(table)
    }

    fn check_rows(&self) -> Result<(), Refused> {
        let mut refused = Refused::none();
        for row in self.rows.iter() {
            if row.cells.len() != self.columns.len() {
                refused.push(Fault {
                    file: self.file.clone(),
                    place: Place::Cell {
                        line: row.line,
                        column: self.columns[row.cells.len().min(self.columns.len() - 1)].clone(),
                    },
                    found: format!("this row has {} cells", row.cells.len()),
                    rule: format!("{}, one for each column", self.columns.len()),
                    cure: "add or take away commas".to_owned(),
                });
            }
        }
        refused.unless_at_fault(())
    }

    /// Where a column stands.
    pub fn position(&self, column: &str) -> Option<usize> {
        self.columns.iter().position(|name| name == column)
    }

    /// The line with that key.
    pub fn comment(&self, key: &str) -> Option<&Comment> {
        self.comments.iter().find(|comment| comment.key == key)
    }

    /// A fault of a cell.
    pub fn cell_fault(&self, row: &Row, position: usize, rule: &str, cure: &str) -> Fault {
        let found = match row.cell(position) {
            "" => "the cell is empty".to_owned(),
            cell => format!("found `{cell}`"),
        };
        Fault {
            file: self.file.clone(),
            place: Place::Cell {
                line: row.line,
                column: self.columns.get(position).cloned().unwrap_or_default(),
            },
            found,
            rule: rule.to_owned(),
            cure: cure.to_owned(),
        }
    }
}

impl Row {
    /// The text of a cell, without the blanks around it.
    pub fn cell(&self, position: usize) -> &str {
        self.cells.get(position).unwrap_or_default()
    }

    /// The finite number in a cell.
    pub fn number(&self, position: usize) -> Option<f64> {
        let number: f64 = self.cell(position).parse().ok()?;
        number.is_finite().then_some(number)
    }
}

/// A fault of a file as a whole.
pub(crate) fn of_file(
    file: &Path,
    found: String,
    rule: impl Into<String>,
    cure: impl Into<String>,
) -> Fault {
    Fault {
        file: file.to_owned(),
        place: Place::File,
        found,
        rule: rule.into(),
        cure: cure.into(),
    }
}

fn comment(line: usize, remark: &str) -> Option<Comment> {
    let (key, value) = remark.split_once('=')?;
    Some(Comment {
        line,
        key: key.trim().to_owned(),
        value: value.trim().to_owned(),
    })
}

fn check_columns(file: &Path, columns: &[String], line: Option<usize>) -> Result<(), Refused> {
    let rule = "a line of column names with commas between";
    let Some(line) = line else {
        let found = "the table is empty".to_owned();
        return Err(of_file(file, found, rule, "give a table with rows").into());
    };
    if let [only] = columns
        && only.contains([';', '\t'])
    {
        let found = format!("line {line} has no commas, but semicolons or tabs");
        return Err(of_file(file, found, rule, "save it with commas between the columns").into());
    }
    let mut seen = BTreeSet::new();
    match columns.iter().find(|name| !seen.insert(name.as_str())) {
        None => Ok(()),
        Some(twice) => {
            let found = format!("line {line} names the column `{twice}` twice");
            Err(of_file(
                file,
                found,
                "each name once",
                "rename or remove one of them",
            )
            .into())
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn lines_are_counted_as_an_editor_does() {
        let text = "# a = 1\r\n\r\nx, y\r\n1,2\r\n# remark\r\n\r\n\" 3\",4\r\n";
        let table = Table::parse(Path::new("t.csv"), text).unwrap();
        assert_eq!(table.columns, ["x", "y"]);
        let rows: Vec<_> = table
            .rows
            .iter()
            .map(|row| (row.line, row.number(0)))
            .collect();
        assert_eq!(rows, [(4, Some(1.0)), (7, Some(3.0))]);
        assert_eq!(
            table.comment("a").map(|a| (a.line, a.value.as_str())),
            Some((1, "1"))
        );
        assert!(table.comment("remark").is_none());
    }

    #[test]
    fn tables_that_are_none_are_refused_with_the_reason() {
        for (text, expected) in [
            ("", "the table is empty"),
            ("# only = remarks\n", "the table is empty"),
            ("\nx;y\n1;2\n", "line 2 has no commas"),
            ("x,y,x\n", "line 1 names the column `x` twice"),
            (
                "x,y\n1,2\n1\n",
                "t.csv: line 3, column y: this row has 1 cells; expected 2",
            ),
            (
                "x,y\n1,2,3\n",
                "t.csv: line 2, column y: this row has 3 cells; expected 2",
            ),
        ] {
            let text = Table::parse(Path::new("t.csv"), text)
                .unwrap_err()
                .to_string();
            assert!(text.contains(expected), "`{text}` should say `{expected}`");
        }
    }
}
