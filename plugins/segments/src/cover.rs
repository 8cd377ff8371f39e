//! The segments of each action and channel must tile the range of the joint.

use pubs_plugin::{ActionSetup, JointSetup, ModelSetup};

use crate::channel;
use crate::faults::Faults;
use crate::piecewise::Segment;
use crate::unit::Unit;

/// What is known of a segment that could not be read: where it may belong, no gap is reported,
/// since its own fault is.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Unplaced {
    /// Its action, where known.
    pub(crate) action: Option<usize>,
    /// Its channel, where known.
    pub(crate) channel: Option<usize>,
}

impl Unplaced {
    fn may_be_of(self, action: usize, channel: usize) -> bool {
        self.action.is_none_or(|own| own == action) && self.channel.is_none_or(|own| own == channel)
    }
}

/// How far boundaries may miss each other: a millionth of the range.
pub(crate) fn tolerance(joint: &JointSetup) -> f64 {
    1e-6 * (joint.upper - joint.lower)
}

/// Reports gaps, overlaps, segments beyond the limits and missing channels.
pub(crate) fn check(
    setup: &ModelSetup,
    segments: &[Segment],
    unplaced: &[Unplaced],
    faults: &mut Faults,
) {
    let mut without = Vec::new();
    for (action, action_setup) in movements(&setup.actions) {
        for (channel, channel_name) in channel::NAMES.iter().enumerate() {
            if unplaced
                .iter()
                .any(|place| place.may_be_of(action, channel))
            {
                continue;
            }
            let mut own: Vec<_> = segments
                .iter()
                .filter(|s| (s.action, s.channel) == (action, channel))
                .collect();
            if own.is_empty() {
                without.push(format!("({}, {channel_name})", action_setup.name));
                continue;
            }
            own.sort_by(|a, b| a.from.total_cmp(&b.from));
            let group = Group {
                label: format!("({}, {channel_name})", action_setup.name),
                joint: &setup.joint,
                faults,
            };
            group.check(&own);
        }
    }
    if !without.is_empty() {
        faults.add(
            "segments",
            &format!("there is none for {}", without.join(", ")),
            "every movement action needs every channel from the lower to the upper limit",
            "calibrate the object, or add an [[observation.segment]] for each",
        );
    }
}

/// Actions that need segments.
fn movements(actions: &[ActionSetup]) -> impl Iterator<Item = (usize, &ActionSetup)> {
    actions
        .iter()
        .enumerate()
        .filter(|(_, action)| !action.stop)
}

struct Group<'a> {
    label: String,
    joint: &'a JointSetup,
    faults: &'a mut Faults,
}

impl Group<'_> {
    fn check(mut self, own: &[&Segment]) {
        let (Some(first), Some(last)) = (own.first(), own.last()) else {
            return;
        };
        self.limit(first, "from", first.from, self.joint.lower, "lower");
        for pair in own.windows(2) {
            self.joined(pair[0], pair[1]);
        }
        self.limit(last, "to", last.to, self.joint.upper, "upper");
    }

    fn limit(&mut self, segment: &Segment, stem: &str, found: f64, wanted: f64, limit: &str) {
        if (found - wanted).abs() <= tolerance(self.joint) {
            return;
        }
        let unit = Unit::of(self.joint.r#type);
        let key = unit.key(stem);
        let beyond = if stem == "from" {
            found < wanted
        } else {
            found > wanted
        };
        let what = if beyond {
            "lies outside the limits"
        } else {
            "leaves a gap to the limit"
        };
        let found = format!("{key} = {} {what}", unit.show(found));
        let rule = format!(
            "segments must reach from limit to limit, and the {limit} one is {}",
            unit.show(wanted)
        );
        self.add(
            segment,
            &found,
            &rule,
            &format!("set {key} = {}", unit.show(wanted)),
        );
    }

    fn joined(&mut self, left: &Segment, right: &Segment) {
        let gap = right.from - left.to;
        if gap.abs() <= tolerance(self.joint) {
            return;
        }
        let unit = Unit::of(self.joint.r#type);
        let key = unit.key("from");
        let what = if gap > 0.0 {
            "leaves a gap after"
        } else {
            "overlaps"
        };
        let end = unit.show(left.to);
        let found = format!(
            "{key} = {} {what} segment[{}], which ends at {end}",
            unit.show(right.from),
            left.index
        );
        self.add(
            right,
            &found,
            "segments must meet",
            &format!("set {key} = {end}, or move that end"),
        );
    }

    fn add(&mut self, segment: &Segment, found: &str, rule: &str, cure: &str) {
        self.faults.add(
            &format!("segment[{}] {}", segment.index, self.label),
            found,
            rule,
            cure,
        );
    }
}
