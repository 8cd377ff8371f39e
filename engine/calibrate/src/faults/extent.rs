//! Whether the recording goes from limit to limit, and often enough.

use std::collections::BTreeSet;

use pubs_core::joint::Path;
use pubs_run::recording::Done;

use super::{Checker, Severity, pose};
use crate::fault::Place;

/// The share of the range that may be missing besides the give of the contact.
const RANGE_SHARE: f64 = 0.02;

pub(super) fn check(checker: &mut Checker<'_>, sound: &[bool], demonstrations: usize) {
    check_range(checker, sound);
    check_demonstrations(checker, demonstrations);
}

fn check_range(checker: &mut Checker<'_>, sound: &[bool]) {
    let (task, frames) = (checker.task, checker.frames());
    let joint = &task.joint;
    let Some(control) = task.control else { return };
    let poses: Vec<_> = (0..frames.len())
        .filter(|&row| sound[row])
        .map(|row| pose(&frames[row]))
        .collect();
    let path = poses.first().and_then(|grasp| Path::at_grasp(joint, grasp));
    let displacements = poses
        .iter()
        .filter_map(|pose| Some(path.as_ref()?.displacement(pose)));
    let (least, most) = displacements.fold((0.0_f64, 0.0_f64), |(least, most), displacement| {
        (least.min(displacement), most.max(displacement))
    });
    let give_m = control.force_threshold_n / control.contact_stiffness_n_per_m;
    let needed = joint.range() - give_m * joint.per_metre() - RANGE_SHARE * joint.range();
    if most - least >= needed {
        return;
    }
    checker.add(
        Severity::Fault,
        Place::File,
        format!(
            "the joint moves through {} in this recording",
            joint.display(most - least)
        ),
        format!(
            "at least {} of the {} between the limits",
            joint.display(needed),
            joint.display(joint.range())
        ),
        "record from one limit to the other, or mend the limits (or the radius) of the object file",
    );
}

fn check_demonstrations(checker: &mut Checker<'_>, needed: usize) {
    let (task, recording) = (checker.task, checker.recording);
    let header = &recording.header;
    let done: BTreeSet<(&str, u32)> = recording.done.iter().map(pair).collect();
    let begun: BTreeSet<(&str, u32)> = recording
        .frames
        .iter()
        .filter(|frame| frame.demonstration != 0)
        .filter_map(|frame| {
            Some((
                header.actions.get(frame.action)?.as_str(),
                frame.demonstration,
            ))
        })
        .collect();
    let of = |all: &BTreeSet<(&str, u32)>, name: &str| {
        all.iter().filter(|(action, _)| *action == name).count()
    };
    let moving = || task.actions.iter().filter(|action| !action.is_stop());
    let enough = |name: &str| of(&done, name) >= needed;
    if moving().all(|action| enough(&action.name)) {
        return;
    }
    let counts: Vec<String> = moving()
        .map(|action| {
            let (done, begun) = (of(&done, &action.name), of(&begun, &action.name));
            match begun.saturating_sub(done) {
                0 => format!("{} has {done}", action.name),
                more => format!("{} has {done} ({more} more begun)", action.name),
            }
        })
        .collect();
    checker.add(
        Severity::Fault,
        checker.source.done(),
        format!("too few demonstrations were carried out to their end: {}", counts.join(", ")),
        format!("at least {needed} of each"),
        "record the others; in a table, name those that were carried out, as in `# done = safe_open 1, safe_open 2`",
    );
}

fn pair(done: &Done) -> (&str, u32) {
    (&done.action, done.demonstration)
}
