//! A report in Markdown; figures stand in files beside it.

use pubs_draw::document::{Block, Field, Figure, Table};

/// Writes the parts down.
pub(super) fn markdown(blocks: &[Block]) -> String {
    let parts: Vec<_> = blocks.iter().map(block).collect();
    parts.join("\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("# {}\n", escaped(text)),
        Block::Heading(text) => format!("## {}\n", escaped(text)),
        Block::Subheading(text) => format!("### {}\n", escaped(text)),
        Block::Paragraph(text) => format!("{}\n", escaped(text)),
        Block::List(items) => items
            .iter()
            .map(|item| format!("- {}\n", escaped(item)))
            .collect(),
        Block::Table(found) => table(found),
        Block::Notice(text) => format!("**{}**\n", escaped(text)),
        Block::Details(found) => {
            format!("{}\n\n```\n{}\n```\n", escaped(&found.summary), found.text)
        }
        Block::Command(text) => format!("```\n{text}\n```\n"),
        Block::Figure(Figure { file, caption, .. }) => {
            format!("![{0}]({file})\n\n*{0}*\n", escaped(caption))
        }
    }
}

fn table(table: &Table) -> String {
    let line = |fields: Vec<String>| format!("| {} |\n", fields.join(" | "));
    let head = table.head.iter().map(|text| escaped(text)).collect();
    let rule = table.head.iter().map(|_| "---".to_owned()).collect();
    let rows = table
        .rows
        .iter()
        .map(|row| line(row.iter().map(field).collect()));
    [line(head), line(rule)].into_iter().chain(rows).collect()
}

fn field(field: &Field) -> String {
    let text = escaped(&field.text);
    if field.bold {
        format!("**{text}**")
    } else {
        text
    }
}

/// Letters that would be marks.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        if matches!(letter, '|' | '*' | '_' | '`' | '<' | '[' | ']' | '\\' | '#') {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}
