//! Every key of the object file, in one place. The check, the JSON Schema for editors and the
//! texts of faults are all made from this table.

use super::schema::{
    FINITE, Key, Kind, NOT_POSITIVE, Need, POSITIVE, above_below, above_to, from_to,
};
use Need::{Absent as A, Defaulted as D, Optional as O, Required as R};

/// Joint types that have the key: all three, revolute, prismatic, the two of an arm, abstract.
const ALL_MUST: [Need; 3] = [R, R, R];
const ALL_MAY: [Need; 3] = [O, O, O];
const ALL_DEFAULT: [Need; 3] = [D, D, D];
const REVOLUTE_MUST: [Need; 3] = [R, A, A];
const PRISMATIC_MUST: [Need; 3] = [A, R, A];
const ARM_MUST: [Need; 3] = [R, R, A];
const ARM_MAY: [Need; 3] = [O, O, A];
const ARM_DEFAULT: [Need; 3] = [D, D, A];
const ABSTRACT_MUST: [Need; 3] = [A, A, R];
const ABSTRACT_MAY: [Need; 3] = [A, A, O];
/// An arm takes the engine's default, an abstract object states its own.
const STATED: [Need; 3] = [D, D, R];

const fn key(
    path: &'static str,
    need: [Need; 3],
    kind: Kind,
    unit: &'static str,
    doc: &'static str,
) -> Key {
    Key {
        path,
        need,
        kind,
        unit,
        doc,
    }
}

/// The table. A table's own line comes before its keys'.
#[rustfmt::skip] // one key per line or two, so that the table reads as one
pub const KEYS: &[Key] = &[
    key("schema", ALL_MUST, Kind::Whole(from_to(1.0, 1.0)), "", "Version of the file format; 1."),
    key("name", ALL_MUST, Kind::Name, "", "Name of the object; its policies are named after it."),

    key("source", [R, R, O], Kind::Table, "", "Where the numbers of this file come from."),
    key("source.kind", ALL_MUST, Kind::Choice(&["measured", "virtual", "assumed"]), "",
        "How the numbers were obtained: from demonstrations on the real object, from a virtual world, or by judgement."),
    key("source.sensor", ALL_MAY, Kind::Text, "",
        "The force sensor they were obtained with; a driver with another sensor is refused. Required unless the numbers are assumed."),

    key("joint", ALL_MUST, Kind::Table, "", "The joint that is moved."),
    key("joint.type", ALL_MUST, Kind::Choice(&["revolute", "prismatic", "abstract"]), "",
        "A hinge, a slide, or a benchmark in plain numbers."),
    key("joint.limits_deg", REVOLUTE_MUST, Kind::Numbers(2, from_to(-360.0, 360.0)), "degrees",
        "The closed and the open limit."),
    key("joint.limits_m", PRISMATIC_MUST, Kind::Numbers(2, from_to(-10.0, 10.0)), "m",
        "The closed and the open limit."),
    key("joint.limits", ABSTRACT_MUST, Kind::Numbers(2, FINITE), "", "The lower and the upper limit."),
    key("joint.radius_m", REVOLUTE_MUST, Kind::Number(above_to(0.0, 10.0)), "m",
        "From the hinge axis to the handle."),
    key("joint.opening_direction", ARM_MUST, Kind::Numbers(3, FINITE), "tool axes at the grasp",
        "Where the handle goes when the joint opens; any length but zero."),
    key("joint.hinge_direction", REVOLUTE_MUST, Kind::Numbers(3, FINITE), "tool axes at the grasp",
        "From the handle towards the hinge axis, at a right angle to opening_direction; any length but zero."),
    key("joint.up_direction", ARM_MUST, Kind::Numbers(3, FINITE), "tool axes at the grasp",
        "Up; only its part across the motion counts; any length but zero."),
    key("joint.motion_threshold_m", ARM_DEFAULT, Kind::Number(above_to(0.0, 0.1)), "m",
        "m_p is 1 where the handle moved more than this between two filter updates."),
    key("joint.start", ABSTRACT_MAY, Kind::Numbers(2, FINITE), "",
        "Where the state may be at first; the limits where left out."),
    key("joint.integer", ABSTRACT_MAY, Kind::Flag, "", "Whether states are whole numbers; false where left out."),
    key("joint.goal", ABSTRACT_MAY, Kind::Number(FINITE), "",
        "The goal where --goal is left out."),

    key("action", ABSTRACT_MUST, Kind::Tables, "", "The actions in index order; they replace the five of an arm."),
    key("action.*.name", ABSTRACT_MUST, Kind::Name, "", "Name of the action, unique in the file."),
    key("action.*.stop", ABSTRACT_MAY, Kind::Flag, "", "Whether the action ends the episode; exactly one does."),
    key("action.*.move", ABSTRACT_MAY, Kind::Number(FINITE), "",
        "Signed displacement; required for every action but stop."),
    key("action.*.observations", ABSTRACT_MAY, Kind::Whole(from_to(1.0, 10_000.0)), "",
        "The move is carried out as this many sub-moves, each with an observation and a weight update; 1 where left out."),
    key("action.*.high_force", ABSTRACT_MAY, Kind::Flag, "",
        "Whether the action can violate safety; false where left out."),

    key("control", ARM_DEFAULT, Kind::Table, "", "The controller."),
    key("control.rate_hz", ARM_DEFAULT, Kind::Number(from_to(1.0, 1000.0)), "Hz", "Commands to the arm per second."),
    key("control.safe_speed_m_s", ARM_DEFAULT, Kind::Number(above_to(0.0, 2.0)), "m/s", "Speed of the handle in safe mode."),
    key("control.high_speed_m_s", ARM_DEFAULT, Kind::Number(above_to(0.0, 2.0)), "m/s", "Speed of the handle in high-force mode."),
    key("control.force_threshold_n", ARM_DEFAULT, Kind::Number(above_to(0.0, 1000.0)), "N",
        "Safe mode stops where the force against the motion passes this (F_t)."),
    key("control.force_limit_n", ARM_DEFAULT, Kind::Number(above_to(0.0, 1000.0)), "N", "Any mode stops above this force."),
    key("control.acceleration_m_s2", ARM_DEFAULT, Kind::Number(above_to(0.0, 50.0)), "m/s²", "Bound on speeding up."),
    key("control.stop_deceleration_m_s2", ARM_DEFAULT, Kind::Number(above_to(0.0, 50.0)), "m/s²", "Deceleration of every stop."),
    key("control.contact_stiffness_n_per_m", ARM_DEFAULT, Kind::Number(above_to(0.0, 1e6)), "N/m",
        "Stiffness of grasp and object at a hard stop; with it the force of the worst stop is worked out."),

    key("belief", STATED, Kind::Table, "", "The particle filter."),
    key("belief.filter", STATED, Kind::Choice(&["sis", "rao_blackwell"]), "",
        "\"sis\": sequential importance sampling without resampling; \"rao_blackwell\": each particle also estimates the sensor's offset and the change of friction (not for abstract objects)."),
    key("belief.particles", STATED, Kind::Whole(from_to(2.0, 1e6)), "", "Number of particles."),
    key("belief.rate_hz", ARM_DEFAULT, Kind::Number(from_to(0.1, 1000.0)), "Hz",
        "Filter updates per second; a whole number of them to each policy step."),
    key("belief.tempering", STATED, Kind::Number(above_to(0.0, 1.0)), "",
        "Exponent on the likelihood of each counted force reading; 1 takes it at its word."),
    key("belief.reading_spacing_m", ARM_DEFAULT, Kind::Number(from_to(0.0, 1.0)), "m",
        "One force reading counts per this much travel or reversal; 0 counts every update."),
    key("belief.offset_sd_n", ARM_DEFAULT, Kind::Number(from_to(0.0, 1000.0)), "N",
        "How large an offset a tare leaves in each axis of the force sensor, standard deviation; \"rao_blackwell\" alone uses it."),
    key("belief.offset_walk_n", ARM_DEFAULT, Kind::Number(from_to(0.0, 1000.0)), "N",
        "How much that offset changes from one counted reading to the next, standard deviation; \"rao_blackwell\" alone uses it."),
    key("belief.friction_sd_n", ARM_DEFAULT, Kind::Number(from_to(0.0, 1000.0)), "N",
        "How far the object's friction may be from what it was at calibration, standard deviation; \"rao_blackwell\" alone uses it."),

    key("policy", ALL_DEFAULT, Kind::Table, "", "The policy and how often it acts."),
    key("policy.rate_hz", ARM_DEFAULT, Kind::Number(from_to(0.1, 1000.0)), "Hz", "Actions chosen per second."),
    key("policy.layers", ALL_DEFAULT, Kind::Wholes(from_to(1.0, 1024.0)), "units",
        "Width of each hidden layer of the policy, and of the value network that trains it."),
    key("policy.shield", ALL_DEFAULT, Kind::Table, "", "When high-force actions are masked near a limit."),
    key("policy.shield.mass", ALL_DEFAULT, Kind::Number(above_below(0.0, 1.0)), "",
        "A high-force action is masked where more probability than this lies within one such step, and a margin for what the handle may be ahead of the belief, of the limit."),
    key("policy.shield.flattening", ALL_DEFAULT, Kind::Number(above_to(0.0, 1.0)), "",
        "Exponent on the weights before they are summed: below 1 it makes the shield more careful than the belief."),

    key("reward", STATED, Kind::Table, "", "The reward."),
    key("reward.shape", STATED, Kind::Choice(&["proximity", "flat"]), "",
        "Inside the goal region: falling linearly from the goal to the edge, or full everywhere."),
    key("reward.goal_tolerance_deg", REVOLUTE_MUST, Kind::Number(POSITIVE), "degrees",
        "Half the width of the goal region; less than half the range."),
    key("reward.goal_tolerance_m", PRISMATIC_MUST, Kind::Number(POSITIVE), "m",
        "Half the width of the goal region; less than half the range."),
    key("reward.goal_tolerance", ABSTRACT_MUST, Kind::Number(POSITIVE), "",
        "Half the width of the goal region; less than half the range."),
    key("reward.goal", STATED, Kind::Number(POSITIVE), "", "For stopping at the goal."),
    key("reward.failed_stop", STATED, Kind::Number(NOT_POSITIVE), "", "For stopping outside the goal region."),
    key("reward.safety_violation", STATED, Kind::Number(NOT_POSITIVE), "",
        "For a high-force action that would pass a limit; it ends the episode."),
    key("reward.time", STATED, Kind::Number(NOT_POSITIVE), "", "For each policy step."),
    key("reward.discount", STATED, Kind::Number(above_below(0.0, 1.0)), "", "Discount per policy step."),

    key("driver", ARM_MAY, Kind::Table, "", "The arm that runs this object; without it the object can be trained and evaluated, not run."),
    key("driver.plugin", ARM_MUST, Kind::Text, "", "Name of a driver plugin."),
    key("driver.params", ARM_MAY, Kind::Plugin, "", "The driver's own parameters; its schema checks them."),

    key("observation", [D, D, R], Kind::Table, "", "The observation model."),
    key("observation.model", STATED, Kind::Text, "", "Name of an observation-model plugin."),
    key("observation.bias_sd_n", ARM_DEFAULT, Kind::Number(from_to(0.0, 1000.0)), "N",
        "The trainer's simulator draws a force bias of this standard deviation per episode; 0 for none."),
    key("observation.correlation_m", ARM_DEFAULT, Kind::Number(from_to(0.0, 10.0)), "m",
        "The trainer's simulator correlates force noise over this much travel; 0 for independent noise."),
    key("observation.params", ALL_MAY, Kind::Plugin, "", "The model's own parameters; its schema checks them."),
    key("observation.segment", ALL_MAY, Kind::Plugin, "",
        "Calibration segments, written by `pubs-engine calibrate`; the model's schema checks them."),
];

/// The key at a path of the table (list elements as `*`).
pub fn find(path: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.path == path)
}

/// The keys directly inside the table at `parent` (empty for the root).
pub fn children(parent: &str) -> impl Iterator<Item = &'static Key> {
    KEYS.iter().filter(move |key| key.parent() == parent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_a_table_and_stands_once() {
        for (index, key) in KEYS.iter().enumerate() {
            let first = KEYS.iter().position(|other| other.path == key.path);
            assert_eq!(first, Some(index), "{} stands twice", key.path);
            let parent = key.parent().trim_end_matches(".*");
            assert!(
                parent.is_empty() || find(parent).is_some(),
                "{} is in no table",
                key.path
            );
            assert!(key.doc.ends_with('.'), "{}: a doc is a sentence", key.path);
        }
    }
}
