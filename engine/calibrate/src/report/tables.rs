//! The numbers of a calibration.

use pubs_core::Task;
use pubs_draw::document::Table;
use pubs_run::recording::Recording;

use super::CalibrationInput;
use crate::calibration::Calibration;
use crate::drift::Drift;
use crate::segment::{Segment, extent};
use crate::spread::Judgement;
use crate::traces::Limits;

/// Stands where there is nothing to say.
const NOTHING: &str = "–";

fn or_nothing<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or_else(|| NOTHING.to_owned(), text)
}

fn span([low, high]: [f64; 2]) -> String {
    format!("{low:.2} .. {high:.2}")
}

/// A row per action and channel: the stored model, and how readings agree with it.
pub(super) fn channels(task: &Task, segments: &[Segment], drifts: &[Drift]) -> Table {
    let mut table = Table::new(&[
        "action",
        "channel",
        "regions",
        "mean (N; m_p: probability)",
        "sigma, N",
        "readings",
        "demonstrations",
        "offset, N",
        "shift",
        "rms / sigma",
        "beyond 2 sigma",
        "holds",
    ]);
    for drift in drifts {
        let own = || {
            segments.iter().filter(|segment| {
                segment.action == drift.action && segment.channel == drift.channel
            })
        };
        let means = own().flat_map(|segment| segment.values.means());
        let sigmas = own().flat_map(|segment| segment.values.sigmas());
        table.push([
            drift.action.clone(),
            drift.channel.name().to_owned(),
            own().count().to_string(),
            or_nothing(extent(means.copied()), span),
            or_nothing(extent(sigmas.copied()), span),
            drift.samples.to_string(),
            drift.demonstrations.to_string(),
            or_nothing(drift.offset_n, |offset| format!("{:+.2}", offset.value)),
            or_nothing(drift.shift, |shift| task.joint.display(shift.value)),
            or_nothing(drift.sigma_ratio, |ratio| format!("{ratio:.2}")),
            or_nothing(drift.outside, |share| format!("{:.1} %", 100.0 * share)),
            match drift.holds {
                Some(true) => "yes",
                Some(false) => "no",
                None => "too little to tell",
            }
            .to_owned(),
        ]);
    }
    table
}

pub(super) fn verdicts(drifts: &[Drift]) -> Table {
    let mut table = Table::new(&["action", "channel", "verdict"]);
    for drift in drifts {
        table.push([
            drift.action.clone(),
            drift.channel.name().to_owned(),
            drift.verdict.clone(),
        ]);
    }
    table
}

/// How often the 90 % interval held the truth.
pub(super) fn coverage(task: &Task, calibration: &Calibration) -> Table {
    let mut table = Table::new(&[
        "settings",
        "tempering",
        "spacing, m",
        "median error",
        "90 % interval holds the truth",
        "windows",
    ]);
    let judgements = [
        ("stored", Some(&calibration.stored)),
        ("independent readings", Some(&calibration.independent)),
        ("proposed", calibration.proposal.as_ref()),
    ];
    for (name, judgement) in judgements {
        let Some(judgement) = judgement else { continue };
        let judged = |text: String| {
            if judgement.windows == 0 {
                "not judged".to_owned()
            } else {
                text
            }
        };
        let Judgement { settings, .. } = judgement;
        table.push([
            name.to_owned(),
            settings.tempering.to_string(),
            settings.reading_spacing_m.to_string(),
            judged(task.joint.display(judgement.median_error)),
            judged(format!("{:.1} %", 100.0 * judgement.coverage)),
            judgement.windows.to_string(),
        ]);
    }
    table
}

pub(super) fn limits(task: &Task, recordings: &[(String, Recording)], limits: &[Limits]) -> Table {
    let mut table = Table::new(&[
        "recording",
        "closed touched",
        "open touched",
        "range between them",
        "range of the file",
        "touches differ by",
    ]);
    for ((file, _), found) in recordings.iter().zip(limits) {
        table.push([
            file.clone(),
            found.closed_touches.to_string(),
            found.open_touches.to_string(),
            or_nothing(found.range, |range| task.joint.display(range)),
            task.joint.display(task.joint.range()),
            task.joint.display(found.scatter),
        ]);
    }
    table
}

/// The model in full.
pub(super) fn regions(task: &Task, segments: &[Segment]) -> Table {
    let mut table = Table::new(&[
        "action",
        "channel",
        "from",
        "to",
        "mean (N; m_p: probability)",
        "sigma, N",
        "note",
    ]);
    for segment in segments {
        table.push([
            segment.action.clone(),
            segment.channel.name().to_owned(),
            task.joint.display(segment.from),
            task.joint.display(segment.to),
            or_nothing(extent(segment.values.means().iter().copied()), span),
            or_nothing(extent(segment.values.sigmas().iter().copied()), span),
            segment.note.clone().unwrap_or_default(),
        ]);
    }
    table
}

pub(super) fn provenance(input: &CalibrationInput<'_>) -> Table {
    let mut table = Table::new(&[
        "",
        "engine",
        "format",
        "force sensor",
        "seed",
        "frames",
        "demonstrations",
    ]);
    for (file, recording) in input.recordings {
        let header = &recording.header;
        table.push([
            file.clone(),
            header.engine.clone(),
            header.format.to_string(),
            header.sensor.clone(),
            header.seed.to_string(),
            recording.frames.len().to_string(),
            recording.done.len().to_string(),
        ]);
    }
    let object = [
        input.source,
        NOTHING,
        NOTHING,
        input.task.sensor.as_deref().unwrap_or(NOTHING),
        NOTHING,
        NOTHING,
        NOTHING,
    ];
    table.push(object.map(str::to_owned));
    table
}
