//! What PPO asks of the networks it trains, perceptrons or recurrent ones.

use std::ops::Range;

use crate::kernels::column::Column;
use crate::recipe::Recipe;
use crate::rollout::Rollout;

/// A policy and a value network in training.
pub(crate) trait Agent {
    /// Samples of one copy that stay together, in order, in every minibatch.
    fn sequence(&self, recipe: &Recipe) -> usize;

    /// The policy, to collect the next rollout with.
    fn actor(&mut self) -> impl Actor;

    /// Estimates advantages and returns of a rollout with the value network.
    fn estimate(&mut self, rollout: &mut Rollout, discount: f32, lambda: f32);

    /// Moves both networks by one step on these sequences, counted from 0 over the rollout; an
    /// error is the length of a gradient that is not finite.
    fn step(&mut self, rollout: &Rollout, minibatch: &[u32], update: Update) -> Result<(), f32>;
}

/// A policy that acts.
pub(crate) trait Actor {
    /// Logits `[action]` of a block of copies with these scaled observations `[copy][feature]`.
    fn logits(&mut self, copies: Range<usize>, features: &[f32], logits: &mut [Column]);

    /// The next observation of this copy is the first of an episode.
    fn begin_episode(&mut self, copy: usize);
}

/// Numbers of the present update.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Update {
    pub(crate) learning_rate: f32,
    pub(crate) clip_range: f32,
    pub(crate) entropy_coefficient: f32,
    pub(crate) value_coefficient: f32,
    /// Longest gradient, over both networks together.
    pub(crate) gradient_norm: f32,
}

impl Update {
    /// The scheduled numbers when `done` (0 to 1) of all updates are behind.
    pub(crate) fn at(recipe: &Recipe, done: f32) -> Self {
        Self {
            learning_rate: recipe.learning_rate.at(done),
            clip_range: recipe.clip_range,
            entropy_coefficient: recipe.entropy_coefficient.at(done),
            value_coefficient: recipe.value_coefficient,
            gradient_norm: recipe.gradient_norm,
        }
    }
}
