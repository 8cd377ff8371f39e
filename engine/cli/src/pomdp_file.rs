//! A POMDP from its `.pomdp` file, or its faults at their lines.

use std::ops::Range;
use std::path::Path;
use std::{fs, io};

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use pubs_solve::{ParseFault, Pomdp, parse};

use crate::failure::Failure;
use crate::show;

/// The POMDP in a file, named for it.
///
/// # Errors
/// Where the file cannot be read, or has faults.
pub fn load(path: &Path) -> Result<Pomdp, Failure> {
    let text = fs::read_to_string(path).map_err(|error| {
        let path = path.display();
        Failure::invalid(match error.kind() {
            io::ErrorKind::InvalidData => {
                format!("{path} is not text (UTF-8); give a POMDP in Cassandra's format (.pomdp)")
            }
            _ => format!("cannot read {path}: {error}; give the path of a .pomdp file"),
        })
    })?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    parse(&text)
        .map(|pomdp| pomdp.named(name))
        .map_err(|faults| Failure::Shown(render(path, &text, &faults)))
}

fn render(path: &Path, text: &str, faults: &[ParseFault]) -> String {
    let renderer = if show::color_on_stderr() {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let path = path.display().to_string();
    let shown = faults.iter().map(|fault| {
        let line = text.lines().nth(fault.line - 1).unwrap_or_default();
        let line = line.strip_prefix('\u{feff}').unwrap_or(line);
        let group = Level::ERROR
            .primary_title(fault.message.as_str())
            .element(
                Snippet::source(line)
                    .line_start(fault.line)
                    .path(path.as_str())
                    .annotation(AnnotationKind::Primary.span(word_at(line, fault.column))),
            )
            .element(Level::HELP.message(fault.help.as_str()));
        renderer.render(&[group])
    });
    shown.collect::<Vec<_>>().join("\n\n")
}

/// The bytes of the word that begins at a column, in characters from 1.
fn word_at(line: &str, column: usize) -> Range<usize> {
    let mut places = line.char_indices().map(|place| place.0);
    let start = places.nth(column - 1).unwrap_or(line.len());
    let rest = &line[start..];
    let ends = |character: char| character.is_whitespace() || matches!(character, ':' | '#');
    let length = rest.find(ends).unwrap_or(rest.len());
    let first = rest.chars().next().map_or(0, char::len_utf8);
    start..start + length.max(first)
}
