//! Measured doors: how well an angle can be told from force alone, and how honestly.
//!
//! Each pull of a door is held out in turn; the door is fitted from its other pulls and the engine's
//! own filter follows the held-out pull over a window, from a prior that is even over all angles.
//! The filter's mean against the true angle is the error; its 90 % interval should hold the truth
//! in 90 % of cases.

use std::sync::Arc;

use pubs_core::belief::{BeliefError, BeliefSettings, Filter};
use pubs_core::{Action, Joint, JointKind, Mode, Motion, Task};
use rayon::prelude::*;
use serde::Serialize;

use crate::curve::{self, CurveError, Readings};
use crate::grid::Grid;
use crate::pulls::Door;
use crate::segment::{Channel, Segment, Values};
use crate::segment_model::SegmentModel;
use crate::spread::{Judgement, Outcome, Settings};

/// A window is swept over so many degrees.
pub const WINDOW_DEG: f64 = 10.0;

/// Angles are sorted into cells as wide as the table's own steps, but no finer than this.
const FINEST_DEG: f64 = 0.25;

/// Angle tables do not say how long the lever is: a reading spacing in metres is taken at the radius
/// of a cabinet door, m.
pub const RADIUS_M: f64 = 0.32;

/// A pull must be told apart from at least so many others.
const FEWEST_OTHERS: usize = 2;

/// Why a door could not be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurveyError {
    /// It could not be fitted.
    #[error("door `{door}`: {source}")]
    Curve {
        /// Its name.
        door: String,
        /// Why.
        source: CurveError,
    },
    /// The filter failed on it.
    #[error("door `{door}`: {source}")]
    Belief {
        /// Its name.
        door: String,
        /// Why.
        source: BeliefError,
    },
}

/// What was found of a door.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DoorReport {
    /// Its name.
    pub door: String,
    /// Kind of door, where the table says.
    pub class: Option<String>,
    /// Pulls.
    pub pulls: usize,
    /// Stretches of distinct variance found.
    pub segments: usize,
    /// Largest mean force, N.
    pub peak_n: f64,
    /// Sigma over the stretches: least and greatest, N.
    pub sigma_n: [f64; 2],
    /// For each of the settings asked for; `None` where too few pulls are left to fit from.
    pub judgements: Option<Vec<Judgement>>,
}

/// Fits and judges every door.
///
/// # Errors
/// Where a fit or the filter fails.
pub fn survey(doors: &[Door], settings: &[Settings]) -> Result<Vec<DoorReport>, SurveyError> {
    doors.par_iter().map(|door| judge(door, settings)).collect()
}

/// All windows of all doors taken together, for each of the settings.
pub fn overall(reports: &[DoorReport], settings: &[Settings]) -> Vec<Judgement> {
    (0..settings.len())
        .map(|index| {
            let judged = reports
                .iter()
                .filter_map(|report| report.judgements.as_ref());
            let outcomes = judged.flat_map(|judgements| judgements[index].outcomes.clone());
            Judgement::new(settings[index], outcomes.collect())
        })
        .collect()
}

fn judge(door: &Door, settings: &[Settings]) -> Result<DoorReport, SurveyError> {
    let pulls: Vec<Readings> = door
        .pulls
        .iter()
        .map(|pull| {
            pull.angle_deg
                .iter()
                .copied()
                .zip(pull.force_n.iter().copied())
                .collect()
        })
        .collect();
    let grid = grid_of(&pulls);
    let failed = |source| SurveyError::Curve {
        door: door.name.clone(),
        source,
    };
    let whole = segments(&grid, &pulls).map_err(failed)?;
    let judgements = (pulls.len() > FEWEST_OTHERS)
        .then(|| held_out(door, &grid, &pulls, settings))
        .transpose()?;
    let sigmas = || whole.iter().flat_map(|segment| sigmas_of(&segment.values));
    Ok(DoorReport {
        door: door.name.clone(),
        class: door.class.clone(),
        pulls: pulls.len(),
        segments: whole.len(),
        peak_n: whole
            .iter()
            .flat_map(|segment| means_of(&segment.values))
            .fold(0.0, f64::max),
        sigma_n: [
            sigmas().fold(f64::INFINITY, f64::min),
            sigmas().fold(0.0, f64::max),
        ],
        judgements,
    })
}

fn grid_of(pulls: &[Readings]) -> Grid {
    let mut angles: Vec<f64> = pulls.iter().flatten().map(|&(angle, _)| angle).collect();
    angles.sort_by(f64::total_cmp);
    let mut steps: Vec<f64> = angles
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|&step| step > 0.0)
        .collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(FINEST_DEG);
    let cell = usual.max(FINEST_DEG);
    let lower = angles.first().copied().unwrap_or(0.0) - 0.5 * cell;
    let upper = angles.last().copied().unwrap_or(0.0) + 0.5 * cell;
    Grid::new(lower, upper, ((upper - lower) / cell).round() as usize)
}

fn means_of(values: &Values) -> Vec<f64> {
    match values {
        Values::Force { mean_n, .. } => mean_n.clone(),
        Values::Moves { .. } => Vec::new(),
    }
}

fn sigmas_of(values: &Values) -> Vec<f64> {
    match values {
        Values::Force { sigma_n, .. } => sigma_n.clone(),
        Values::Moves { .. } => Vec::new(),
    }
}

/// f_d of the one action that such tables hold, states in degrees.
fn segments(grid: &Grid, pulls: &[Readings]) -> Result<Vec<Segment>, CurveError> {
    let regions = curve::regions(grid, pulls)?;
    let pieces = curve::pieces(grid, pulls, &regions)?;
    let segment = |piece: curve::Piece| Segment {
        action: OPEN.to_owned(),
        channel: Channel::Along,
        from: piece.from,
        to: piece.to,
        values: Values::Force {
            position: piece.position,
            mean_n: piece.mean_n,
            sigma_n: vec![piece.sigma_n],
        },
        note: None,
    };
    Ok(pieces.into_iter().map(segment).collect())
}

const OPEN: &str = "safe_open";

fn held_out(
    door: &Door,
    grid: &Grid,
    pulls: &[Readings],
    settings: &[Settings],
) -> Result<Vec<Judgement>, SurveyError> {
    let mut outcomes = vec![Vec::new(); settings.len()];
    for (index, pull) in pulls.iter().enumerate() {
        let mut others = pulls.to_vec();
        others.remove(index);
        let segments = segments(grid, &others).map_err(|source| SurveyError::Curve {
            door: door.name.clone(),
            source,
        })?;
        for (settings, outcomes) in settings.iter().zip(&mut outcomes) {
            let found =
                windows(grid, &segments, pull, settings).map_err(|source| SurveyError::Belief {
                    door: door.name.clone(),
                    source,
                })?;
            outcomes.extend(found);
        }
    }
    Ok(settings
        .iter()
        .zip(outcomes)
        .map(|(settings, outcomes)| Judgement::new(*settings, outcomes))
        .collect())
}

/// One outcome for each reading that a whole window follows.
fn windows(
    grid: &Grid,
    segments: &[Segment],
    pull: &Readings,
    settings: &Settings,
) -> Result<Vec<Outcome>, BeliefError> {
    let task = task(grid, settings);
    let model = SegmentModel::new(&[OPEN.to_owned()], &[Channel::Along], segments);
    let mut filter = Filter::new(&task, Arc::new(model));
    let mut outcomes = Vec::new();
    for start in 0..pull.len() {
        let from = pull[start].0;
        let Some(end) = (start..pull.len()).find(|&end| pull[end].0 >= from + WINDOW_DEG) else {
            break;
        };
        filter.reset();
        for step in start + 1..=end {
            let displacement = pull[step].0 - pull[step - 1].0;
            filter.update(0, displacement, &[pull[step].1 as f32])?;
        }
        outcomes.push(Outcome::of(&filter, pull[end].0));
    }
    Ok(outcomes)
}

/// A task whose states are degrees, with one action.
fn task(grid: &Grid, settings: &Settings) -> Task {
    let (lower, upper) = (grid.edge(0), grid.edge(grid.len()));
    let per_metre_deg = (1.0 / RADIUS_M).to_degrees();
    let mut task = crate::spread::bare_task(Joint {
        kind: JointKind::Abstract { integer: false },
        lower,
        upper,
        start: (lower, upper),
    });
    task.actions = vec![Action {
        name: OPEN.to_owned(),
        motion: Motion::Move {
            mode: Mode::Safe,
            displacement: WINDOW_DEG,
            observations: 1,
        },
    }];
    task.belief = BeliefSettings {
        tempering: settings.tempering,
        reading_spacing: settings.reading_spacing_m * per_metre_deg,
        ..task.belief
    };
    task
}
