//! Where along the joint each action was demonstrated.

use pubs_core::Task;
use pubs_draw::chart::{Chart, Key, Mark};
use pubs_draw::style::{BAND_EDGE, TRUTH};
use pubs_draw::{DrawError, action};

use crate::Segment;
use crate::calibration::samples;
use crate::object_text::StateUnit;
use crate::segment::Channel;
use crate::traces::Trace;

/// Bins of the joint's range.
const BINS: usize = 100;

/// A lane per action: shaded where there are readings, marked where regions of f_d meet. With its
/// caption.
pub(super) fn figure(
    task: &Task,
    segments: &[Segment],
    traces: &[Trace],
) -> Result<(String, String), DrawError> {
    /// Share of a lane that is filled.
    const FILLED: f64 = 0.6;
    let joint = &task.joint;
    let (factor, x_title) = match StateUnit::of(joint) {
        StateUnit::Degrees => (1_f64.to_degrees(), "joint state, degrees"),
        StateUnit::Metres => (100.0, "joint state, cm"),
    };
    let movements: Vec<_> = task.movements().collect();
    let middle = |lane: usize| movements.len() as f64 - lane as f64 - 0.5;
    let names = movements.iter().enumerate();
    let chart = Chart {
        title: "Where readings were taken",
        height: 100 * movements.len() as i32,
        x_title,
        y_title: "",
        x: [joint.lower, joint.upper].map(|limit| limit * factor),
        y: [0.0, movements.len() as f64],
        x_names: None,
        y_names: Some(
            names
                .map(|(lane, (_, action))| (middle(lane), action.name.clone()))
                .collect(),
        ),
        key: vec![
            Key::new("readings of f_d", Mark::Area, BAND_EDGE),
            Key::new("regions meet", Mark::Upright, TRUTH),
        ],
    };
    let mut shares = Vec::new();
    let svg = chart.svg(|pen, panel| {
        for (lane, (index, movement)) in movements.iter().enumerate() {
            let edges = [-0.5, 0.5].map(|side| panel.y.at(middle(lane) + side * FILLED));
            let [below, above] = edges;
            let filled = filled(task, traces, *index);
            let count = filled.iter().filter(|filled| **filled).count();
            shares.push(format!("{} {count} %", movement.name));
            for bin in (0..BINS).filter(|&bin| filled[bin]) {
                let state = |bin: usize| joint.at_fraction(bin as f64 / BINS as f64) * factor;
                let [start, end] = [bin, bin + 1].map(|edge| panel.x.at(state(edge)));
                pen.rectangle([start, above], [end, below], action(*index), true)?;
            }
            let own = segments.iter().filter(|segment| {
                segment.action == movement.name && segment.channel == Channel::Along
            });
            for segment in own.filter(|segment| segment.from > joint.lower) {
                let x = panel.x.at(segment.from * factor);
                pen.line(&[[x, above - 8], [x, below + 8]], TRUTH, 5)?;
            }
        }
        Ok(())
    })?;
    let caption = format!(
        "Hundredths of the range in which f_d was read at least once: {}.",
        shares.join(", ")
    );
    Ok((svg, caption))
}

/// Bins with a reading.
fn filled(task: &Task, traces: &[Trace], action: usize) -> [bool; BINS] {
    let mut filled = [false; BINS];
    for (state, ..) in samples(task, traces, action, Channel::Along) {
        let fraction = (state - task.joint.lower) / task.joint.range();
        if (0.0..=1.0).contains(&fraction) {
            filled[((fraction * BINS as f64) as usize).min(BINS - 1)] = true;
        }
    }
    filled
}
