//! Honest spread: whether a belief's interval holds the truth as often as it says.
//!
//! A filter that takes all readings as independent is over-sure on real objects: neighbouring
//! readings of one pull err together, and the fitted curve errs itself. `[belief] tempering` and
//! `reading_spacing_m` discount them. Here each demonstration is held out in turn, the object is
//! fitted from the others, and the engine's own filter follows the held-out one over windows of a
//! few centimetres from a prior that is even over the range.

use std::collections::BTreeSet;
use std::sync::Arc;

use pubs_core::belief::{BeliefError, BeliefSettings, Filter};
use pubs_core::reward::{Reward, Shape};
use pubs_core::shield::Shield;
use pubs_core::task::{ObservationTable, PolicySettings};
use pubs_core::{Joint, Task};
use rayon::prelude::*;
use serde::Serialize;

use crate::fit::{FitError, action_readings};
use crate::segment::Channel;
use crate::segment_model::SegmentModel;
use crate::traces::{Point, Trace};

/// The share of the belief whose interval is judged.
pub const COVERAGE: f64 = 0.9;

/// A window is swept over this way of the handle, m.
const WINDOW_M: f64 = 0.05;

/// The coverage that is taken as honest.
pub const HONEST: std::ops::RangeInclusive<f64> = 0.85..=0.97;

/// Two settings of `[belief]` that say how much a force reading counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Settings {
    /// Exponent on the likelihood of each counted reading.
    pub tempering: f64,
    /// One reading counts per this much travel, m.
    pub reading_spacing_m: f64,
}

impl Settings {
    /// Every reading counts in full, as the paper has it.
    pub const INDEPENDENT: Self = Self {
        tempering: 1.0,
        reading_spacing_m: 0.0,
    };

    /// The engine's defaults, which an object file that says nothing gets.
    pub const DEFAULT: Self = Self {
        tempering: 0.125,
        reading_spacing_m: 0.005,
    };

    /// Those of a task.
    pub fn of(task: &Task) -> Self {
        Self {
            tempering: task.belief.tempering,
            reading_spacing_m: task.belief.reading_spacing / task.joint.per_metre(),
        }
    }
}

/// How one window ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// |mean of the belief − truth|, in the unit of the states.
    pub error: f64,
    /// Whether the interval held the truth.
    pub covered: bool,
}

impl Outcome {
    /// Judges a belief.
    pub fn of(filter: &Filter, truth: f64) -> Self {
        let (from, to) = filter.interval(COVERAGE);
        Self {
            error: (filter.summary().mean - truth).abs(),
            covered: (from..=to).contains(&truth),
        }
    }
}

/// All windows under one pair of settings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judgement {
    /// What was tried.
    pub settings: Settings,
    /// Windows.
    pub windows: usize,
    /// Median error, in the unit of the states; NaN without any window.
    pub median_error: f64,
    /// Share of the windows whose interval held the truth; NaN without any window.
    pub coverage: f64,
    /// Each window.
    #[serde(skip)]
    pub outcomes: Vec<Outcome>,
}

impl Judgement {
    /// Sums up windows.
    pub fn new(settings: Settings, outcomes: Vec<Outcome>) -> Self {
        let mut errors: Vec<f64> = outcomes.iter().map(|outcome| outcome.error).collect();
        errors.sort_by(f64::total_cmp);
        let covered = outcomes.iter().filter(|outcome| outcome.covered).count();
        Self {
            settings,
            windows: outcomes.len(),
            median_error: errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN),
            coverage: covered as f64 / outcomes.len() as f64,
            outcomes,
        }
    }

    /// Whether the interval is neither too narrow nor too wide.
    pub fn is_honest(&self) -> bool {
        HONEST.contains(&self.coverage)
    }
}

/// Why a spread could not be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpreadError {
    /// A fit without one of the pulls failed.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The filter failed.
    #[error(transparent)]
    Belief(#[from] BeliefError),
}

/// Leave-one-pull-out judgement of the readings of an object, for each of the settings.
///
/// # Errors
/// Where a fit or the filter fails.
pub fn judge(
    task: &Task,
    traces: &[Trace],
    settings: &[Settings],
) -> Result<Vec<Judgement>, SpreadError> {
    let pulls: BTreeSet<u32> = traces.iter().map(|trace| trace.pull).collect();
    let whole = action_readings(task, traces)?;
    let regions: Vec<_> = whole
        .par_iter()
        .map(crate::fit::ActionReadings::regions)
        .collect::<Result<_, _>>()?;
    let jobs: Vec<u32> = pulls.into_iter().collect();
    let found: Vec<Vec<Vec<Outcome>>> = jobs
        .par_iter()
        .map(|&pull| {
            let others: Vec<Trace> = traces
                .iter()
                .filter(|trace| trace.pull != pull)
                .cloned()
                .collect();
            let readings = match action_readings(task, &others) {
                // An action that was demonstrated once cannot be held out.
                Err(FitError::NoReadings(_)) => return Ok(vec![Vec::new(); settings.len()]),
                readings => readings?,
            };
            let mut segments = Vec::new();
            for (action, regions) in readings.iter().zip(&regions) {
                segments.extend(action.segments(regions)?);
            }
            let own: Vec<&Trace> = traces
                .iter()
                .filter(|trace| trace.pull == pull && !trace.folded)
                .collect();
            settings
                .iter()
                .map(|settings| follow(task, &segments, &own, settings).map_err(SpreadError::from))
                .collect::<Result<_, _>>()
        })
        .collect::<Result<_, SpreadError>>()?;
    Ok(settings
        .iter()
        .enumerate()
        .map(|(index, settings)| {
            let outcomes = found
                .iter()
                .flat_map(|pull| pull[index].iter().copied())
                .collect();
            Judgement::new(*settings, outcomes)
        })
        .collect())
}

fn follow(
    task: &Task,
    segments: &[crate::Segment],
    traces: &[&Trace],
    settings: &Settings,
) -> Result<Vec<Outcome>, BeliefError> {
    let mut task = task.clone();
    task.belief.tempering = settings.tempering;
    task.belief.reading_spacing = settings.reading_spacing_m * task.joint.per_metre();
    let names: Vec<String> = task
        .actions
        .iter()
        .map(|action| action.name.clone())
        .collect();
    let channels = Channel::ALL;
    let model = SegmentModel::new(&names, &channels, segments);
    let mut filter = Filter::new(&task, Arc::new(model));
    let lag = task.control.map_or(1, |control| {
        (control.rate_hz / task.belief.rate_hz).round().max(1.0) as usize
    });
    let window = WINDOW_M * task.joint.per_metre();
    let mut outcomes = Vec::new();
    for trace in traces {
        // Updates as the filter loop makes them.
        let updates: Vec<&Point> = trace.points.iter().step_by(lag).collect();
        let mut start = 0;
        while let Some(end) = end_of_window(&updates, start, window) {
            filter.reset();
            for point in &updates[start..=end] {
                weigh(&mut filter, &task, trace.action, point)?;
            }
            outcomes.push(Outcome::of(&filter, updates[end].state));
            start += (end - start).div_ceil(2).max(1);
        }
    }
    Ok(outcomes)
}

fn end_of_window(updates: &[&Point], start: usize, window: f64) -> Option<usize> {
    let from = updates.get(start)?.before;
    (start..updates.len()).find(|&end| (updates[end].state - from).abs() >= window)
}

fn weigh(
    filter: &mut Filter,
    task: &Task,
    action: usize,
    point: &Point,
) -> Result<(), BeliefError> {
    let displacement = point.state - point.before;
    if !point.settled {
        filter.follow(displacement);
        return Ok(());
    }
    let threshold_m = task
        .joint
        .geometry()
        .map_or(0.0, |geometry| geometry.motion_threshold_m);
    let moved = displacement.abs() / task.joint.per_metre() > threshold_m;
    let [f_d, f_z, f_n] = point.forces_n.map(|force| force as f32);
    let observation = [f_d, f_z, f_n, if moved { 1.0 } else { 0.0 }];
    filter.update(action, displacement, &observation)?;
    Ok(())
}

/// A task with nothing but a joint and the engine's number of particles.
pub(crate) fn bare_task(joint: Joint) -> Task {
    Task {
        name: String::new(),
        sensor: None,
        joint,
        default_goal: None,
        actions: Vec::new(),
        stop: 0,
        control: None,
        belief: BeliefSettings {
            particles: 300,
            rate_hz: 1.0,
            tempering: 1.0,
            reading_spacing: 0.0,
            force_bias: None,
        },
        policy: PolicySettings {
            rate_hz: 1.0,
            layers: Vec::new(),
            shield: Shield {
                mass: 0.0,
                flattening: 1.0,
            },
        },
        reward: Reward {
            shape: Shape::Proximity,
            goal_tolerance: 1.0,
            goal: 0.0,
            failed_stop: 0.0,
            safety_violation: 0.0,
            time: 0.0,
            discount: 1.0,
        },
        driver: None,
        observation: ObservationTable {
            model: String::new(),
            bias_sd_n: 0.0,
            correlation: 0.0,
            table: serde_json::Value::Null,
        },
    }
}
