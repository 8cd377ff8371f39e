//! The force bias that each particle carries: what turns the filter into a Rao-Blackwellised one.
//!
//! A tare leaves an offset, and friction is not the same every day. Where the force hardly changes
//! along the range, a filter that knows of neither takes them for another place and is soon sure of
//! it. Along the path of one particle a reading is linear in both, so they need not be sampled:
//! their means and variances follow exactly, a Kalman filter inside each particle (Doucet, de
//! Freitas, Murphy and Russell, 2000).
//!
//! The two are told apart by turning round. The axes of f_d and f_n turn with the motion, so an
//! offset of the sensor changes its sign in them; friction always resists, so it does not.

use pubs_plugin::Channel;

use super::ForceBias;
use super::likelihood::ForceBiases;
use crate::Action;

/// Estimates of one channel at one particle: those of [`ForceBiases`].
const ESTIMATES: usize = 5;

/// Biases of all channels at all particles.
pub struct Biases {
    particles: usize,
    offset_variance: f32,
    walk_variance: f32,
    channels: Vec<ChannelKnowledge>,
    /// `[C][ESTIMATES][N]`, in one piece so that it is soon copied.
    estimates: Vec<f32>,
    before: Vec<f32>,
}

/// What is known of a channel's biases beforehand.
struct ChannelKnowledge {
    turns_with_motion: bool,
    friction_variance: f32,
}

impl Biases {
    /// Biases of which nothing is known but how large they tend to be.
    pub fn new(settings: ForceBias, particles: usize, channels: &[Channel]) -> Self {
        let square = |value: f64| (value * value) as f32;
        let knowledge = |channel: &Channel| {
            let along = channel.name == "f_d";
            ChannelKnowledge {
                turns_with_motion: along || channel.name == "f_n",
                friction_variance: square(if along { settings.friction_sd_n } else { 0.0 }),
            }
        };
        let estimates = vec![0.0; channels.len() * ESTIMATES * particles];
        let mut biases = Self {
            particles,
            offset_variance: square(settings.offset_sd_n),
            walk_variance: square(settings.offset_walk_n),
            channels: channels.iter().map(knowledge).collect(),
            before: estimates.clone(),
            estimates,
        };
        biases.forget();
        biases
    }

    /// Forgets what readings have said.
    pub fn forget(&mut self) {
        let of_channels = self.estimates.chunks_exact_mut(ESTIMATES * self.particles);
        for (estimates, known) in of_channels.zip(&self.channels) {
            estimates.fill(0.0);
            let [_, _, offset_variance, _, friction_variance] =
                taken_apart(estimates, self.particles);
            offset_variance.fill(self.offset_variance);
            friction_variance.fill(known.friction_variance);
        }
    }

    /// Remembers the estimates for [`restore`](Self::restore).
    pub fn remember(&mut self) {
        self.before.copy_from_slice(&self.estimates);
    }

    /// Takes back what has been learnt since they were remembered.
    pub fn restore(&mut self) {
        self.estimates.copy_from_slice(&self.before);
    }

    /// The biases of a channel while `action` moves.
    pub fn of(&mut self, channel: usize, action: &Action) -> ForceBiases<'_> {
        let turned = self.channels[channel].turns_with_motion && action.sign() < 0.0;
        let length = ESTIMATES * self.particles;
        let estimates = &mut self.estimates[channel * length..][..length];
        let [
            offset,
            friction,
            offset_variance,
            covariance,
            friction_variance,
        ] = taken_apart(estimates, self.particles);
        ForceBiases {
            sign: if turned { -1.0 } else { 1.0 },
            walk_variance: self.walk_variance,
            offset,
            friction,
            offset_variance,
            covariance,
            friction_variance,
        }
    }
}

/// Of one channel, in the order of [`ForceBiases`].
fn taken_apart(estimates: &mut [f32], particles: usize) -> [&mut [f32]; ESTIMATES] {
    let mut parts = estimates.chunks_exact_mut(particles);
    std::array::from_fn(|_| parts.next().unwrap_or_default())
}
