//! Proximal policy optimisation, top to bottom.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use pubs_core::vector::VectorUnit;
use rand::seq::SliceRandom;

use crate::agent::{Agent, Update};
use crate::environment::Environments;
use crate::error::TrainError;
use crate::learner::{Learner, Trainee};
use crate::network::{DenseLayer, Network};
use crate::policy::Policy;
use crate::progress::{Episodes, Progress};
use crate::recipe::Recipe;
use crate::rng::{Generator, stream};
use crate::rollout::{Collector, Rollout};
use crate::scaling::InputScaling;

/// Gains of the last layers: a policy that starts nearly uniform, values of the usual size.
pub(crate) const POLICY_GAIN: f64 = 0.01;
pub(crate) const VALUE_GAIN: f64 = 1.0;

/// Least time between two calls of the progress callback.
const REPORT_EVERY: Duration = Duration::from_millis(250);

/// Points of a learning curve, at most about.
const CURVE_POINTS: usize = 200;

/// What to train, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// PPO's own settings.
    pub recipe: Recipe,
    /// Widths of the hidden layers, of the policy and of the value network alike.
    pub layers: Vec<usize>,
    /// How observations are scaled.
    pub scaling: InputScaling,
    /// Discount γ per step, of the task.
    pub discount: f32,
    /// Seed of the first weights, the drawn actions and the minibatches.
    pub seed: u64,
    /// Vector unit to use.
    pub unit: VectorUnit,
}

/// What training gives.
#[derive(Debug)]
pub struct Trained {
    /// The policy, with its scaling.
    pub policy: Policy,
    /// The value network's layers; they expect scaled inputs.
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

/// Trains a policy. `report` is called a few times per second and at the end, and may cancel.
///
/// # Errors
/// Where the settings are out of range or do not fit the environments, an environment fails, the
/// numbers diverge, or `report` breaks.
pub fn train<E: Environments>(
    environments: &mut E,
    settings: &Settings,
    report: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Trained, TrainError<E::Error>> {
    check(environments, settings)?;
    let mut learner = new_learner(environments, settings);
    let run = run(environments, settings, &mut learner, report)?;
    Ok(Trained {
        value: learner.value.network.export(),
        policy: Policy::new(learner.policy.network, settings.scaling.clone()),
        progress: run.progress,
        curve: run.curve,
        rollout_s: run.rollout_s,
        learning_s: run.learning_s,
        unit: settings.unit,
    })
}

/// How a training went.
pub(crate) struct Run {
    pub(crate) progress: Progress,
    pub(crate) curve: Vec<Progress>,
    pub(crate) rollout_s: f64,
    pub(crate) learning_s: f64,
}

/// Trains an agent with settings that were [`check`]ed.
pub(crate) fn run<E: Environments>(
    environments: &mut E,
    settings: &Settings,
    agent: &mut impl Agent,
    mut report: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Run, TrainError<E::Error>> {
    let recipe = &settings.recipe;
    let mut action_generator = stream(settings.seed, "actions");
    let mut minibatch_generator = stream(settings.seed, "minibatches");
    let mut rollout = Rollout::new(environments, recipe.rollout);
    let sequences = rollout.samples() / agent.sequence(recipe);
    let mut order: Vec<u32> = (0..sequences as u32).collect();
    let mut episodes = Episodes::new(environments.count());
    let total_steps = recipe.updates() * rollout.samples();
    let start = Instant::now();
    let mut last_report = start;
    let mut learning = Duration::ZERO;
    let updates_per_point = recipe.updates().div_ceil(CURVE_POINTS);
    let mut curve = Vec::new();

    for update in 0..recipe.updates() {
        let steps = update * rollout.samples();
        let collector = Collector {
            unit: settings.unit,
            actor: agent.actor(),
            scaling: &settings.scaling,
            generator: &mut action_generator,
            episodes: &mut episodes,
            steps,
        };
        rollout.collect(environments, collector)?;
        let steps = steps + rollout.samples();

        let learning_start = Instant::now();
        agent.estimate(&mut rollout, settings.discount, recipe.gae_lambda);
        let numbers = Update::at(recipe, update as f32 / recipe.updates() as f32);
        learn(
            agent,
            &rollout,
            &mut order,
            recipe,
            numbers,
            &mut minibatch_generator,
        )
        .map_err(|norm| TrainError::Diverged { steps, norm })?;
        learning += learning_start.elapsed();

        let last = steps == total_steps;
        if last || (update + 1) % updates_per_point == 0 {
            curve.push(episodes.progress(steps, total_steps, start.elapsed().as_secs_f64()));
        }
        if last || last_report.elapsed() >= REPORT_EVERY {
            last_report = Instant::now();
            let progress = episodes.progress(steps, total_steps, start.elapsed().as_secs_f64());
            if report(&progress).is_break() {
                return Err(TrainError::Cancelled { steps });
            }
        }
    }

    let time_s = start.elapsed().as_secs_f64();
    let learning_s = learning.as_secs_f64();
    Ok(Run {
        progress: episodes.progress(total_steps, total_steps, time_s),
        curve,
        rollout_s: time_s - learning_s,
        learning_s,
    })
}

/// Goes over a rollout `epochs` times in random minibatches; an error is the length of a gradient
/// that is not finite.
fn learn(
    agent: &mut impl Agent,
    rollout: &Rollout,
    order: &mut [u32],
    recipe: &Recipe,
    update: Update,
    generator: &mut Generator,
) -> Result<(), f32> {
    let sequences = recipe.sequences(agent.sequence(recipe));
    for _ in 0..recipe.epochs {
        order.shuffle(generator);
        for minibatch in order.chunks(sequences) {
            agent.step(rollout, minibatch, update)?;
        }
    }
    Ok(())
}

fn new_learner(environments: &impl Environments, settings: &Settings) -> Learner {
    let network = |name: &str, outputs: usize, gain: f64| {
        let widths = widths(environments.features(), settings, outputs);
        let mut generator = stream(settings.seed, name);
        let network = Network::new(settings.unit, &widths, gain, &mut generator);
        Trainee::new(network, settings.recipe.adam_epsilon)
    };
    let policy = network("policy weights", environments.actions(), POLICY_GAIN);
    let value = network("value weights", 1, VALUE_GAIN);
    Learner::new(settings.unit, policy, value)
}

/// Widths of a perceptron from its inputs to its outputs.
pub(crate) fn widths(inputs: usize, settings: &Settings, outputs: usize) -> Vec<usize> {
    let hidden = settings.layers.iter().copied();
    [inputs]
        .into_iter()
        .chain(hidden)
        .chain([outputs])
        .collect()
}

/// Refuses settings that cannot train anything, or not on these environments.
pub(crate) fn check<E: Environments>(
    environments: &E,
    settings: &Settings,
) -> Result<(), TrainError<E::Error>> {
    let Settings {
        recipe,
        layers,
        scaling,
        discount,
        ..
    } = settings;
    let fault = recipe.fault().or_else(|| match discount {
        _ if layers.is_empty() => Some("there is no hidden layer".to_owned()),
        _ if layers.contains(&0) => Some("a hidden layer has width 0".to_owned()),
        discount if (0.0..=1.0).contains(discount) => None,
        discount => Some(format!("the discount is {discount} and must lie in [0, 1]")),
    });
    if let Some(fault) = fault {
        return Err(TrainError::Settings(fault));
    }
    let pairs = [
        ("environments", environments.count(), recipe.environments),
        (
            "features scaled by an offset",
            environments.features(),
            scaling.offset.len(),
        ),
        (
            "features scaled by a factor",
            environments.features(),
            scaling.scale.len(),
        ),
    ];
    for (what, found, expected) in pairs {
        if found != expected {
            let fault = format!("{what}: the task has {found}, the settings say {expected}");
            return Err(TrainError::Mismatch(fault));
        }
    }
    if environments.features() == 0 || environments.actions() < 2 {
        let fault = "a task needs at least one feature and two actions".to_owned();
        return Err(TrainError::Mismatch(fault));
    }
    Ok(())
}
