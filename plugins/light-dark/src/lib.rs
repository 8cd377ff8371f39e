//! Observation model `light-dark`: the 1D Light-Dark benchmark.
//!
//! The state is seen directly, and the better the nearer it is to a light: one Gaussian channel
//! `position` with mean s' and sigma = |s' − light| · slope + floor, s' being the state after the
//! move. The defaults are those of the code behind the benchmark that the paper compares with (its
//! reference 30): light 10, slope 1, floor 0.001.
//!
//! The floor keeps the density finite at the light. It is so small that one observation there names
//! the state.

use pubs_plugin::{
    Channel, ChannelKind, ModelSetup, ObservationModel, PluginError, Support, Transitions,
    export_observation_model, number_or,
};

/// The light and how fast it fades.
#[derive(Debug)]
struct LightDark {
    channels: [Channel; 1],
    light: f32,
    slope: f32,
    floor: f32,
}

impl ObservationModel for LightDark {
    const NAME: &'static str = "light-dark";
    const VERSION: &'static str = env!("CARGO_PKG_VERSION");
    const PARAMS_SCHEMA: &'static str = include_str!("params.schema.json");

    fn create(setup: &ModelSetup) -> Result<Self, PluginError> {
        let params = &setup.observation["params"];
        Ok(Self {
            channels: [Channel {
                name: "position".to_owned(),
                kind: ChannelKind::Gaussian,
            }],
            light: number_or(params, "light", 10.0)?,
            slope: number_or(params, "slope", 1.0)?,
            floor: number_or(params, "floor", 1e-3)?,
        })
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, PluginError> {
        mean.copy_from_slice(transitions.after);
        for (sigma, state) in sigma.iter_mut().zip(transitions.after) {
            *sigma = (state - self.light).abs() * self.slope + self.floor;
        }
        Ok(Support::Given)
    }
}

export_observation_model!(LightDark);

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
