//! One training with one seed, from a task to a network with named inputs.

use std::ops::ControlFlow;
use std::sync::Arc;

use pubs_core::Task;
use pubs_core::belief::{BeliefError, Model, ModelError};
use pubs_core::seed::stream;
use pubs_policy::{Dense, LstmCell, Network};
use pubs_train::surrogate::{SurrogateEnvironments, TrainingOptions};
use pubs_train::{DenseLayer, Lstm, LstmLayer, Progress, Settings, TrainError};

use crate::candidates::TrainingPlan;
use crate::network::{features, scaling};
use crate::reads::{LSTM_WIDTH, inputs_of};

/// A trained network and how its training went.
#[derive(Debug, Clone)]
pub struct TrainedSeed {
    /// With named and scaled inputs.
    pub network: Network,
    /// Steps, time and the latest episodes.
    pub progress: Progress,
    /// How it stood on the way.
    pub curve: Vec<Progress>,
    /// Share of the time spent on gradient steps, s.
    pub learning_s: f64,
}

/// Why a training brought nothing.
#[derive(Debug, thiserror::Error)]
pub enum TrainSeedError {
    /// The training failed.
    #[error(transparent)]
    Train(#[from] TrainError<BeliefError>),
    /// The observation model does not say what its readings are like.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Trains a policy as `plan` says, with one seed. `report` is called a few times per second and
/// may cancel.
///
/// # Errors
/// [`TrainSeedError`].
pub fn train_seed(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    plan: &TrainingPlan,
    seed: u64,
    report: &dyn Fn(&Progress) -> ControlFlow<()>,
) -> Result<TrainedSeed, TrainSeedError> {
    let channels = model.channels().len();
    let inputs = inputs_of(plan.method, plan.entropy, plan.goals, channels);
    let inputs_named = features(task, model.as_ref(), &inputs, plan.recipe.input_range)?;
    let recipe = match plan.method.lstm_layers() {
        0 => plan.recipe.clone(),
        _ => plan.recipe.clone().recurrent(),
    };
    let options = TrainingOptions {
        goals: plan.goals,
        inputs: inputs.into(),
        count: recipe.environments,
        curriculum: recipe.curriculum,
        episode_cap: recipe.episode_cap,
        shield: plan.shield.filter(|_| recipe.shielded),
        seed: stream(seed, "environments"),
    };
    let mut environments = SurrogateEnvironments::new(Arc::clone(task), model, options);
    let settings = Settings {
        recipe,
        layers: task.policy.layers.clone(),
        scaling: scaling(&inputs_named),
        discount: task.reward.discount as f32,
        seed,
        unit: pubs_train::VectorUnit::best(),
    };
    let network = |lstm: Vec<LstmLayer>, layers: Vec<DenseLayer>| Network {
        inputs: inputs_named.clone(),
        lstm: lstm.into_iter().map(cell).collect(),
        layers: layers.into_iter().map(dense).collect(),
    };
    let lstm = Lstm {
        layers: plan.method.lstm_layers(),
        width: LSTM_WIDTH,
    };
    if lstm.layers == 0 {
        let trained = pubs_train::train(&mut environments, &settings, report)?;
        return Ok(TrainedSeed {
            network: network(Vec::new(), trained.policy.layers()),
            progress: trained.progress,
            curve: trained.curve,
            learning_s: trained.learning_s,
        });
    }
    let trained = pubs_train::train_recurrent(&mut environments, &settings, lstm, report)?;
    Ok(TrainedSeed {
        network: network(trained.policy.lstm_layers(), trained.policy.dense_layers()),
        progress: trained.progress,
        curve: trained.curve,
        learning_s: trained.learning_s,
    })
}

fn dense(layer: DenseLayer) -> Dense {
    Dense {
        inputs: layer.inputs,
        outputs: layer.outputs,
        weights: layer.weights,
        bias: layer.bias,
    }
}

fn cell(layer: LstmLayer) -> LstmCell {
    LstmCell {
        inputs: layer.inputs,
        width: layer.width,
        weights_input: layer.weights_input,
        weights_hidden: layer.weights_hidden,
        bias: layer.bias,
    }
}
