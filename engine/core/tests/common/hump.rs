//! A model to try the filter on, what happens to it, and entropy by brute force.

use pubs_core::belief::{Model, ModelError};
use pubs_plugin::{Channel, ChannelKind, GridTransitions, Support, Transitions};

/// A force with a hump and a slope, and m_p that fails near the closed limit.
pub fn mean(state: f64) -> f64 {
    12.0 * (-(state - 0.4) * (state - 0.4) / 0.02).exp() + 2.0 * state
}
pub fn sigma(state: f64) -> f64 {
    0.6 + 0.2 * state
}
pub fn probability(state: f64) -> f64 {
    if state < 0.15 { 0.05 } else { 0.98 }
}

pub struct Hump {
    channels: Vec<Channel>,
    grid: bool,
    gaussian: bool,
}

impl Hump {
    pub fn new(grid: bool, gaussian: bool) -> Self {
        let channel = |name: &str, kind| Channel {
            name: name.to_owned(),
            kind,
        };
        let channels = vec![
            channel("f_d", ChannelKind::Gaussian),
            channel("m_p", ChannelKind::Bernoulli),
        ];
        Self {
            channels,
            grid,
            gaussian,
        }
    }

    fn fill(
        before: impl Iterator<Item = f32>,
        after: impl Iterator<Item = f32>,
        mean_out: &mut [f32],
        sigma_out: &mut [f32],
    ) {
        let count = mean_out.len() / 2;
        for (index, (before, after)) in before.zip(after).enumerate() {
            mean_out[index] = mean(f64::from(after)) as f32;
            sigma_out[index] = sigma(f64::from(after)) as f32;
            mean_out[count + index] = probability(f64::from(before)) as f32;
        }
    }
}

impl Model for Hump {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn moments(
        &self,
        on: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        if !self.gaussian {
            return Ok(Support::Absent);
        }
        Self::fill(
            on.before.iter().copied(),
            on.after.iter().copied(),
            mean,
            sigma,
        );
        Ok(Support::Given)
    }

    fn moments_grid(
        &self,
        grid: GridTransitions,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        if !self.grid {
            return Ok(Support::Absent);
        }
        let clamp = |first: f32| {
            (0..grid.count).map(move |i| (first + i as f32 * grid.spacing).clamp(0.0, 2.0))
        };
        Self::fill(clamp(grid.before), clamp(grid.after), mean, sigma);
        Ok(Support::Given)
    }

    fn log_likelihood(
        &self,
        on: Transitions<'_>,
        observation: &[f32],
        out: &mut [f32],
    ) -> Result<Support, ModelError> {
        for (index, out) in out.iter_mut().enumerate() {
            let (before, after) = (f64::from(on.before[index]), f64::from(on.after[index]));
            *out = log_density(
                before,
                after,
                f64::from(observation[0]),
                observation[1] > 0.5,
            ) as f32;
        }
        Ok(Support::Given)
    }
}

pub fn log_density(before: f64, after: f64, force: f64, moved: bool) -> f64 {
    let z = (force - mean(after)) / sigma(after);
    let p = probability(before);
    -0.5 * z * z - sigma(after).ln() + if moved { p.ln() } else { (1.0 - p).ln() }
}

/// (displacement, force, moved): against the catch, through it, to the open limit and back.
pub fn story() -> Vec<(f64, f32, bool)> {
    let mut story = vec![(0.0, 4.0, false), (0.0, 3.1, false)];
    story.extend((0..12).map(|i| (0.03, mean(0.1 + 0.03 * f64::from(i + 1)) as f32 + 0.3, true)));
    story.extend((0..60).map(|i| {
        (
            0.03,
            mean(0.46 + 0.03 * f64::from(i + 1)) as f32 - 0.2,
            true,
        )
    }));
    story.extend((0..20).map(|i| (-0.01, mean(2.0 - 0.01 * f64::from(i + 1)) as f32, true)));
    story
}

/// −Σ p ln p over places, p being the share of all weights at that place; states ascend.
pub fn entropy_of_places(states: &[f64], weights: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    let mut entropy = 0.0;
    let mut from = 0;
    while from < states.len() {
        let here = states[from..]
            .iter()
            .take_while(|state| **state - states[from] < 1e-9)
            .count();
        let share = weights[from..from + here].iter().sum::<f64>() / total;
        if share > 0.0 {
            entropy -= share * share.ln();
        }
        from += here;
    }
    entropy
}
