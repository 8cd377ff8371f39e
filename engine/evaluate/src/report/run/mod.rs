//! The page of a run, from its recording.

mod expected;
mod figures;
mod provenance;
mod story;
mod tables;

use std::path::Path;

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_draw::DrawError;
use pubs_draw::document::{Block, Figure};
use pubs_run::Outcome;
use pubs_run::recording::RunRecording;

use crate::reproduce::numbers::decimal;
use expected::Expected;
use story::Story;

/// What a page is made of.
pub struct RunInput<'a> {
    /// The recording's file.
    pub file: &'a Path,
    /// What it holds.
    pub recording: &'a RunRecording,
    /// The object as it was in the run.
    pub task: &'a Task,
    /// Its observation model, or why there is none today.
    pub model: Result<&'a dyn Model, &'a str>,
}

/// What the recording lacks, each in words; nothing of a whole one.
pub fn missing(recording: &RunRecording) -> Vec<String> {
    let mut missing: Vec<String> = recording.loss.iter().cloned().collect();
    if recording.dropped > 0 {
        missing.push(format!(
            "the disk was too slow for {} entries of the recording",
            recording.dropped
        ));
    }
    if recording.report.is_none() {
        missing.push(
            "the run's own report is not in the recording: nobody knows how the run ended"
                .to_owned(),
        );
    }
    missing
}

/// The page: figures, their numbers, provenance.
///
/// # Errors
/// Where a picture cannot be drawn.
pub fn page(input: &RunInput<'_>) -> Result<Vec<Block>, DrawError> {
    let recording = input.recording;
    let story = Story::new(recording, input.task);
    let (expected, trouble) = expected(input, &story);
    let mut page = vec![
        Block::Title(format!("Run of {}", recording.header.object)),
        Block::Paragraph(headline(recording, &story)),
    ];
    page.extend(missing(recording).into_iter().map(Block::Notice));
    for stop in &recording.guard_stops {
        let reason = format!("The guard stopped the arm: {}", stop.reason);
        page.push(Block::Notice(reason));
    }
    page.extend(trouble.map(Block::Notice));
    page.push(Block::Heading("Figures".to_owned()));
    for picture in figures::pictures(&story, expected.as_ref())? {
        page.push(Block::Figure(Figure {
            file: String::new(),
            svg: picture.svg,
            caption: picture.caption,
        }));
    }
    page.extend(tables::guard_stops(&story));
    page.push(Block::Heading("Numbers".to_owned()));
    page.extend(tables::numbers(&story));
    page.push(Block::Heading("Provenance".to_owned()));
    page.extend(provenance::provenance(input));
    Ok(page)
}

/// The model's band, and why there is none where one could be expected.
fn expected(input: &RunInput<'_>, story: &Story<'_>) -> (Option<Expected>, Option<String>) {
    let without = |why: &str| format!("the forces stand without the model's band: {why}");
    let model = match input.model {
        Ok(model) => model,
        Err(why) => return (None, Some(without(why))),
    };
    match Expected::of(story, model) {
        Ok(Some(expected)) => (Some(expected), None),
        Ok(None) => {
            let why = "the observation model does not give mean and sigma of f_d";
            (None, Some(without(why)))
        }
        Err(error) => (None, Some(without(&error.to_string()))),
    }
}

/// How it went, in a sentence.
fn headline(recording: &RunRecording, story: &Story<'_>) -> String {
    let clock = if recording.run.lockstep {
        "on a virtual clock"
    } else {
        "in real time"
    };
    let Some(report) = &recording.report else {
        return format!(
            "{} s {clock} are recorded; how the run ended is not.",
            decimal(story.end_s(), 2)
        );
    };
    let reached = |goal: &&pubs_run::GoalReport| goal.outcome == Outcome::Reached;
    let count = report.goals.iter().filter(reached).count();
    format!(
        "Outcome: {}; {count} of {} goals reached in {} s {clock}.",
        tables::outcome(report.outcome),
        recording.run.goals.len(),
        decimal(report.time_s, 2),
    )
}
