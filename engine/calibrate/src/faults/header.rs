//! What the recording says of itself against what the object file says.

use pubs_run::recording::joint_name;

use super::{Checker, Severity};
use crate::fault::nearest;

pub(super) fn check(checker: &mut Checker<'_>, any_sensor: bool) {
    check_joint(checker);
    check_object(checker);
    check_sensor(checker, any_sensor);
    check_actions(checker);
}

fn check_joint(checker: &mut Checker<'_>) {
    let recorded = checker.recording.header.joint;
    let expected = checker.task.joint.joint_type();
    if recorded != expected {
        checker.add(
            Severity::Fault,
            checker.source.header("joint"),
            format!(
                "the recording is of a joint that is {}",
                joint_name(recorded)
            ),
            format!(
                "{}, as the joint of `{}` is",
                joint_name(expected),
                checker.task.name
            ),
            "give a recording of this object, or mend `joint.type` of the object file",
        );
    }
}

fn check_object(checker: &mut Checker<'_>) {
    let recorded = &checker.recording.header.object;
    if *recorded != checker.task.name {
        checker.add(
            Severity::Warning,
            checker.source.header("object"),
            format!("the recording is of `{recorded}`"),
            format!("`{}`", checker.task.name),
            "make sure that both are the same object",
        );
    }
}

fn check_sensor(checker: &mut Checker<'_>, any_sensor: bool) {
    let recorded = &checker.recording.header.sensor;
    let Some(expected) = checker.task.sensor.as_ref() else {
        return;
    };
    if recorded != expected {
        let severity = if any_sensor {
            Severity::Warning
        } else {
            Severity::Fault
        };
        checker.add(
            severity,
            checker.source.header("sensor"),
            format!("the forces are those of the sensor `{recorded}`"),
            format!("`{expected}`, as `source.sensor` of the object file says"),
            "record with that sensor, or accept this one with --accept-sensor",
        );
    }
}

fn check_actions(checker: &mut Checker<'_>) {
    let task = checker.task;
    let known = || task.actions.iter().map(|action| action.name.as_str());
    for name in &checker.recording.header.actions {
        if known().any(|action| action == name) {
            continue;
        }
        let cure = match nearest(name, known()) {
            Some(alike) => format!("is `{alike}` meant?"),
            None => "give a recording of this object".to_owned(),
        };
        checker.add(
            Severity::Fault,
            checker.source.header("actions"),
            format!("`{name}` is no action of `{}`", task.name),
            format!("only {}", known().collect::<Vec<_>>().join(", ")),
            cure,
        );
    }
}
