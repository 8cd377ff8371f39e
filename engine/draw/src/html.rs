//! A report as one HTML file that needs nothing beside it: no script, no picture, no network.

use crate::RGBColor;
use crate::document::{Block, Details, Field, Figure, Table};
use crate::style::DARK;

const STYLE: &str = include_str!("report.css");

/// Writes the parts down.
pub fn html(blocks: &[Block]) -> String {
    let title = blocks.iter().find_map(|block| match block {
        Block::Title(text) => Some(escaped(text)),
        _ => None,
    });
    let body: String = blocks.iter().map(block).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{}</title>\n<style>\n{STYLE}{}</style>\n</head>\n<body>\n<main>\n{body}</main>\n\
         </body>\n</html>\n",
        title.unwrap_or_default(),
        dark_pictures(),
    )
}

/// In the dark, each colour of a picture gives way to its counterpart; rules outweigh the attributes
/// that the drawing library writes.
fn dark_pictures() -> String {
    let rule = |(light, dark): &(RGBColor, RGBColor)| {
        let [light, dark] = [light, dark].map(hexadecimal);
        format!(
            "  figure svg [fill=\"{light}\"] {{ fill: {dark}; }}\n  \
             figure svg [stroke=\"{light}\"] {{ stroke: {dark}; }}\n"
        )
    };
    let rules: String = DARK.iter().map(rule).collect();
    format!("@media (prefers-color-scheme: dark) {{\n{rules}}}\n")
}

/// As the drawing library writes it.
fn hexadecimal(color: &RGBColor) -> String {
    format!("#{:02X}{:02X}{:02X}", color.0, color.1, color.2)
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
                inline(svg, &caption)
            )
        }
        Block::Notice(text) => format!("<p class=\"notice\">{}</p>\n", escaped(text)),
        Block::Details(Details { summary, text }) => format!(
            "<details>\n<summary>{}</summary>\n<pre>{}</pre>\n</details>\n",
            escaped(summary),
            escaped(text)
        ),
    }
}

/// A frame of its own lets a wide table be moved within a narrow page.
fn table(table: &Table) -> String {
    let head: String = table
        .head
        .iter()
        .map(|text| format!("<th>{}</th>", escaped(text)))
        .collect();
    let begins_group = |row: &Vec<Field>| row.first().is_some_and(|first| !first.text.is_empty());
    let row = |row: &Vec<Field>| {
        let fields: String = row.iter().map(field).collect();
        let class = if begins_group(row) {
            " class=\"group\""
        } else {
            ""
        };
        format!("<tr{class}>{fields}</tr>\n")
    };
    let rows: String = table.rows.iter().map(row).collect();
    let grouped = !table.rows.iter().all(begins_group);
    let class = if grouped { " class=\"grouped\"" } else { "" };
    let named = table.head.iter().any(|name| !name.is_empty());
    let head = if named {
        format!("<thead><tr>{head}</tr></thead>\n")
    } else {
        String::new()
    };
    format!("<div class=\"wide\"><table{class}>\n{head}<tbody>\n{rows}</tbody>\n</table></div>\n")
}

fn field(field: &Field) -> String {
    let text = escaped(&field.text);
    if field.bold {
        format!("<td><b>{text}</b></td>")
    } else {
        format!("<td>{text}</td>")
    }
}

/// Widths of a sheet for each pixel that it needs at least for its letters to be read.
const SHEET_PER_PIXEL: f64 = 4.2;

/// From `<svg` on, since a declaration has no place within HTML; named for readers that do not see
/// it, and with the width below which a narrow page rather moves the picture than shrinks it.
fn inline(svg: &str, label: &str) -> String {
    let start = svg.find("<svg").unwrap_or(0);
    let width = svg[start..]
        .split_once("viewBox=\"0 0 ")
        .and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok());
    let least = width.map_or_else(String::new, |width| {
        format!(" style=\"--least: {:.0}px\"", width / SHEET_PER_PIXEL)
    });
    let named = format!("<svg role=\"img\" aria-label=\"{label}\"{least}");
    svg[start..].trim_end().replacen("<svg", &named, 1)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_from_files_stays_text() {
        let wild = "<script>alert(\"&\")</script>";
        let svg = "<?xml version=\"1.0\"?>\n<svg viewBox=\"0 0 1 1\"></svg>\n";
        let mut table = Table::new(&[wild]);
        table.push([wild.to_owned()]);
        let page = html(&[
            Block::Title(wild.to_owned()),
            Block::Heading(wild.to_owned()),
            Block::Subheading(wild.to_owned()),
            Block::Paragraph(wild.to_owned()),
            Block::List(vec![wild.to_owned()]),
            Block::Table(table),
            Block::Command(wild.to_owned()),
            Block::Notice(wild.to_owned()),
            Block::Details(Details {
                summary: wild.to_owned(),
                text: wild.to_owned(),
            }),
            Block::Figure(Figure {
                file: String::new(),
                svg: svg.to_owned(),
                caption: wild.to_owned(),
            }),
        ]);
        assert!(
            !page.contains("<script") && !page.contains("<?xml"),
            "{page}"
        );
        let written = "&lt;script&gt;alert(&quot;&amp;&quot;)&lt;/script&gt;";
        // The title stands twice, and so does a caption.
        assert_eq!(page.matches(written).count(), 14, "{page}");
    }
}
