//! Training a recurrent policy.

use std::ops::ControlFlow;

use pubs_core::vector::VectorUnit;

use super::Lstm;
use super::export::LstmLayer;
use super::learner::RecurrentLearner;
use super::network::RecurrentNetwork;
use super::policy::RecurrentPolicy;
use super::trace::Span;
use super::trainee::Trainee;
use crate::environment::Environments;
use crate::error::TrainError;
use crate::network::DenseLayer;
use crate::ppo::{POLICY_GAIN, Settings, VALUE_GAIN, check, run, widths};
use crate::progress::Progress;
use crate::rng::stream;

/// What training gives.
#[derive(Debug)]
pub struct TrainedRecurrent {
    /// The policy, with its scaling.
    pub policy: RecurrentPolicy,
    /// The value network's recurrent layers; they expect scaled inputs.
    pub value_lstm: Vec<LstmLayer>,
    /// The value network's layers above them.
    pub value: Vec<DenseLayer>,
    /// How it stood at the end, with steps and time.
    pub progress: Progress,
    /// How it stood on the way, at about 200 even steps.
    pub curve: Vec<Progress>,
    /// Time spent with environments and drawing actions, s.
    pub rollout_s: f64,
    /// Time spent on gradient steps, s.
    pub learning_s: f64,
    /// The vector unit that was used.
    pub unit: VectorUnit,
}

/// Trains a recurrent policy, as [`train`](crate::train) does a perceptron: `settings.layers` lie
/// above the recurrent ones. Minibatches hold whole sequences of `recipe.rollout` steps, as many
/// as fit into `recipe.minibatch`, at least one; see
/// [`Recipe::recurrent`](crate::Recipe::recurrent).
///
/// # Errors
/// Where the settings are out of range or do not fit the environments, an environment fails, the
/// numbers diverge, or `report` breaks.
pub fn train_recurrent<E: Environments>(
    environments: &mut E,
    settings: &Settings,
    lstm: Lstm,
    report: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Result<TrainedRecurrent, TrainError<E::Error>> {
    check(environments, settings)?;
    if lstm.layers == 0 || lstm.width == 0 {
        let fault = format!(
            "there are {} recurrent layers of width {}",
            lstm.layers, lstm.width
        );
        return Err(TrainError::Settings(fault));
    }
    let mut learner = new_learner(environments, settings, lstm);
    let run = run(environments, settings, &mut learner, report)?;
    let value = learner.value.network;
    Ok(TrainedRecurrent {
        policy: RecurrentPolicy::new(learner.policy.network, settings.scaling.clone()),
        value_lstm: value.stack.export(),
        value: value.head.export(),
        progress: run.progress,
        curve: run.curve,
        rollout_s: run.rollout_s,
        learning_s: run.learning_s,
        unit: settings.unit,
    })
}

fn new_learner(
    environments: &impl Environments,
    settings: &Settings,
    lstm: Lstm,
) -> RecurrentLearner {
    let recipe = &settings.recipe;
    let largest = Span {
        steps: recipe.rollout,
        rows: recipe.sequences(recipe.rollout).min(recipe.environments),
    };
    let trainee = |name: &str, outputs: usize, gain: f64| {
        let network = RecurrentNetwork::new(
            settings.unit,
            environments.features(),
            lstm,
            &widths(lstm.width, settings, outputs),
            gain,
            &mut stream(settings.seed, name),
        );
        Trainee::new(network, recipe.environments, largest, recipe.adam_epsilon)
    };
    let policy = trainee("policy weights", environments.actions(), POLICY_GAIN);
    let value = trainee("value weights", 1, VALUE_GAIN);
    RecurrentLearner::new(settings.unit, policy, value, largest)
}
