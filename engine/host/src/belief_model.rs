//! A plugin's model, as the belief asks it.

use pubs_core::belief::{Model, ModelError};
use pubs_plugin::{Channel, GridTransitions, Support, Transitions};

use crate::{HostError, ModelInstance};

fn said(error: HostError) -> ModelError {
    ModelError(error.to_string())
}

impl Model for ModelInstance {
    fn channels(&self) -> &[Channel] {
        Self::channels(self)
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        Self::moments(self, transitions, mean, sigma).map_err(said)
    }

    fn moments_grid(
        &self,
        grid: GridTransitions,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        Self::moments_grid(self, grid, mean, sigma).map_err(said)
    }

    fn log_likelihood(
        &self,
        transitions: Transitions<'_>,
        observation: &[f32],
        log_likelihood: &mut [f32],
    ) -> Result<Support, ModelError> {
        Self::log_likelihood(self, transitions, observation, log_likelihood).map_err(said)
    }

    fn sample(
        &self,
        transitions: Transitions<'_>,
        normals: &[f32],
        observations: &mut [f32],
    ) -> Result<Support, ModelError> {
        Self::sample(self, transitions, normals, observations).map_err(said)
    }
}
