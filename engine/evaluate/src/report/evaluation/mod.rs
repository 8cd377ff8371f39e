//! The page of an evaluation, from the JSON that `evaluate` prints.

mod figures;
mod judged;
mod tables;

pub use judged::{Judged, NotJudged, read};

use std::path::Path;

use pubs_draw::DrawError;
use pubs_draw::document::{Block, Details};

/// The page: figures, numbers, provenance. `source` is where the JSON comes from, `text` the JSON.
///
/// # Errors
/// Where a picture cannot be drawn.
pub fn page(source: &Path, text: &str, judged: &[Judged]) -> Result<Vec<Block>, DrawError> {
    let mut page = vec![
        Block::Title(title(judged)),
        Block::Paragraph(headline(judged)),
        Block::Heading("Figures".to_owned()),
    ];
    page.extend(figures::figures(judged)?.into_iter().map(Block::Figure));
    page.push(Block::Heading("Numbers".to_owned()));
    page.extend(tables::numbers(judged).into_iter().map(Block::Table));
    page.push(Block::Heading("Provenance".to_owned()));
    let provenance = tables::provenance(source, judged);
    page.extend(provenance.into_iter().map(Block::Table));
    page.push(Block::Details(Details {
        summary: "The JSON".to_owned(),
        text: text.trim().to_owned(),
    }));
    Ok(page)
}

fn title(judged: &[Judged]) -> String {
    let first = judged.first().map(Judged::subject).unwrap_or_default();
    format!("Evaluation on {first}")
}

fn headline(judged: &[Judged]) -> String {
    match judged {
        [one] => format!("One policy, judged on {} simulated trials.", one.trials),
        several => format!(
            "{} policies, judged on the same simulated trials, {} each.",
            several.len(),
            several.first().map_or(0, |one| one.trials)
        ),
    }
}
