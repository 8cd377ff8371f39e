//! A `.pomdp` file as words and colons.

/// A word or a colon, and where it begins (both from 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Token<'a> {
    pub text: &'a str,
    pub line: usize,
    pub column: usize,
}

/// Splits a text. A `#` begins a comment; white space and colons part words.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut tokens = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        split_line(line, index + 1, &mut tokens);
    }
    tokens
}

fn split_line<'a>(line: &'a str, number: usize, tokens: &mut Vec<Token<'a>>) {
    let mut begun: Option<(usize, usize)> = None;
    let end_word = |begun: &mut Option<(usize, usize)>, end: usize, tokens: &mut Vec<_>| {
        if let Some((start, column)) = begun.take() {
            tokens.push(Token {
                text: &line[start..end],
                line: number,
                column,
            });
        }
    };
    for (column, (place, character)) in line.char_indices().enumerate() {
        if character.is_whitespace() || character == ':' {
            end_word(&mut begun, place, tokens);
        } else if begun.is_none() {
            begun = Some((place, column + 1));
        }
        if character == ':' {
            tokens.push(Token {
                text: ":",
                line: number,
                column: column + 1,
            });
        }
    }
    end_word(&mut begun, line.len(), tokens);
}
