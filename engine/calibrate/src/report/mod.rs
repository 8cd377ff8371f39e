//! The page of a calibration: the sheet of [`plot`] and where it was read, then the
//! numbers, then where they come from.

mod reach;
mod tables;

use std::path::PathBuf;

use pubs_core::Task;
use pubs_draw::document::{Block, Details, Figure};
use pubs_run::recording::Recording;

use crate::Segment;
use crate::calibration::{CalibrationError, all_traces, calibrate};
use crate::drift::{Drift, drifts};
use crate::plot::{self, PlotError};

/// What a page is made of.
pub struct CalibrationInput<'a> {
    /// Where the object file comes from, for people.
    pub source: &'a str,
    /// Its text.
    pub object_toml: &'a str,
    /// The object.
    pub task: &'a Task,
    /// Its stored model; none before its first calibration.
    pub segments: &'a [Segment],
    /// File and content of each recording.
    pub recordings: &'a [(String, Recording)],
}

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationPageError {
    /// The recordings give no readings of this object.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The sheet cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// Another picture cannot be drawn.
    #[error(transparent)]
    Draw(#[from] pubs_draw::DrawError),
}

/// The page.
///
/// # Errors
/// [`CalibrationPageError`].
pub fn page(input: &CalibrationInput<'_>) -> Result<Vec<Block>, CalibrationPageError> {
    let CalibrationInput { task, segments, .. } = input;
    let (traces, limits) = all_traces(task, input.recordings)?;
    let readings = plot::readings(task, &traces);
    let files: Vec<PathBuf> = input
        .recordings
        .iter()
        .map(|(file, _)| file.into())
        .collect();
    let subtitle = plot::subtitle(&files, &traces);
    let sheet = plot::svg(&plot::picture(task, segments, &readings, subtitle))?;
    let drifts = drifts(task, segments, &traces);
    let mut page = vec![
        Block::Title(format!("Calibration of {}", task.name)),
        Block::Paragraph(headline(input, &drifts)),
        Block::Heading("Figures".to_owned()),
        figure(
            sheet,
            "Readings, regions, mean and ±2 sigma of each channel (rows) and action (columns) over \
             the joint's range; dashed, the force above which safe mode stops.",
        ),
    ];
    if !input.recordings.is_empty() {
        let (svg, caption) = reach::figure(task, segments, &traces)?;
        page.push(figure(svg, &caption));
    }
    page.push(Block::Heading("Numbers".to_owned()));
    page.push(Block::Subheading("Channels".to_owned()));
    page.push(Block::Table(tables::channels(task, segments, &drifts)));
    if !input.recordings.is_empty() {
        page.push(Block::Subheading("What the channels say".to_owned()));
        page.push(Block::Table(tables::verdicts(&drifts)));
        page.extend(held_out(input));
        page.push(Block::Subheading("Limits".to_owned()));
        page.push(Block::Table(tables::limits(
            task,
            input.recordings,
            &limits,
        )));
    }
    page.push(Block::Subheading("Regions".to_owned()));
    page.push(Block::Table(tables::regions(task, segments)));
    page.push(Block::Heading("Provenance".to_owned()));
    page.push(Block::Table(tables::provenance(input)));
    page.push(Block::Details(Details {
        summary: "The object file".to_owned(),
        text: input.object_toml.to_owned(),
    }));
    Ok(page)
}

fn figure(svg: String, caption: &str) -> Block {
    Block::Figure(Figure {
        file: String::new(),
        svg,
        caption: caption.to_owned(),
    })
}

fn headline(input: &CalibrationInput<'_>, drifts: &[Drift]) -> String {
    let regions = input.segments.len();
    if regions == 0 {
        return "The object file holds no model yet: what was felt stands alone.".to_owned();
    }
    if input.recordings.is_empty() {
        return format!("A model of {regions} regions; no recording was found to hold it against.");
    }
    let judged: Vec<bool> = drifts.iter().filter_map(|drift| drift.holds).collect();
    let off = judged.iter().filter(|holds| !**holds).count();
    match (judged.len(), off) {
        (0, _) => format!(
            "A model of {regions} regions; the recordings are too short to say whether it holds."
        ),
        (all, 0) => format!(
            "A model of {regions} regions, which holds for these recordings in all {all} channels judged."
        ),
        (all, off) => format!(
            "A model of {regions} regions, which does not hold for these recordings in {off} of {all} channels judged."
        ),
    }
}

/// How honest the belief is: each demonstration held out in turn.
fn held_out(input: &CalibrationInput<'_>) -> Vec<Block> {
    let heading = Block::Subheading("Coverage: each demonstration held out in turn".to_owned());
    match calibrate(input.task, input.recordings) {
        Ok(calibration) => {
            let table = tables::coverage(input.task, &calibration);
            let warnings = calibration.warnings.into_iter().map(Block::Notice);
            [heading, Block::Table(table)]
                .into_iter()
                .chain(warnings)
                .collect()
        }
        Err(error) => vec![heading, Block::Notice(format!("Not judged: {error}"))],
    }
}
