//! A plugin's model as the belief filter takes it.

use pubs_core::belief::{Model, ModelError};
use pubs_plugin::{Channel, GridTransitions, Support, Transitions};

use crate::{HostError, ModelInstance};

impl Model for ModelInstance {
    fn channels(&self) -> &[Channel] {
        self.channels()
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        self.moments(transitions, mean, sigma).map_err(in_words)
    }

    fn moments_grid(
        &self,
        grid: GridTransitions,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        self.moments_grid(grid, mean, sigma).map_err(in_words)
    }

    fn log_likelihood(
        &self,
        transitions: Transitions<'_>,
        observation: &[f32],
        log_likelihood: &mut [f32],
    ) -> Result<Support, ModelError> {
        self.log_likelihood(transitions, observation, log_likelihood)
            .map_err(in_words)
    }

    fn sample(
        &self,
        transitions: Transitions<'_>,
        normals: &[f32],
        observations: &mut [f32],
    ) -> Result<Support, ModelError> {
        self.sample(transitions, normals, observations)
            .map_err(in_words)
    }
}

#[cold]
fn in_words(error: HostError) -> ModelError {
    ModelError(error.to_string())
}
