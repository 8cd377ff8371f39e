//! An observation model in Rust, as a user may write one: the door gets heavier as it opens.
//!
//! f_d is normal with mean = `slope_n_per_rad` · state and sigma 0.5 N; the handle moves (m_p) with
//! probability 0.95. The same as `ramp.c`, under another name.

use pubs_plugin::{
    Channel, ChannelKind, ModelSetup, ObservationModel, PluginError, Support, Transitions,
    export_observation_model,
};

struct Ramp {
    channels: Vec<Channel>,
    slope: f32,
}

impl ObservationModel for Ramp {
    const NAME: &'static str = "ramp-in-rust";
    const VERSION: &'static str = "1.0.0";
    const PARAMS_SCHEMA: &'static str = r#"{
        "properties": {
            "params": {
                "type": "object",
                "properties": { "slope_n_per_rad": { "type": "number", "minimum": 0 } },
                "required": ["slope_n_per_rad"]
            }
        },
        "required": ["params"]
    }"#;

    fn create(setup: &ModelSetup) -> Result<Self, PluginError> {
        let slope = setup.observation["params"]["slope_n_per_rad"].as_f64();
        let channel = |name: &str, kind| Channel {
            name: name.to_owned(),
            kind,
        };
        Ok(Self {
            channels: vec![
                channel("f_d", ChannelKind::Gaussian),
                channel("m_p", ChannelKind::Bernoulli),
            ],
            slope: slope.ok_or("`slope_n_per_rad` is missing")? as f32,
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
        let count = transitions.after.len();
        let (force, moves) = mean.split_at_mut(count);
        for (target, state) in force.iter_mut().zip(transitions.after) {
            *target = self.slope * state;
        }
        moves.fill(0.95);
        sigma.fill(0.5);
        Ok(Support::Given)
    }
}

export_observation_model!(Ramp);
