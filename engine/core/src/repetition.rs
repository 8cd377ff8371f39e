//! An action that changed nothing is not taken again before something has changed.
//!
//! A policy that reads only the belief summary chooses the same action as long as the summary
//! stays: where the handle is held and the belief has nothing left to learn from it, at a limit
//! most of all, it would press for ever. Training does not show it, since there actions are drawn.
//! So the action is masked until another one moves the handle or changes the belief, in training,
//! in trials and on the arm alike.

use crate::belief::Summary;
use crate::joint::Joint;

/// A mean that moved by less than this share of the range has stayed.
const MEAN_SHARE: f64 = 1e-3;

/// An entropy that moved by less has stayed.
const ENTROPY: f64 = 2e-3;

/// What the latest actions did to handle and belief.
#[derive(Debug, Clone, Copy, Default)]
pub struct Repetition {
    taken: Option<Taken>,
    /// Bit i: action i changed nothing, and nothing has changed since.
    futile: u64,
}

/// Where handle and belief are between two actions.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// The handle, from wherever it is counted (rad, m or plain).
    pub handle: f64,
    /// The belief.
    pub summary: Summary,
}

/// An action and where it began.
#[derive(Debug, Clone, Copy)]
struct Taken {
    action: usize,
    from: Place,
}

impl Repetition {
    /// The action of this index begins.
    pub fn begin(&mut self, action: usize, from: Place) {
        self.taken = Some(Taken { action, from });
    }

    /// The latest action, if there was one, has led here.
    pub fn end(&mut self, joint: &Joint, here: Place) {
        let Some(Taken { action, from }) = self.taken.take() else {
            return;
        };
        let threshold = joint
            .geometry()
            .map_or(0.0, |geometry| geometry.motion_threshold_m)
            * joint.per_metre();
        let held = (here.handle - from.handle).abs() <= threshold;
        let learnt = (here.summary.mean - from.summary.mean).abs() >= MEAN_SHARE * joint.range()
            || (here.summary.entropy - from.summary.entropy).abs() >= ENTROPY;
        self.futile = if held && !learnt {
            self.futile | bit(action)
        } else {
            0
        };
    }

    /// Whether this rule lets the action be chosen.
    pub fn allows(&self, action: usize) -> bool {
        self.futile & bit(action) == 0
    }
}

/// The bit of an action; none from the 65th on, which this rule lets pass.
fn bit(action: usize) -> u64 {
    u32::try_from(action)
        .ok()
        .and_then(|action| 1_u64.checked_shl(action))
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::joint::{Geometry, JointKind};

    const AT_REST: Place = Place {
        handle: 0.0,
        summary: Summary {
            mean: 0.0,
            entropy: 0.35,
        },
    };

    /// A hinge of 0.5 m over 2 rad, where 0.5 mm at the handle are 0.001 rad.
    fn hinge() -> Joint {
        Joint {
            kind: JointKind::Revolute {
                radius_m: 0.5,
                geometry: Geometry {
                    opening_direction: Vector3::x(),
                    up_direction: Vector3::z(),
                    motion_threshold_m: 0.0005,
                },
                hinge_direction: Vector3::y(),
            },
            lower: 0.0,
            upper: 2.0,
            start: (0.0, 2.0),
        }
    }

    #[test]
    fn only_an_action_that_moved_nothing_and_taught_nothing_is_masked() {
        let before = (1.0, 0.4);
        let place = |handle, (mean, entropy)| Place {
            handle,
            summary: Summary { mean, entropy },
        };
        let cases = [
            (0.0, before, false, "held, and the belief as before"),
            (-0.0009, before, false, "held within the threshold"),
            (0.0011, before, true, "the handle moved"),
            (0.0, (1.0021, 0.4), true, "the mean moved by 0.002 rad"),
            (0.0, (1.0019, 0.4), false, "the mean moved by less"),
            (0.0, (1.0, 0.397), true, "the entropy fell"),
        ];
        for (displacement, after, allowed, name) in cases {
            let mut repetition = Repetition::default();
            repetition.begin(2, place(0.3, before));
            repetition.end(&hinge(), place(0.3 + displacement, after));
            assert_eq!(repetition.allows(2), allowed, "{name}");
            assert!(repetition.allows(1), "{name}: another action is masked");
        }
    }

    #[test]
    fn the_65th_action_masks_nothing() {
        let mut repetition = Repetition::default();
        repetition.begin(64, AT_REST);
        repetition.end(&hinge(), AT_REST);
        assert!(repetition.allows(64) && repetition.allows(0));
    }

    #[test]
    fn the_mask_lasts_until_something_changes() {
        let mut repetition = Repetition::default();
        let steps = [
            (2, 0.0, [true, true, false, true]),
            (3, 0.0, [true, true, false, false]),
            (1, 0.5, [true, true, true, true]),
            (2, 0.0, [true, true, false, true]),
        ];
        for (step, (action, displacement, expected)) in steps.into_iter().enumerate() {
            repetition.begin(action, AT_REST);
            let handle = AT_REST.handle + displacement;
            repetition.end(&hinge(), Place { handle, ..AT_REST });
            let allowed = [0, 1, 2, 3].map(|action| repetition.allows(action));
            assert_eq!(allowed, expected, "step {step}, action {action}");
        }
    }
}
