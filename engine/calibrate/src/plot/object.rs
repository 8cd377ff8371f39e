//! The sheet of an object: its model, and the readings behind it.

use std::collections::BTreeSet;
use std::path::PathBuf;

use pubs_core::Task;

use super::{Panel, Picture, Sample, StateUnit};
use crate::calibration::samples;
use crate::fit::LEFT_OUT;
use crate::object_text;
use crate::segment::{Channel, Segment, Values};
use crate::traces::Trace;

/// What was felt, for each panel.
pub type Readings<'a> = Vec<(&'a str, Channel, Vec<Sample>)>;

/// Everything that was felt.
pub fn readings<'a>(task: &'a Task, traces: &[Trace]) -> Readings<'a> {
    task.movements()
        .flat_map(|(index, action)| {
            Channel::ALL.map(|channel| {
                let samples = samples(task, traces, index, channel);
                let samples = samples
                    .into_iter()
                    .map(|(state, value, _)| Sample { state, value });
                (action.name.as_str(), channel, samples.collect())
            })
        })
        .collect()
}

/// The whole sheet.
pub fn picture<'a>(
    task: &Task,
    segments: &'a [Segment],
    readings: &'a Readings<'a>,
    subtitle: String,
) -> Picture<'a> {
    let panel = |(action, channel, samples): &'a (&'a str, Channel, Vec<Sample>)| {
        let own: Vec<&Segment> = segments
            .iter()
            .filter(|segment| segment.action == *action && segment.channel == *channel)
            .collect();
        Panel {
            action,
            channel: *channel,
            left_out: left_out(task, segments, action),
            segments: own,
            samples,
        }
    };
    Picture {
        title: task.name.clone(),
        subtitle,
        unit: match object_text::StateUnit::of(&task.joint) {
            object_text::StateUnit::Degrees => StateUnit::Degrees,
            object_text::StateUnit::Metres => StateUnit::Centimetres,
        },
        limits: [task.joint.lower, task.joint.upper],
        force_threshold_n: task.control.map(|control| control.force_threshold_n),
        panels: readings.iter().map(panel).collect(),
    }
}

/// The end that high-force demonstrations left out: the last stretch towards the limit ahead, where
/// m_p says "blocked".
fn left_out(task: &Task, segments: &[Segment], action: &str) -> Vec<[f64; 2]> {
    let Some(action) = task.actions.iter().find(|known| known.name == action) else {
        return Vec::new();
    };
    let ahead = if action.sign() > 0.0 {
        task.joint.upper
    } else {
        task.joint.lower
    };
    let slack = 1e-6 * task.joint.range();
    let blocked = |segment: &&Segment| {
        let Values::Moves { probability } = segment.values else {
            return false;
        };
        let at_limit = (segment.from - ahead).abs() < slack || (segment.to - ahead).abs() < slack;
        segment.action == action.name && at_limit && probability < 0.5
    };
    let noted = |segment: &&Segment| segment.note.as_deref().is_none_or(|note| note == LEFT_OUT);
    segments
        .iter()
        .filter(|_| action.is_high_force())
        .filter(blocked)
        .filter(noted)
        .map(|segment| [segment.from, segment.to])
        .collect()
}

/// What the readings are.
pub fn subtitle(files: &[PathBuf], traces: &[Trace]) -> String {
    if files.is_empty() {
        return "segments of the object file; no recording".to_owned();
    }
    let names: Vec<String> = files
        .iter()
        .filter_map(|file| Some(file.file_name()?.to_string_lossy().into_owned()))
        .collect();
    let pulls: BTreeSet<u32> = traces.iter().map(|trace| trace.pull).collect();
    format!(
        "{} demonstrations of each action from {}",
        pulls.len(),
        names.join(", ")
    )
}
