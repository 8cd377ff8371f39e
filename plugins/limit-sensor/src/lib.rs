//! Observation model `limit-sensor`: the paper's Sim Object (§IV-A.1), "a 1D force signal that is
//! high at the joint limits and low elsewhere".
//!
//! One Gaussian channel `force`: mean `high_n` where the state after the move is at either limit,
//! `low_n` elsewhere, sigma `sigma_n` everywhere. A state is at a limit when it is no farther from
//! it than `reach`: each whole number owns the half-unit on either side of it, so the default, 0.5,
//! is the limit itself alone on whole-number states.
//!
//! The paper gives no numbers. With the defaults a reading lies 50 sigma from the nearest one that
//! could be mistaken: a perfect binary sensor for all that a filter can tell, and both limits feel
//! the same.

use pubs_plugin::{
    Channel, ChannelKind, ModelSetup, ObservationModel, PluginError, Support, Transitions,
    export_observation_model, number_or,
};

/// The limits and what they feel like.
#[derive(Debug)]
struct LimitSensor {
    channels: [Channel; 1],
    lower: f32,
    upper: f32,
    reach: f32,
    high_n: f32,
    low_n: f32,
    sigma_n: f32,
}

impl ObservationModel for LimitSensor {
    const NAME: &'static str = "limit-sensor";
    const VERSION: &'static str = env!("CARGO_PKG_VERSION");
    const PARAMS_SCHEMA: &'static str = include_str!("params.schema.json");

    fn create(setup: &ModelSetup) -> Result<Self, PluginError> {
        let params = &setup.observation["params"];
        Ok(Self {
            channels: [Channel {
                name: "force".to_owned(),
                kind: ChannelKind::Gaussian,
            }],
            lower: setup.joint.lower as f32,
            upper: setup.joint.upper as f32,
            reach: number_or(params, "reach", 0.5)?,
            high_n: number_or(params, "high_n", 10.0)?,
            low_n: number_or(params, "low_n", 0.0)?,
            sigma_n: number_or(params, "sigma_n", 0.1)?,
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
        for (mean, &state) in mean.iter_mut().zip(transitions.after) {
            let at_limit = state - self.lower <= self.reach || self.upper - state <= self.reach;
            *mean = if at_limit { self.high_n } else { self.low_n };
        }
        sigma.fill(self.sigma_n);
        Ok(Support::Given)
    }
}

export_observation_model!(LimitSensor);

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
