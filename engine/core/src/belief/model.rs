//! What the filter needs of an observation model.

use pubs_plugin::{Channel, GridTransitions, Support, Transitions};

/// An observation model that could not answer, in words for the user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ModelError(pub String);

/// An observation model, wherever it comes from. The functions are those of
/// [`pubs_plugin::ObservationModel`].
pub trait Model: Send + Sync {
    /// The components of an observation.
    fn channels(&self) -> &[Channel];

    /// Mean and sigma of each channel, `[C][N]`.
    ///
    /// # Errors
    /// Where the model cannot answer.
    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError>;

    /// The same on a regular grid.
    ///
    /// # Errors
    /// Where the model cannot answer.
    fn moments_grid(
        &self,
        _grid: GridTransitions,
        _mean: &mut [f32],
        _sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        Ok(Support::Absent)
    }

    /// ln Z of one observation `[C]` under each hypothesis, `[N]`.
    ///
    /// # Errors
    /// Where the model cannot answer.
    fn log_likelihood(
        &self,
        _transitions: Transitions<'_>,
        _observation: &[f32],
        _log_likelihood: &mut [f32],
    ) -> Result<Support, ModelError> {
        Ok(Support::Absent)
    }

    /// One observation per hypothesis, `[C][N]`, from standard normals `[C][N]`.
    ///
    /// # Errors
    /// Where the model cannot answer.
    fn sample(
        &self,
        _transitions: Transitions<'_>,
        _normals: &[f32],
        _observations: &mut [f32],
    ) -> Result<Support, ModelError> {
        Ok(Support::Absent)
    }
}
