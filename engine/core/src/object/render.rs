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

fn group(fault: &Fault) -> Group<'_> {
    let group = Level::ERROR.primary_title(fault.message.as_str());
    let group = match &fault.excerpt {
        Some(excerpt) => group.element(
            Snippet::source(excerpt.line.as_str())
                .line_start(excerpt.number)
                .path((!excerpt.name.is_empty()).then_some(excerpt.name.as_str()))
                .annotation(AnnotationKind::Primary.span(excerpt.span.clone())),
        ),
        None => group.element(Origin::path(fault.file.as_str())),
    };
    group.element(Level::HELP.message(fault.help.as_str()))
}
