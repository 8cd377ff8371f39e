//! What a calibration tells its user, and what it writes above the segments.

use std::collections::BTreeMap;
use std::path::PathBuf;

use pubs_calibrate::calibration::Calibration;
use pubs_calibrate::segment::extent;
use pubs_calibrate::spread::Judgement;
use pubs_calibrate::{Channel, Segment};
use pubs_core::Task;
use serde::Serialize;

use super::Arguments;
use super::recordings::Checked;

/// The result of a fit; states and errors in SI.
#[derive(Serialize)]
pub struct Report {
    object: PathBuf,
    recordings: Vec<String>,
    sensor: String,
    demonstrations: BTreeMap<String, usize>,
    /// Measured distance between the limits, one for each recording.
    ranges: Vec<Option<f64>>,
    segments: usize,
    channels: Vec<ChannelReport>,
    spread: Judgement,
    spread_independent: Judgement,
    proposal: Option<Judgement>,
    warnings: Vec<String>,
    written: bool,
    lost_data: bool,
    fit_s: f64,
}

/// One channel of one action.
#[derive(Serialize)]
struct ChannelReport {
    action: String,
    channel: Channel,
    segments: usize,
    /// Least and greatest mean, N, or probability.
    mean: [f64; 2],
    /// Least and greatest sigma, N; null for m_p.
    sigma_n: Option<[f64; 2]>,
}

/// Sums a calibration up.
pub fn report(
    arguments: &Arguments,
    task: &Task,
    checked: &Checked,
    calibration: &Calibration,
    fit_s: f64,
) -> Report {
    Report {
        object: arguments.object.clone(),
        recordings: checked
            .recordings
            .iter()
            .map(|(file, _)| file.clone())
            .collect(),
        sensor: checked.sensor.clone(),
        demonstrations: calibration.demonstrations.clone(),
        ranges: calibration
            .limits
            .iter()
            .map(|limits| limits.range)
            .collect(),
        segments: calibration.segments.len(),
        channels: channels(task, &calibration.segments),
        spread: calibration.stored.clone(),
        spread_independent: calibration.independent.clone(),
        proposal: calibration.proposal.clone(),
        warnings: calibration.warnings.clone(),
        written: !arguments.dry_run,
        lost_data: checked.lost,
        fit_s,
    }
}

fn channels(task: &Task, segments: &[Segment]) -> Vec<ChannelReport> {
    task.movements()
        .flat_map(|(_, action)| {
            Channel::ALL.map(|channel| {
                let own: Vec<&Segment> = segments
                    .iter()
                    .filter(|segment| segment.action == action.name && segment.channel == channel)
                    .collect();
                let means = own.iter().flat_map(|segment| segment.values.means());
                let sigmas = own.iter().flat_map(|segment| segment.values.sigmas());
                ChannelReport {
                    action: action.name.clone(),
                    channel,
                    segments: own.len(),
                    mean: extent(means.copied()).unwrap_or([f64::NAN; 2]),
                    sigma_n: extent(sigmas.copied()),
                }
            })
        })
        .collect()
}

/// The comment above the segments: what they rest on.
pub fn heading(task: &Task, checked: &Checked, calibration: &Calibration) -> Vec<String> {
    let demonstrations: Vec<String> = calibration
        .demonstrations
        .iter()
        .map(|(action, count)| format!("{action} {count}"))
        .collect();
    let seeds: Vec<String> = checked
        .recordings
        .iter()
        .map(|(_, recording)| {
            format!(
                "engine {}, seed {}",
                recording.header.engine, recording.header.seed
            )
        })
        .collect();
    let ranges: Vec<String> = calibration
        .limits
        .iter()
        .filter_map(|limits| limits.range)
        .map(|range| task.joint.display(range))
        .collect();
    vec![
        format!(
            "Demonstrations: {}; force sensor {}.",
            demonstrations.join(", "),
            checked.sensor
        ),
        format!(
            "Measured between the stops: {}. Recorded by {}.",
            ranges.join(", "),
            seeds.join("; ")
        ),
    ]
}

/// The report for a person.
pub fn text(task: &Task, report: &Report) -> String {
    let mut text = format!(
        "{}: {} segments from {} in {:.1} s{}\n",
        report.object.display(),
        report.segments,
        report.recordings.join(", "),
        report.fit_s,
        if report.written { "" } else { " (not written)" },
    );
    let demonstrations: Vec<String> = report
        .demonstrations
        .iter()
        .map(|(action, count)| format!("{action} {count}"))
        .collect();
    text += &format!("  demonstrations: {}\n", demonstrations.join(", "));
    for range in report.ranges.iter().flatten() {
        text += &format!(
            "  between the stops: {} (limits of the file: {})\n",
            task.joint.display(*range),
            task.joint.display(task.joint.range())
        );
    }
    text += "  action      channel  segments  mean (N; m_p: probability)   sigma (N)\n";
    for channel in &report.channels {
        let sigma = channel
            .sigma_n
            .map_or_else(String::new, |[low, high]| format!("{low:.2} .. {high:.2}"));
        let [low, high] = channel.mean;
        text += &format!(
            "  {:<11} {:<7}  {:>8}  {:<27}  {sigma}\n",
            channel.action,
            channel.channel.name(),
            channel.segments,
            format!("{low:.2} .. {high:.2}"),
        );
    }
    text += "  leave-one-pull-out     tempering  spacing_m  median error  90 % interval holds the truth\n";
    text += &spread_line(task, "stored", &report.spread);
    text += &spread_line(task, "independent readings", &report.spread_independent);
    if let Some(proposal) = &report.proposal {
        text += &spread_line(task, "proposed", proposal);
        text += &format!(
            "  to take the proposal: set tempering = {} and reading_spacing_m = {} under [belief], and train again\n",
            proposal.settings.tempering, proposal.settings.reading_spacing_m
        );
    }
    text.trim_end().to_owned()
}

fn spread_line(task: &Task, name: &str, judgement: &Judgement) -> String {
    if judgement.windows == 0 {
        return format!("  {name:<21}  not judged\n");
    }
    format!(
        "  {name:<21}  {:>9}  {:>9}  {:>12}  {:.1} % of {} windows\n",
        judgement.settings.tempering,
        judgement.settings.reading_spacing_m,
        task.joint.display(judgement.median_error),
        100.0 * judgement.coverage,
        judgement.windows,
    )
}
