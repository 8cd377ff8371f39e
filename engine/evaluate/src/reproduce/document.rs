//! A report as its parts, before it is written in a format.

/// A part of a report.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Block {
    /// Of the whole.
    Title(String),
    /// Of a section.
    Heading(String),
    /// Of a part of one.
    Subheading(String),
    /// Running text.
    Paragraph(String),
    /// Its items.
    List(Vec<String>),
    /// A table.
    Table(Table),
    /// A line as it is typed.
    Command(String),
    /// A picture.
    Figure(Figure),
}

/// Rows of as many fields as the head has.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Table {
    pub head: Vec<String>,
    pub rows: Vec<Vec<Field>>,
}

/// A field of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    pub text: String,
    pub bold: bool,
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Figure {
    /// Where it stands beside a report in Markdown.
    pub file: String,
    pub svg: String,
    /// What is to be seen.
    pub caption: String,
}

impl Field {
    pub(super) fn plain(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            bold: false,
        }
    }

    pub(super) fn bold_if(text: impl Into<String>, bold: bool) -> Self {
        Self {
            text: text.into(),
            bold,
        }
    }
}

impl Table {
    pub(super) fn new(head: &[&str]) -> Self {
        Self {
            head: head.iter().map(|&text| text.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, fields: impl IntoIterator<Item = String>) {
        self.rows
            .push(fields.into_iter().map(Field::plain).collect());
    }
}
