//! The observation model Z(o | s, a), eq. (11), as a plugin provides it.

use crate::{ModelSetup, PluginError};

/// How a channel is distributed, and at which state it is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelKind {
    /// A real number, normally distributed with `mean` and `sigma` at the state *after* the move.
    Gaussian,
    /// 0 or 1. `mean` is the probability of 1 at the state *before* the move, because the force
    /// there decides whether the handle moves; `sigma` is not read.
    Bernoulli,
}

/// One component of the observation vector.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// `f_d`, `f_z`, `f_n` (N) or `m_p` (0 or 1) on a robot; anything on an abstract object.
    pub name: String,
    /// Its distribution.
    pub kind: ChannelKind,
}

/// N hypotheses about one move: the state before it and after it.
#[derive(Debug, Clone, Copy)]
pub struct Transitions<'a> {
    /// Index of the action carried out.
    pub action: usize,
    /// States before the move, length N.
    pub before: &'a [f32],
    /// States after the move, length N.
    pub after: &'a [f32],
}

/// N hypotheses on a regular grid: hypothesis i moved from `before + i·spacing` to
/// `after + i·spacing`. Points may lie outside the limits; answer there with the nearest limit's
/// values, the engine replaces them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridTransitions {
    /// Index of the action carried out.
    pub action: usize,
    /// State of hypothesis 0 before the move.
    pub before: f32,
    /// State of hypothesis 0 after the move.
    pub after: f32,
    /// Distance between neighbours, positive.
    pub spacing: f32,
    /// N.
    pub count: usize,
}

/// Whether a model answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The output is filled.
    Given,
    /// The model does not provide this function (or not for these arguments); the output is
    /// untouched and the engine takes its other way.
    Absent,
}

/// An observation model. After [`create`](Self::create) its functions may be called from several
/// threads at once.
///
/// A Gaussian model provides [`moments`](Self::moments), and the engine forms eq. (11) itself.
/// Another model provides [`log_likelihood`](Self::log_likelihood) and [`sample`](Self::sample).
/// Batches only: N is the number of particles.
pub trait ObservationModel: Send + Sync + Sized + 'static {
    /// The name an object file uses.
    const NAME: &'static str;
    /// The plugin's own version.
    const VERSION: &'static str;
    /// JSON Schema of the `[observation]` table's own keys: `params`, and for `segments` also
    /// `segment`. Keys it does not name are refused before `create`.
    const PARAMS_SCHEMA: &'static str;

    /// Builds the model for one object.
    ///
    /// # Errors
    /// Where the parameters do not fit the joint or the actions.
    fn create(setup: &ModelSetup) -> Result<Self, PluginError>;

    /// The components of an observation, in the order of every `[C]` axis.
    fn channels(&self) -> &[Channel];

    /// Mean and sigma of each channel, both `[C][N]`.
    ///
    /// # Errors
    /// Where the model cannot answer for these arguments.
    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, PluginError>;

    /// The same on a regular grid; worth providing where it avoids look-ups per particle. Must
    /// agree with [`moments`](Self::moments) inside the limits.
    ///
    /// # Errors
    /// As [`moments`](Self::moments).
    fn moments_grid(
        &self,
        _grid: GridTransitions,
        _mean: &mut [f32],
        _sigma: &mut [f32],
    ) -> Result<Support, PluginError> {
        Ok(Support::Absent)
    }

    /// ln Z(o | s, a, s') of one observation `[C]` under each hypothesis, into `[N]`; untempered.
    ///
    /// # Errors
    /// As [`moments`](Self::moments).
    fn log_likelihood(
        &self,
        _transitions: Transitions<'_>,
        _observation: &[f32],
        _log_likelihood: &mut [f32],
    ) -> Result<Support, PluginError> {
        Ok(Support::Absent)
    }

    /// Draws one observation per hypothesis, `[C][N]`, from standard normals `[C][N]`.
    ///
    /// # Errors
    /// As [`moments`](Self::moments).
    fn sample(
        &self,
        _transitions: Transitions<'_>,
        _normals: &[f32],
        _observations: &mut [f32],
    ) -> Result<Support, PluginError> {
        Ok(Support::Absent)
    }
}
