//! How far from the goal trials stopped, counted.

use pubs_core::Task;
use serde::{Deserialize, Serialize};

/// Bins, the last of which holds all that is farther.
const BINS: usize = 26;

/// Bins of the goal region, where there is one.
const WITHIN: f64 = 10.0;

/// Where goals have no region.
const SHARE_OF_RANGE: f64 = 0.002;

/// Trials by the size of |s − s_g|.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoalErrors {
    /// Half the width of the goal's region (rad, m or plain); 0 where only the goal itself counts.
    pub tolerance: f64,
    /// Width of a bin (rad, m or plain).
    pub bin: f64,
    /// Trials in each bin from 0 on; the last holds all that is farther as well.
    pub counts: Vec<u64>,
}

impl GoalErrors {
    /// None yet, for the goals of a task.
    pub fn of(task: &Task) -> Self {
        let tolerance = task.reward.goal_tolerance;
        let bin = if tolerance > 0.0 {
            tolerance / WITHIN
        } else {
            SHARE_OF_RANGE * task.joint.range()
        };
        Self::new(tolerance, bin)
    }

    /// None yet.
    pub fn new(tolerance: f64, bin: f64) -> Self {
        Self {
            tolerance,
            bin,
            counts: vec![0; BINS],
        }
    }

    /// Whether there is something to draw; of what another program wrote nobody knows.
    pub(crate) fn is_drawable(&self) -> bool {
        self.counts.len() > 1 && self.bin > 0.0 && self.bin.is_finite() && self.tolerance >= 0.0
    }

    /// Counts one.
    pub fn add(&mut self, goal_error: f64) {
        // The quotient saturates where it is too large, and NaN counts as 0; neither stops.
        let bin = (goal_error / self.bin) as usize;
        self.counts[bin.min(BINS - 1)] += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_into_their_bins() {
        let mut errors = GoalErrors::new(5.0, 0.5);
        for error in [0.0, 0.4, 0.6, 12.4, 12.6, 1e9] {
            errors.add(error);
        }
        let counts = &errors.counts;
        assert_eq!((counts[0], counts[1], counts[24], counts[25]), (2, 1, 1, 2));
        assert_eq!(counts.iter().sum::<u64>(), 6);
    }
}
