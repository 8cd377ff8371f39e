//! Whether a stored model still holds for a new recording, channel by channel.
//!
//! With residual e = value − μ(s) and weight w = 1/σ(s)², each demonstration gives its own estimate
//! of four ways in which the world may have left the model:
//!
//! | what | estimate of one demonstration |
//! |---|---|
//! | offset | Σ w e / Σ w |
//! | gain | Σ w μ v / Σ w μ² |
//! | shift | the δ with the likeliest values under μ(s − δ), σ(s − δ) |
//! | noise | mean of (e/σ)²; share of \|e\| > 2 σ |
//!
//! Readings of one demonstration are not independent, so their number says nothing of how well an
//! estimate is known: its standard error comes from the spread between demonstrations
//! (`spread.rs`). A model fails where an estimate is off beyond doubt and by an amount that
//! matters to a filter.

mod fit;
mod force;
mod moves;
mod region;
mod shift;
mod spread;
mod verdict;

use pubs_core::Task;
use serde::Serialize;

use crate::calibration::samples;
use crate::object_text::StateUnit;
use crate::stored::Stored;
use crate::traces::Trace;
use crate::{Channel, Segment};
use spread::Demonstrations;

/// Fewer say nothing.
const FEWEST_SAMPLES: usize = 30;

/// One reading of a new recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Joint state, rad or m.
    pub state: f64,
    /// Force, N; for m_p 0 or 1.
    pub value: f64,
    /// Which demonstration it belongs to.
    pub demonstration: u32,
}

/// A number and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error, from the spread between demonstrations.
    pub sd: f64,
}

/// What explains best that a model no longer holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// All forces are higher or lower by one amount.
    Offset,
    /// All forces are larger or smaller by one factor.
    Gain,
    /// The curve lies elsewhere.
    Shift,
    /// The curve differs in one region.
    Region,
    /// Forces scatter more.
    Noise,
    /// The handle moves more or less often.
    Moves,
}

/// How a new recording and the stored model of one action and channel agree.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Drift {
    /// Name of the action.
    pub action: String,
    /// The component.
    pub channel: Channel,
    /// Readings compared.
    pub samples: usize,
    /// Demonstrations they come from.
    pub demonstrations: usize,
    /// Mean residual, N; for m_p the share of moving readings less the probability.
    pub offset_n: Option<Estimate>,
    /// How far the stored curve must move to fit best, rad or m, positive towards open; None
    /// where it is too flat to tell.
    pub shift: Option<Estimate>,
    /// Factor on the stored mean that fits best; None where that is too near to 0 to tell.
    pub gain: Option<Estimate>,
    /// Root mean square residual over the stored sigma; 1 expected.
    pub sigma_ratio: Option<f64>,
    /// Share of readings beyond ±2 sigma; 0.046 expected. None for m_p.
    pub outside: Option<f64>,
    /// None where there is too little to tell.
    pub holds: Option<bool>,
    /// Why it does not hold.
    pub cause: Option<Cause>,
    /// All of this in a sentence, with what to do.
    pub verdict: String,
}

/// Compares all that was felt, action by action and channel by channel, with [`drift`].
pub fn drifts(task: &Task, stored: &[Segment], traces: &[Trace]) -> Vec<Drift> {
    let unit = StateUnit::of(&task.joint);
    let sample = |(state, value, demonstration)| Sample {
        state,
        value,
        demonstration,
    };
    task.movements()
        .flat_map(|(index, action)| {
            Channel::ALL.map(|channel| {
                let readings = samples(task, traces, index, channel).into_iter();
                let readings: Vec<Sample> = readings.map(sample).collect();
                drift(stored, &action.name, channel, &readings, unit)
            })
        })
        .collect()
}

/// Compares the readings of one action and channel with what `stored` says of it. Readings that
/// are not finite are passed over. `unit` is how the verdict gives states.
///
/// A model holds unless, beyond a doubt of about one in a thousand,
/// - the offset is above one stored sigma,
/// - the gain moves a tenth of the readings by more than one sigma,
/// - the shift is more than a hundredth of the range and moves a tenth of the readings by more than
///   one sigma,
/// - the mean in a region is off by more than 1.5 sigma,
/// - the rms residual is above 1.5 sigma, or more than 20 % of readings are beyond 2 sigma,
/// - or the handle moves in a region more or less often by more than 0.2 (m_p).
///
/// Where offset or noise are that large, but so few demonstrations could show it by chance, there
/// is no verdict.
pub fn drift(
    stored: &[Segment],
    action: &str,
    channel: Channel,
    samples: &[Sample],
    unit: StateUnit,
) -> Drift {
    let finite = |sample: &&Sample| sample.state.is_finite() && sample.value.is_finite();
    let samples: Vec<Sample> = samples.iter().filter(finite).copied().collect();
    let demonstrations = Demonstrations::of(&samples);
    let mut drift = Drift {
        action: action.to_owned(),
        channel,
        samples: samples.len(),
        demonstrations: demonstrations.count(),
        offset_n: None,
        shift: None,
        gain: None,
        sigma_ratio: None,
        outside: None,
        holds: None,
        cause: None,
        verdict: String::new(),
    };
    let Some(stored) = Stored::of(stored, action, channel) else {
        drift.verdict = "the object file holds no segment of it".to_owned();
        return drift;
    };
    if samples.len() < FEWEST_SAMPLES {
        drift.verdict = format!("too few samples to tell ({})", samples.len());
        return drift;
    }
    let outcome = if channel == Channel::Moves {
        moves::compare(&stored, &demonstrations, &mut drift)
    } else {
        force::compare(&stored, &demonstrations, &mut drift)
    };
    drift.verdict = verdict::sentence(&drift, &outcome, unit);
    (drift.holds, drift.cause) = match outcome {
        Outcome::Holds => (Some(true), None),
        Outcome::Unclear => (None, None),
        Outcome::Fails(finding) => (Some(false), Some(finding.cause)),
    };
    drift
}

/// What a comparison comes to.
enum Outcome {
    Holds,
    /// Off by an amount that matters, which may be chance with so few demonstrations.
    Unclear,
    Fails(Finding),
}

/// Why a model fails, and where.
struct Finding {
    cause: Cause,
    /// For [`Cause::Region`] and [`Cause::Moves`].
    region: Option<region::Region>,
    /// Root mean square residual over sigma once the cause is allowed for.
    left: f64,
}
