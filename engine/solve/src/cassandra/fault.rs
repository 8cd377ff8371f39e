//! What is wrong with a file, where, and what to do about it.

use std::fmt;

/// One fault of a `.pomdp` file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseFault {
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    /// What was found and why it does not do.
    pub message: String,
    /// What is allowed, or what mends it.
    pub help: String,
}

impl fmt::Display for ParseFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            line,
            column,
            message,
            help,
        } = self;
        write!(
            formatter,
            "line {line}, column {column}: {message} ({help})"
        )
    }
}
