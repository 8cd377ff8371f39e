//! Where along the joint each action was demonstrated.

use pubs_core::Task;
use pubs_draw::chart::{Chart, Key, Mark};
use pubs_draw::style::INK;
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
    let first = action(movements.first().map_or(0, |(index, _)| *index));
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
            Key::new(
                "readings of f_d, in the colour of the action",
                Mark::Area,
                first,
            ),
            Key::new("regions meet", Mark::Upright, INK),
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
            for [from, to] in stretches(&filled) {
                let state = |edge: usize| joint.at_fraction(edge as f64 / BINS as f64) * factor;
                let [start, end] = [from, to].map(|edge| panel.x.at(state(edge)));
                pen.rectangle([start, above], [end, below], action(*index), true)?;
            }
            let own = segments.iter().filter(|segment| {
                segment.action == movement.name && segment.channel == Channel::Along
            });
            for segment in own.filter(|segment| segment.from > joint.lower) {
                let x = panel.x.at(segment.from * factor);
                pen.line(&[[x, above - 8], [x, below + 8]], INK, 4)?;
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

/// First and one past the last bin of each stretch of filled ones.
fn stretches(filled: &[bool; BINS]) -> Vec<[usize; 2]> {
    let mut stretches: Vec<[usize; 2]> = Vec::new();
    for bin in (0..BINS).filter(|&bin| filled[bin]) {
        match stretches.last_mut() {
            Some([_, end]) if *end == bin => *end = bin + 1,
            _ => stretches.push([bin, bin + 1]),
        }
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_one_stretch() {
        let mut filled = [false; BINS];
        for bin in [0, 1, 5, 98, 99] {
            filled[bin] = true;
        }
        assert_eq!(stretches(&filled), [[0, 2], [5, 6], [98, 100]]);
        assert!(stretches(&[false; BINS]).is_empty());
    }
}
