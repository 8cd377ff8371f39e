//! A report as its parts, before it is written in a format.

/// A part of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
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
    /// What the reader must not overlook.
    Notice(String),
    /// A long text that is folded away until it is asked for.
    Details(Details),
}

/// A long text behind one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Details {
    /// The line.
    pub summary: String,
    /// The text as it stands in its file.
    pub text: String,
}

/// Rows of as many fields as the head has.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Above the columns.
    pub head: Vec<String>,
    /// In turn; one that begins with a name begins a group where others do not.
    pub rows: Vec<Vec<Field>>,
}

/// A field of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// What stands there.
    pub text: String,
    /// Heavier.
    pub bold: bool,
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Where it stands beside a report in Markdown.
    pub file: String,
    /// The picture itself.
    pub svg: String,
    /// What is to be seen.
    pub caption: String,
}

impl Field {
    /// Not bold.
    pub fn plain(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            bold: false,
        }
    }

    /// Bold where `bold` says so.
    pub fn bold_if(text: impl Into<String>, bold: bool) -> Self {
        Self {
            text: text.into(),
            bold,
        }
    }
}

impl Table {
    /// Two columns without a name: what it is, and what was found.
    pub fn pairs(pairs: impl IntoIterator<Item = (&'static str, String)>) -> Self {
        let mut table = Self::new(&["", ""]);
        for (name, value) in pairs {
            table.push([name.to_owned(), value]);
        }
        table
    }

    /// Without rows.
    pub fn new(head: &[&str]) -> Self {
        Self {
            head: head.iter().map(|&text| text.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// One more row, nothing in it bold.
    pub fn push(&mut self, fields: impl IntoIterator<Item = String>) {
        self.rows
            .push(fields.into_iter().map(Field::plain).collect());
    }
}
