//! Mean and sigma of every channel at every particle.

use pubs_plugin::{ChannelKind, GridTransitions, Support, Transitions};

use super::{Cloud, Model, ModelError};

/// Buffers `[C][N]`, filled anew for each update.
pub struct Moments {
    particles: usize,
    mean: Vec<f32>,
    sigma: Vec<f32>,
    gathered_mean: Vec<f32>,
    gathered_sigma: Vec<f32>,
}

impl Moments {
    /// Buffers for N particles and C channels.
    pub fn new(particles: usize, channels: usize) -> Self {
        Self {
            particles,
            mean: vec![0.0; channels * particles],
            sigma: vec![1.0; channels * particles],
            gathered_mean: vec![0.0; channels * 2],
            gathered_sigma: vec![1.0; channels * 2],
        }
    }

    /// Mean of channel `index` at each particle; for a Bernoulli channel the probability of 1.
    pub fn mean(&self, index: usize) -> &[f32] {
        &self.mean[index * self.particles..(index + 1) * self.particles]
    }

    /// Sigma of channel `index` at each particle.
    pub fn sigma(&self, index: usize) -> &[f32] {
        &self.sigma[index * self.particles..(index + 1) * self.particles]
    }

    /// Asks the model, on the grid where it can; `Absent` where it has no moments.
    pub fn predict(
        &mut self,
        model: &dyn Model,
        action: usize,
        before: &Cloud,
        after: &Cloud,
    ) -> Result<Support, ModelError> {
        if let (Some(first_before), Some(first_after)) = (before.grid_first(), after.grid_first()) {
            let grid = GridTransitions {
                action,
                before: first_before as f32,
                after: first_after as f32,
                spacing: after.spacing() as f32,
                count: self.particles,
            };
            if model.moments_grid(grid, &mut self.mean, &mut self.sigma)? == Support::Given {
                self.replace_gathered(model, action, before.gathered(), after.gathered())?;
                return Ok(Support::Given);
            }
        }
        let transitions = Transitions {
            action,
            before: before.states(),
            after: after.states(),
        };
        model.moments(transitions, &mut self.mean, &mut self.sigma)
    }

    /// The grid answer holds for particles on the grid; those that a limit has gathered get the
    /// answer for the place where they are.
    fn replace_gathered(
        &mut self,
        model: &dyn Model,
        action: usize,
        before: [(f64, usize); 2],
        after: [(f64, usize); 2],
    ) -> Result<(), ModelError> {
        if before.iter().chain(&after).all(|&(_, count)| count == 0) {
            return Ok(());
        }
        let places = |gathered: [(f64, usize); 2]| gathered.map(|(place, _)| place as f32);
        let transitions = Transitions {
            action,
            before: &places(before),
            after: &places(after),
        };
        model.moments(
            transitions,
            &mut self.gathered_mean,
            &mut self.gathered_sigma,
        )?;
        for (index, channel) in model.channels().iter().enumerate() {
            let [(_, below), (_, above)] = match channel.kind {
                ChannelKind::Gaussian => after,
                ChannelKind::Bernoulli => before,
            };
            let span = index * self.particles..(index + 1) * self.particles;
            for (values, ends) in [
                (&mut self.mean, &self.gathered_mean),
                (&mut self.sigma, &self.gathered_sigma),
            ] {
                let values = &mut values[span.clone()];
                values[..below].fill(ends[2 * index]);
                values[self.particles - above..].fill(ends[2 * index + 1]);
            }
        }
        Ok(())
    }
}
