//! The generative model s', o ← G(s, a) of one filter update, §III-A.4.

use std::sync::Arc;

use pubs_core::belief::{Model, ModelError};
use pubs_core::{Action, Mode, Motion, Task};
use pubs_plugin::{ChannelKind, Support, Transitions};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

/// The simulated object: its true state and the noise that hangs over an episode.
pub struct Simulator {
    model: Arc<dyn Model>,
    state: f64,
    lower: f64,
    upper: f64,
    integer: bool,
    threshold: Option<f64>,
    force_threshold_n: Option<f32>,
    motion_channel: Option<usize>,
    force_channel: Option<usize>,
    bias_sd_n: f64,
    correlation: f64,
    bias: Vec<f32>,
    correlated: Vec<f32>,
    mean: Vec<f32>,
    sigma: Vec<f32>,
    normals: Vec<f32>,
    observation: Vec<f32>,
}

impl Simulator {
    /// A simulator of the task's object, as its observation model knows it.
    pub fn new(task: &Task, model: Arc<dyn Model>) -> Self {
        let channels = model.channels();
        let index_of = |name: &str| channels.iter().position(|channel| channel.name == name);
        let (motion_channel, force_channel) = (index_of("m_p"), index_of("f_d"));
        let zeros = vec![0.0; channels.len()];
        let on_arm = task.control.is_some();
        Self {
            state: task.joint.lower,
            lower: task.joint.lower,
            upper: task.joint.upper,
            integer: task.joint.is_integer(),
            threshold: task
                .joint
                .geometry()
                .map(|geometry| geometry.motion_threshold_m * task.joint.per_metre()),
            force_threshold_n: task.control.map(|control| control.force_threshold_n as f32),
            motion_channel: motion_channel.filter(|_| on_arm),
            force_channel: force_channel.filter(|_| on_arm),
            bias_sd_n: task.observation.bias_sd_n,
            correlation: task.observation.correlation,
            bias: zeros.clone(),
            correlated: zeros.clone(),
            mean: zeros.clone(),
            sigma: zeros.clone(),
            normals: zeros.clone(),
            observation: zeros,
            model,
        }
    }

    /// Places the true state and draws the episode's force bias.
    pub fn place(&mut self, state: f64, rng: &mut impl Rng) {
        self.state = if self.integer { state.round() } else { state };
        for (index, channel) in self.model.channels().iter().enumerate() {
            let gaussian = channel.kind == ChannelKind::Gaussian;
            self.bias[index] = if gaussian && self.bias_sd_n > 0.0 {
                rng.sample::<f32, _>(StandardNormal) * self.bias_sd_n as f32
            } else {
                0.0
            };
            self.correlated[index] = rng.sample(StandardNormal);
        }
    }

    /// The true state (rad, m or plain).
    pub fn state(&self) -> f64 {
        self.state
    }

    /// One filter update's worth of `action`: moves the true state and draws an observation. The
    /// displacement that was really made and the observation `[C]`.
    ///
    /// # Errors
    /// Where the model cannot answer.
    pub fn step(
        &mut self,
        index: usize,
        action: &Action,
        displacement: f64,
        rng: &mut impl Rng,
    ) -> Result<(f64, &[f32]), ModelError> {
        let before = self.state;
        let target = (before + displacement).clamp(self.lower, self.upper);
        let gaussian = self.predict(index, before, target)?;
        let hindered = gaussian && self.is_hindered(action, rng);
        let after = if hindered { before } else { target };
        if hindered {
            self.predict(index, before, after)?;
        }
        self.state = after;
        if gaussian {
            self.draw(after - before, rng);
        } else {
            self.draw_from_model(index, before, after, rng)?;
        }
        Ok((after - before, &self.observation))
    }

    /// Moments of one transition; false where the model has none.
    fn predict(&mut self, action: usize, before: f64, after: f64) -> Result<bool, ModelError> {
        let (before, after) = ([before as f32], [after as f32]);
        let transitions = Transitions {
            action,
            before: &before,
            after: &after,
        };
        Ok(self
            .model
            .moments(transitions, &mut self.mean, &mut self.sigma)?
            == Support::Given)
    }

    /// Whether the handle stays where it is although the action would move it: the force at the
    /// state before the move decides, as m_p models it, or where that is not modelled, as the
    /// safe mode's threshold does.
    fn is_hindered(&self, action: &Action, rng: &mut impl Rng) -> bool {
        if let Some(channel) = self.motion_channel {
            return rng.random::<f32>() >= self.mean[channel];
        }
        let safe = matches!(
            action.motion,
            Motion::Move {
                mode: Mode::Safe,
                ..
            }
        );
        match (self.force_channel, self.force_threshold_n) {
            (Some(channel), Some(threshold)) if safe => {
                let noise: f32 = rng.sample(StandardNormal);
                self.mean[channel] + self.sigma[channel] * noise > threshold
            }
            _ => false,
        }
    }

    fn draw(&mut self, displacement: f64, rng: &mut impl Rng) {
        // Share of the noise that a reading keeps from the one before: e^(−travel/correlation).
        let kept = if self.correlation > 0.0 {
            (-displacement.abs() / self.correlation).exp() as f32
        } else {
            0.0
        };
        let fresh = (1.0 - kept * kept).sqrt();
        for (index, channel) in self.model.channels().iter().enumerate() {
            self.observation[index] = match channel.kind {
                ChannelKind::Gaussian => {
                    let normal: f32 = rng.sample(StandardNormal);
                    let noise = kept * self.correlated[index] + fresh * normal;
                    self.correlated[index] = noise;
                    self.mean[index] + self.bias[index] + self.sigma[index] * noise
                }
                // On an arm m_p is what the handle did; elsewhere it is drawn.
                ChannelKind::Bernoulli => {
                    let one = match self.threshold {
                        Some(threshold) if self.motion_channel == Some(index) => {
                            displacement.abs() > threshold
                        }
                        _ => rng.random::<f32>() < self.mean[index],
                    };
                    f32::from(u8::from(one))
                }
            };
        }
    }

    fn draw_from_model(
        &mut self,
        action: usize,
        before: f64,
        after: f64,
        rng: &mut impl Rng,
    ) -> Result<(), ModelError> {
        for normal in &mut self.normals {
            *normal = rng.sample(StandardNormal);
        }
        let (before, after) = ([before as f32], [after as f32]);
        let transitions = Transitions {
            action,
            before: &before,
            after: &after,
        };
        match self
            .model
            .sample(transitions, &self.normals, &mut self.observation)?
        {
            Support::Given => Ok(()),
            Support::Absent => Err(ModelError(
                "the observation model provides neither moments nor sample".to_owned(),
            )),
        }
    }
}
