//! One object, calibrated: recordings in, segments out, with what is to be said about them.

use std::collections::BTreeMap;

use pubs_core::Task;
use pubs_run::recording::Recording;
use rayon::prelude::*;

use crate::fit::{self, FitError};
use crate::segment::Segment;
use crate::spread::{self, HONEST, Judgement, Settings, SpreadError};
use crate::traces::{Limits, Trace, TraceError, traces};

/// A measured range that differs from the limits by more than this share is refused.
const RANGE_SHARE: f64 = 0.05;

/// Touches of one limit that differ by more than this way of the handle, m: the grasp slips.
const SCATTER_M: f64 = 0.003;

/// Exponents that a proposal may name.
const TEMPERINGS: [f64; 6] = [1.0, 0.7, 0.5, 0.35, 0.25, 0.125];

/// Spacings that a proposal may name, m.
const SPACINGS_M: [f64; 3] = [0.0, 0.005, 0.02];

/// A proposal comes well inside what is honest, where something does.
const WELL_INSIDE: std::ops::RangeInclusive<f64> = 0.87..=0.95;

/// Why an object could not be calibrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// A recording gives no states.
    #[error("{file}: {source}")]
    Trace {
        /// The recording.
        file: String,
        /// Why.
        source: TraceError,
    },
    /// The limits are not those of the object file.
    #[error(
        "{file}: between its stops the object moves {measured}, but the limits of the object file are {limits} apart; \
         correct the limits (or the radius), or record from stop to stop"
    )]
    Range {
        /// The recording.
        file: String,
        /// For people.
        measured: String,
        /// For people.
        limits: String,
    },
    /// The readings could not be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The spread could not be judged.
    #[error(transparent)]
    Spread(#[from] SpreadError),
}

/// A calibrated object.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// For the object file, in the order of actions, channels and states.
    pub segments: Vec<Segment>,
    /// What the readings were, for pictures and comparisons.
    pub traces: Vec<Trace>,
    /// What each recording says of the limits.
    pub limits: Vec<Limits>,
    /// Demonstrations of each movement action.
    pub demonstrations: BTreeMap<String, usize>,
    /// Leave-one-pull-out with the stored settings of `[belief]`...
    pub stored: Judgement,
    /// ...and with every reading counted in full.
    pub independent: Judgement,
    /// Settings whose interval is honest, where that of the stored ones is not.
    pub proposal: Option<Judgement>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// The readings of several recordings of one object, pulls kept apart.
///
/// # Errors
/// Where a limit is never touched, or the limits are not the object's.
pub fn all_traces(
    task: &Task,
    recordings: &[(String, Recording)],
) -> Result<(Vec<Trace>, Vec<Limits>), CalibrationError> {
    let (mut all, mut limits) = (Vec::new(), Vec::new());
    let mut first_pull = 0;
    for (file, recording) in recordings {
        let (traces, found) =
            traces(task, recording, first_pull).map_err(|source| CalibrationError::Trace {
                file: file.clone(),
                source,
            })?;
        check_range(task, file, &found)?;
        let last = traces.iter().map(|trace| trace.pull).max();
        first_pull = last.unwrap_or(first_pull);
        all.extend(traces);
        limits.push(found);
    }
    Ok((all, limits))
}

fn check_range(task: &Task, file: &str, limits: &Limits) -> Result<(), CalibrationError> {
    let joint = &task.joint;
    match limits.range {
        Some(range) if (range - joint.range()).abs() > RANGE_SHARE * joint.range() => {
            Err(CalibrationError::Range {
                file: file.to_owned(),
                measured: joint.display(range),
                limits: joint.display(joint.range()),
            })
        }
        _ => Ok(()),
    }
}

/// Fits an object from its recordings and judges the fit.
///
/// # Errors
/// Where the recordings do not give a whole model.
pub fn calibrate(
    task: &Task,
    recordings: &[(String, Recording)],
) -> Result<Calibration, CalibrationError> {
    let (traces, limits) = all_traces(task, recordings)?;
    let segments = fit::fit(task, &traces)?;
    let settings = [Settings::of(task), Settings::INDEPENDENT];
    let judged = spread::judge(task, &traces, &settings)?;
    let [stored, independent] = <[Judgement; 2]>::try_from(judged)
        .unwrap_or_else(|_| unreachable!("one judgement for each of the settings"));
    let proposal = if stored.windows == 0 || stored.is_honest() {
        None
    } else {
        propose(task, &traces)?
    };
    Ok(Calibration {
        warnings: warnings(task, &limits, &stored),
        demonstrations: demonstrations(task, &traces),
        segments,
        traces,
        limits,
        stored,
        independent,
        proposal,
    })
}

/// The honest settings with the least error.
fn propose(task: &Task, traces: &[Trace]) -> Result<Option<Judgement>, SpreadError> {
    let settings: Vec<Settings> = SPACINGS_M
        .iter()
        .flat_map(|&reading_spacing_m| {
            TEMPERINGS.map(|tempering| Settings {
                tempering,
                reading_spacing_m,
            })
        })
        .collect();
    let judged = spread::judge(task, traces, &settings)?;
    let least = |judged: Vec<Judgement>| {
        let by_error = |a: &Judgement, b: &Judgement| a.median_error.total_cmp(&b.median_error);
        judged.into_iter().min_by(by_error)
    };
    let (inside, rest): (Vec<_>, Vec<_>) = judged
        .into_iter()
        .filter(Judgement::is_honest)
        .partition(|judgement| WELL_INSIDE.contains(&judgement.coverage));
    Ok(least(inside).or_else(|| least(rest)))
}

fn demonstrations(task: &Task, traces: &[Trace]) -> BTreeMap<String, usize> {
    task.movements()
        .map(|(index, action)| {
            let mut pulls: Vec<u32> = traces
                .iter()
                .filter(|trace| trace.action == index)
                .map(|trace| trace.pull)
                .collect();
            pulls.sort_unstable();
            pulls.dedup();
            (action.name.clone(), pulls.len())
        })
        .collect()
}

fn warnings(task: &Task, limits: &[Limits], stored: &Judgement) -> Vec<String> {
    let mut warnings = Vec::new();
    let scatter = limits.iter().map(|found| found.scatter).fold(0.0, f64::max);
    if scatter > SCATTER_M * task.joint.per_metre() {
        warnings.push(format!(
            "touches of one limit differ by {}: the grasp slips, or the object shifts as a whole",
            task.joint.display(scatter)
        ));
    }
    if stored.windows == 0 {
        warnings.push(
            "each action was demonstrated once, so none can be held out: nobody knows how honest the belief is; record five"
                .to_owned(),
        );
    } else if !stored.is_honest() {
        let side = if stored.coverage < *HONEST.start() {
            "over-sure: it holds the truth too rarely"
        } else {
            "over-cautious: it is wider than it need be"
        };
        warnings.push(format!(
            "with tempering = {} and reading_spacing_m = {} the belief is {side} (its 90 % interval held the truth in {:.1} % of {} windows)",
            stored.settings.tempering,
            stored.settings.reading_spacing_m,
            100.0 * stored.coverage,
            stored.windows,
        ));
    }
    warnings
}

/// Points of an action and channel, for pictures and comparisons: `(state, value, pull)`, m_p as 0
/// or 1; the free account alone, as a filter would weigh them.
pub fn samples(
    task: &Task,
    traces: &[Trace],
    action: usize,
    channel: crate::Channel,
) -> Vec<(f64, f64, u32)> {
    let own = traces
        .par_iter()
        .filter(|trace| trace.action == action && !trace.folded);
    own.flat_map_iter(|trace| {
        let settled = trace.points.iter().filter(|point| point.settled);
        settled.map(move |point| {
            let (state, value) = fit::value(task, action, point, channel);
            (state, value, trace.pull)
        })
    })
    .collect()
}
