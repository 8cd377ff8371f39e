//! Starts and goals of episodes.

use pubs_core::Joint;
use rand::{Rng, RngExt};

/// Share of episodes for each of the two ends of the range, where every goal may come: the ends
/// are the hardest goals, and a uniform draw would never give them.
const GOAL_AT_END: f64 = 0.1;

/// A state of the prior, each as likely as any other.
pub fn draw_start(joint: &Joint, rng: &mut impl Rng) -> f64 {
    let (from, to) = joint.start;
    uniform(from, to, joint.is_integer(), rng)
}

/// A goal: one in ten times the closed limit, one in ten the open one, else anywhere.
pub fn draw_goal(joint: &Joint, rng: &mut impl Rng) -> f64 {
    match rng.random::<f64>() {
        share if share < GOAL_AT_END => joint.lower,
        share if share < 2.0 * GOAL_AT_END => joint.upper,
        _ => uniform(joint.lower, joint.upper, joint.is_integer(), rng),
    }
}

fn uniform(from: f64, to: f64, integer: bool, rng: &mut impl Rng) -> f64 {
    let share = rng.random::<f64>();
    if integer {
        // Each whole number owns the half-unit on either side of it.
        (from - 0.5 + share * (to - from + 1.0))
            .round()
            .clamp(from, to)
    } else {
        from + share * (to - from)
    }
}
