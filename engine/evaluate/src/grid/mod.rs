//! An object as a discrete POMDP, for the offline solvers of §IV-C.
//!
//! The joint is cut into bins (on whole states, the states themselves), readings into bins of their
//! own, and one policy step becomes one transition with one observation: that of its last part.
//! A terminal state follows a stop and a safety violation. [`Grid::observe`] is what a policy of
//! alpha vectors needs to follow trials of the object itself.

mod bins;
mod groups;
mod observations;
mod origin;
mod transitions;

pub use bins::Bins;
pub use origin::GridOrigin;

use std::fmt;

use pubs_core::belief::{Model, ModelError};
use pubs_core::reward::violates_safety;
use pubs_core::{Action, Task};
use pubs_plugin::{Channel, ChannelKind};
use pubs_solve::{Pomdp, PomdpError, PomdpParts, Rows};
use serde::{Deserialize, Serialize};

use groups::Groups;
use observations::{Observer, channel_bins};
use transitions::moved;

/// How fine a grid is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct GridOptions {
    /// States along the joint, both limits among them; on whole states there is one for each.
    pub bins: usize,
    /// Bins for each channel of forces.
    pub observation_bins: usize,
}

/// An object on a grid.
#[derive(Debug, Clone)]
pub struct Grid {
    /// The POMDP; its last state is the terminal one.
    pub pomdp: Pomdp,
    /// How fine it is.
    pub options: GridOptions,
    bins: Vec<Bins>,
    groups: Groups,
}

/// Why an object does not go on a grid.
#[derive(Debug, thiserror::Error)]
pub enum GridError {
    /// Too few bins.
    #[error("--bins {0} has no room for both limits of the joint; give 2 or more")]
    Bins(usize),
    /// Nothing would be observed.
    #[error("--observation-bins 0 leaves nothing to observe; give 1 or more (2 to tell anything)")]
    NoObservation,
    /// Whole states have no other grid.
    #[error(
        "the joint has {states} whole states, so there are as many bins, not {asked}; leave out --bins"
    )]
    WholeStates {
        /// How many there are.
        states: usize,
        /// What was asked for.
        asked: usize,
    },
    /// More observations than a solver can serve.
    #[error(
        "{bins} bins for each channel make {count} observations, and a solver serves at most {MOST_OBSERVATIONS}; ask for fewer with --observation-bins"
    )]
    Observations {
        /// Bins of each channel.
        bins: usize,
        /// Their combinations.
        count: usize,
    },
    /// The model has no moments.
    #[error("the observation model gives no moments, so its readings cannot be put into bins")]
    NoMoments,
    /// The model could not answer.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A fault of the engine.
    #[error(transparent)]
    Pomdp(#[from] PomdpError),
}

/// Combinations of readings beyond which no solver comes to an end.
const MOST_OBSERVATIONS: usize = 20_000;
/// Bins of a joint that is not of whole states, where nothing is asked for.
const BINS: usize = 101;
/// Bins of each of an arm's forces, where nothing is asked for.
const FORCE_BINS: usize = 5;

impl GridOptions {
    /// What suits an object: whole states as they are, readings of a benchmark as fine as its
    /// states or as its sharpest sigma, and forces of an arm coarsely, since their bins multiply.
    ///
    /// # Errors
    /// Where the model cannot say what its readings are like, or the bins asked for do not fit.
    pub fn of(
        task: &Task,
        model: &dyn Model,
        bins: Option<usize>,
        observation_bins: Option<usize>,
    ) -> Result<Self, GridError> {
        let bins = state_bins(task, bins)?;
        let observation_bins = match observation_bins {
            Some(0) => return Err(GridError::NoObservation),
            Some(asked) => asked,
            None if task.control.is_some() => FORCE_BINS,
            None => Observer::new(task, model).finest()?.min(bins.max(2)),
        };
        Ok(Self {
            bins,
            observation_bins,
        })
    }
}

fn state_bins(task: &Task, asked: Option<usize>) -> Result<usize, GridError> {
    if task.joint.is_integer() {
        let states = task.joint.range().round() as usize + 1;
        return match asked {
            Some(asked) if asked != states => Err(GridError::WholeStates { states, asked }),
            _ => Ok(states),
        };
    }
    match asked.unwrap_or(BINS) {
        bins if bins < 2 => Err(GridError::Bins(bins)),
        bins => Ok(bins),
    }
}

impl Grid {
    /// Puts a task with this goal (rad, m or plain) on a grid.
    ///
    /// # Errors
    /// [`GridError`].
    pub fn new(
        task: &Task,
        model: &dyn Model,
        goal: f64,
        options: GridOptions,
    ) -> Result<Self, GridError> {
        let states: Vec<f64> = (0..options.bins)
            .map(|index| {
                task.joint
                    .at_fraction(index as f64 / (options.bins - 1) as f64)
            })
            .collect();
        let mut observer = Observer::new(task, model);
        let bins = channel_bins(&mut observer, model.channels(), options.observation_bins)?;
        let count = checked_count(&bins, options.observation_bins)?;
        let terminal = states.len();
        let (mut transitions, mut observation_rows) = (Vec::new(), Vec::new());
        let mut seen_after = Vec::new();
        let mut rewards = Vec::new();
        for (index, action) in task.actions.iter().enumerate() {
            let ends = |state: f64| action.is_stop() || violates_safety(&task.joint, action, state);
            let mut rows: Rows = Vec::with_capacity(terminal + 1);
            for &state in &states {
                rows.push(if ends(state) {
                    vec![(terminal, 1.0)]
                } else {
                    moved(task, &mut observer, &states, index, state)?
                });
            }
            rows.push(vec![(terminal, 1.0)]);
            transitions.push(rows);
            seen_after.push(observer.rows(index, action, &states, &bins)?);
            let mut earned: Vec<f64> = states
                .iter()
                .map(|&state| reward(task, action, state, goal))
                .collect();
            earned.push(0.0);
            rewards.push(earned);
        }
        let groups = Groups::of(&seen_after, count);
        for rows in seen_after {
            observation_rows.push(with_ends(groups.merge(rows)));
        }
        let names = states.iter().map(|&state| task.joint.display(state));
        let pomdp = Pomdp::new(PomdpParts {
            name: task.name.clone(),
            states: names.chain(["ended".to_owned()]).collect(),
            actions: task
                .actions
                .iter()
                .map(|action| action.name.clone())
                .collect(),
            observations: (0..groups.count()).map(|index| index.to_string()).collect(),
            discount: task.reward.discount,
            start: start(task, &states),
            transitions,
            observation_rows,
            rewards,
        })?;
        Ok(Self {
            pomdp,
            options,
            bins,
            groups,
        })
    }

    /// The observation that readings `[C]` fall into.
    pub fn observe(&self, readings: &[f32]) -> usize {
        let channels = self.bins.iter().zip(readings);
        let place = channels.fold(0, |index, (bins, &reading)| {
            index * bins.count() + bins.place(f64::from(reading))
        });
        self.groups.of_place(place)
    }
}

impl fmt::Display for GridOptions {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} states and {} bins for each channel",
            self.bins, self.observation_bins
        )
    }
}

/// Rows with that of the terminal state: where nothing is read, the first observation stands for it.
fn with_ends(mut rows: Rows) -> Rows {
    rows.push(Vec::new());
    for row in rows.iter_mut().filter(|row| row.is_empty()) {
        row.push((0, 1.0));
    }
    rows
}

fn checked_count(bins: &[Bins], asked: usize) -> Result<usize, GridError> {
    let count: usize = bins.iter().map(Bins::count).product();
    if count > MOST_OBSERVATIONS {
        return Err(GridError::Observations { bins: asked, count });
    }
    Ok(count)
}

/// R(s, a), the time penalty in it.
fn reward(task: &Task, action: &Action, state: f64, goal: f64) -> f64 {
    let reward = &task.reward;
    let earned = if action.is_stop() {
        reward.of_stop(state, goal)
    } else if violates_safety(&task.joint, action, state) {
        reward.safety_violation
    } else {
        0.0
    };
    earned + reward.time
}

/// Even over the bins in which the state may be at first.
fn start(task: &Task, states: &[f64]) -> Vec<f64> {
    let (from, to) = task.joint.start;
    let slack = 1e-9 * task.joint.range();
    let inside = |state: &f64| (from - slack..=to + slack).contains(state);
    let count = states.iter().filter(|state| inside(state)).count().max(1);
    let share = |state: &f64| {
        if inside(state) {
            1.0 / count as f64
        } else {
            0.0
        }
    };
    states.iter().map(share).chain([0.0]).collect()
}

/// Whether a channel says 0 or 1.
fn is_binary(channel: &Channel) -> bool {
    channel.kind == ChannelKind::Bernoulli
}
