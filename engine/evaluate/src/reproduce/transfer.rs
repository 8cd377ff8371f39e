//! Trials on the virtual arm, Table IV.

use super::cell::{ArmTrial, CellResult, Outcome, Unit};
use super::paper::Estimate;
use super::results::Results;
use crate::statistics::{Sample, wilson_95};

/// A row of Table IV.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferRow {
    /// How many trials.
    pub trials: u64,
    /// How many ended as each outcome.
    pub outcomes: Outcomes,
    /// Share that reached the goal region.
    pub success_rate: f64,
    /// Wilson's 95 % interval of it.
    pub success_interval: [f64; 2],
    /// |s − s_g| of those, in the table's unit; `None` where none did.
    pub goal_error: Option<Estimate>,
    /// Time of those divided by the distance from start to goal, s per unit; `None` likewise.
    pub time_per_unit: Option<Estimate>,
    /// In all trials.
    pub safety_violations: u64,
}

/// How many trials ended how.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outcomes {
    /// Stopped in the goal region.
    pub reached: u64,
    /// Stopped outside it.
    pub missed: u64,
    /// Reached the cap.
    pub timed_out: u64,
    /// Stopped for safety.
    pub safety_stop: u64,
    /// Something failed.
    pub fault: u64,
}

/// The table's unit of an object's joint, and how many of it are in one of SI.
pub fn unit(object: &str) -> (&'static str, f64) {
    if object.starts_with("drawer") {
        ("cm", 100.0)
    } else {
        ("deg", 1f64.to_degrees())
    }
}

/// The row of an object; `None` where its cell has not been run or holds no trial.
pub fn transfer(results: &Results, object: &str, drift: bool) -> Option<TransferRow> {
    let unit = Unit::Arm {
        task: object.to_owned(),
        // Not part of the id.
        trials: 0,
        drift,
    };
    match &results.cell(&unit)?.result {
        CellResult::Arm { trials, .. } if !trials.is_empty() => Some(summed(trials, object)),
        _ => None,
    }
}

fn summed(trials: &[ArmTrial], object: &str) -> TransferRow {
    let (_, per_si) = unit(object);
    let mut outcomes = Outcomes::default();
    let (mut error, mut time) = (Sample::default(), Sample::default());
    for trial in trials {
        *outcomes.of(trial.outcome) += 1;
        if trial.outcome != Outcome::Reached {
            continue;
        }
        if let Some(found) = trial.goal_error {
            error.add(found * per_si);
        }
        let distance = (trial.goal - trial.start).abs() * per_si;
        if distance > 0.0 {
            time.add(trial.time_s / distance);
        }
    }
    let count = trials.len() as u64;
    TransferRow {
        trials: count,
        outcomes,
        success_rate: outcomes.reached as f64 / count as f64,
        success_interval: wilson_95(outcomes.reached, count),
        goal_error: estimate(&error),
        time_per_unit: estimate(&time),
        safety_violations: trials.iter().map(|trial| trial.safety_violations).sum(),
    }
}

/// Of a single value the error is not known.
fn estimate(sample: &Sample) -> Option<Estimate> {
    Some(Estimate {
        mean: sample.mean()?,
        se: sample.standard_error().unwrap_or(f64::NAN),
    })
}

impl Outcomes {
    fn of(&mut self, outcome: Outcome) -> &mut u64 {
        match outcome {
            Outcome::Reached => &mut self.reached,
            Outcome::Missed => &mut self.missed,
            Outcome::TimedOut => &mut self.timed_out,
            Outcome::SafetyStop => &mut self.safety_stop,
            Outcome::Fault => &mut self.fault,
        }
    }
}
