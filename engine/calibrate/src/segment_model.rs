//! An observation model straight from segments, to try them out before they are in a file.

use pubs_core::belief::{Model, ModelError};
use pubs_plugin::{Channel as PluginChannel, ChannelKind, Support, Transitions};

use crate::segment::{Channel, Segment, Values};
use crate::stored;

/// Mean and sigma by action index, channel and state.
pub struct SegmentModel {
    channels: Vec<PluginChannel>,
    kinds: Vec<Channel>,
    /// `[action][channel]`, ascending; empty where nothing is known.
    stretches: Vec<Vec<Vec<Stretch>>>,
}

struct Stretch {
    from: f64,
    position: Vec<f64>,
    mean: Vec<f64>,
    sigma: Vec<f64>,
}

/// Sigma of a channel about which nothing is known: no reading tells states apart by it.
const UNKNOWN_SIGMA: f64 = 1e6;

impl SegmentModel {
    /// A model of `channels` for the actions of these names, in index order.
    pub fn new(actions: &[String], channels: &[Channel], segments: &[Segment]) -> Self {
        let of = |action: &String, channel: &Channel| {
            let own = segments
                .iter()
                .filter(|segment| segment.action == *action && segment.channel == *channel);
            let mut stretches: Vec<Stretch> = own.map(Stretch::of).collect();
            stretches.sort_by(|a, b| a.from.total_cmp(&b.from));
            stretches
        };
        Self {
            channels: channels.iter().map(plugin_channel).collect(),
            kinds: channels.to_vec(),
            stretches: actions
                .iter()
                .map(|action| channels.iter().map(|channel| of(action, channel)).collect())
                .collect(),
        }
    }
}

fn plugin_channel(channel: &Channel) -> PluginChannel {
    PluginChannel {
        name: channel.name().to_owned(),
        kind: match channel {
            Channel::Moves => ChannelKind::Bernoulli,
            _ => ChannelKind::Gaussian,
        },
    }
}

impl Stretch {
    fn of(segment: &Segment) -> Self {
        let (position, mean, sigma) = match &segment.values {
            Values::Force {
                position,
                mean_n,
                sigma_n,
            } => (position.clone(), mean_n.clone(), sigma_n.clone()),
            Values::Moves { probability } => (vec![segment.from], vec![*probability], vec![1.0]),
        };
        Self {
            from: segment.from,
            position,
            mean,
            sigma,
        }
    }

    fn at(&self, state: f64) -> (f64, f64) {
        let of = |values: &[f64]| stored::at(&self.position, values, state);
        (of(&self.mean), of(&self.sigma))
    }
}

impl Model for SegmentModel {
    fn channels(&self) -> &[PluginChannel] {
        &self.channels
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        let count = transitions.after.len();
        for (index, (channel, stretches)) in self
            .kinds
            .iter()
            .zip(&self.stretches[transitions.action])
            .enumerate()
        {
            // The force before a move decides whether the handle moves; forces are felt after it.
            let states = match channel {
                Channel::Moves => transitions.before,
                _ => transitions.after,
            };
            for (place, &state) in states.iter().enumerate() {
                let (m, s) = look_up(stretches, f64::from(state));
                mean[index * count + place] = m as f32;
                sigma[index * count + place] = s as f32;
            }
        }
        Ok(Support::Given)
    }
}

fn look_up(stretches: &[Stretch], state: f64) -> (f64, f64) {
    let after = stretches.partition_point(|stretch| stretch.from <= state);
    stretches
        .get(after.saturating_sub(1))
        .map_or((0.5, UNKNOWN_SIGMA), |stretch| stretch.at(state))
}
