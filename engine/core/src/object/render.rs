//! Faults as text for people: the source line, a caret, the cure.

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use super::fault::{Fault, Faults};

/// Every fault with its source line and the part at fault marked, in colour where `color`.
///
/// Ends without a line feed.
pub fn render(faults: &Faults, color: bool) -> String {
    let renderer = if color {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let texts: Vec<String> = faults
        .0
        .iter()
        .map(|fault| renderer.render(&[group(fault)]))
        .collect();
    texts.join("\n\n")
}

/// A message's first line is the title, the others are notes below the source line.
fn group(fault: &Fault) -> Group<'_> {
    let mut lines = fault.message.lines();
    let group = Level::ERROR.primary_title(lines.next().unwrap_or_default());
    let group = match &fault.excerpt {
        Some(excerpt) => group.element(
            Snippet::source(excerpt.line.as_str())
                .line_start(excerpt.number)
                .path((!excerpt.name.is_empty()).then_some(excerpt.name.as_str()))
                .annotation(AnnotationKind::Primary.span(excerpt.span.clone())),
        ),
        None => group.element(Origin::path(fault.file.as_str())),
    };
    let notes = lines.map(|line| Level::NOTE.message(line.trim_start()));
    group
        .elements(notes)
        .element(Level::HELP.message(fault.help.as_str()))
}
