//! A report as one HTML file that needs nothing beside it: no script, no picture, no network.

use super::document::{Block, Field, Figure, Table};

const STYLE: &str = include_str!("report.css");

/// Writes the parts down.
pub(super) fn html(blocks: &[Block]) -> String {
    let title = blocks.iter().find_map(|block| match block {
        Block::Title(text) => Some(escaped(text)),
        _ => None,
    });
    let body: String = blocks.iter().map(block).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n\
         </body>\n</html>\n",
        title.unwrap_or_default()
    )
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("<h1>{}</h1>\n", escaped(text)),
        Block::Heading(text) => format!("<h2>{}</h2>\n", escaped(text)),
        Block::Subheading(text) => format!("<h3>{}</h3>\n", escaped(text)),
        Block::Paragraph(text) => format!("<p>{}</p>\n", escaped(text)),
        Block::List(items) => {
            let item = |text: &String| format!("<li>{}</li>\n", escaped(text));
            format!(
                "<ul>\n{}</ul>\n",
                items.iter().map(item).collect::<String>()
            )
        }
        Block::Table(found) => table(found),
        Block::Command(text) => format!("<pre>{}</pre>\n", escaped(text)),
        Block::Figure(Figure { svg, caption, .. }) => {
            let caption = escaped(caption);
            format!(
                "<figure>\n{}\n<figcaption>{caption}</figcaption>\n</figure>\n",
                inline(svg)
            )
        }
    }
}

/// A frame of its own lets a wide table be moved within a narrow page.
fn table(table: &Table) -> String {
    let head: String = table
        .head
        .iter()
        .map(|text| format!("<th>{}</th>", escaped(text)))
        .collect();
    let row = |row: &Vec<Field>| {
        let fields: String = row.iter().map(field).collect();
        // A row that begins with a name begins a group.
        let group = row.first().is_some_and(|first| !first.text.is_empty());
        let class = if group { " class=\"group\"" } else { "" };
        format!("<tr{class}>{fields}</tr>\n")
    };
    let rows: String = table.rows.iter().map(row).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n"
    )
}

fn field(field: &Field) -> String {
    let text = escaped(&field.text);
    if field.bold {
        format!("<td><b>{text}</b></td>")
    } else {
        format!("<td>{text}</td>")
    }
}

/// From `<svg` on: a declaration has no place within HTML.
fn inline(svg: &str) -> &str {
    let start = svg.find("<svg").unwrap_or(0);
    svg[start..].trim_end()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
