//! `--check`: whether the stored model still holds for a new recording.

use pubs_calibrate::calibration::all_traces;
use pubs_calibrate::drift::{Drift, drifts};
use pubs_calibrate::object_text::{StateUnit, segments_of};
use pubs_core::Task;
use serde::Serialize;

use super::Arguments;
use super::recordings::Checked;
use crate::failure::Failure;
use crate::{Ended, exit, show};

/// Offsets in N, shifts in SI.
#[derive(Serialize)]
struct Report {
    recordings: Vec<String>,
    /// Null where there is too little to tell of every channel.
    holds: Option<bool>,
    channels: Vec<Drift>,
    lost_data: bool,
}

/// Compares channel by channel.
///
/// # Errors
/// Where the recordings give no states, or the object has no model.
pub fn check(arguments: &Arguments, task: &Task, checked: &Checked) -> Ended {
    let unit = StateUnit::of(&task.joint);
    let stored = segments_of(&task.observation.table, unit)
        .map_err(|error| Failure::invalid(error.to_string()))?;
    if stored.is_empty() {
        return Err(Failure::invalid(format!(
            "{} has no calibration segments to compare with; calibrate without --check first",
            arguments.object.display()
        )));
    }
    let (traces, _) = all_traces(task, &checked.recordings)
        .map_err(|error| Failure::invalid(error.to_string()))?;
    let channels = drifts(task, &stored, &traces);
    let judged: Vec<bool> = channels
        .iter()
        .filter_map(|channel| channel.holds)
        .collect();
    let report = Report {
        recordings: checked
            .recordings
            .iter()
            .map(|(file, _)| file.clone())
            .collect(),
        holds: (!judged.is_empty()).then(|| judged.iter().all(|&holds| holds)),
        channels,
        lost_data: checked.lost,
    };
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&text(arguments, &report))?;
    }
    let well = report.holds == Some(true) && !checked.lost;
    Ok(if well { exit::DONE } else { exit::MISSED })
}

fn text(arguments: &Arguments, report: &Report) -> String {
    let head = match report.holds {
        Some(true) => "the stored model holds",
        Some(false) => "the stored model no longer holds",
        None => "too little to tell whether the stored model holds",
    };
    let mut text = format!(
        "{}: {head} (compared with {})\n",
        arguments.object.display(),
        report.recordings.join(", ")
    );
    for channel in &report.channels {
        let mark = match channel.holds {
            Some(true) => "holds",
            Some(false) => "OFF",
            None => "?",
        };
        text += &format!(
            "  {:<11} {:<4} {mark:<6} {}\n",
            channel.action,
            channel.channel.name(),
            channel.verdict
        );
    }
    if report.holds == Some(false) {
        text += &format!(
            "calibrate again: pubs-engine calibrate {} (the policy stays as it is)",
            arguments.object.display()
        );
    }
    text.trim_end().to_owned()
}
