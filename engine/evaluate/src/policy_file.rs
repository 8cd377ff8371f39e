//! A trained policy as a file: its network, its contract, and what an object asks of one.

use std::path::Path;

use pubs_core::Task;
use pubs_policy::{
    Contract, Existing, Expected, ExportError, Feature, Method, Network, PolicyFile, Runtime,
};
use pubs_train::surrogate::Goals;
use serde_json::Value;

use crate::candidates::TrainingPlan;
use crate::training::TrainedSeed;

/// Inputs on which the written file is compared with the trainer's network.
const PROBES: usize = 1000;
/// Of them, in the case of a recurrent network, so many are the steps of one episode.
const PROBED_STEPS: usize = 50;

/// What of `task` a policy of this method was trained for.
pub(crate) fn ingredients_for(task: &Task, method: Method) -> Value {
    if method.has_belief() {
        task.policy_ingredients()
    } else {
        task.raw_policy_ingredients()
    }
}

/// What `task` asks of a policy of this method, for this goal state or for any.
pub fn expected_of(task: &Task, method: Method, goal: Option<f64>) -> Expected {
    Expected {
        task: ingredients_for(task, method),
        observation_hash: task.observation_hash(),
        actions: task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect(),
        goal,
    }
}

/// The contract of a policy that `plan` trained on `task`.
pub(crate) fn contract_of(
    task: &Task,
    plan: &TrainingPlan,
    seed: u64,
    evaluation_reward: f64,
    trained: &TrainedSeed,
) -> Contract {
    let ingredients = ingredients_for(task, plan.method);
    Contract {
        format_version: trained.network.format_version(),
        object: task.name.clone(),
        task_hash: pubs_policy::task_hash(&ingredients),
        task: pubs_policy::canonical_json(&ingredients),
        observation_hash: task.observation_hash(),
        goal: match plan.goals {
            Goals::Every => pubs_policy::Goal::Every,
            Goals::One(value) => pubs_policy::Goal::Fixed {
                value,
                fraction: (value - task.joint.lower) / task.joint.range(),
            },
        },
        tolerance: task.reward.goal_tolerance,
        inputs: trained.network.inputs.clone(),
        actions: task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect(),
        shield: plan.shield.map(|shield| pubs_policy::Shield {
            mass: shield.mass,
            flattening: shield.flattening,
        }),
        discount: task.reward.discount,
        policy_rate_hz: task.policy.rate_hz,
        seed,
        steps: trained.progress.steps as u64,
        recipe: plan.recipe.name.to_owned(),
        evaluation_reward,
        engine_version: env!("CARGO_PKG_VERSION").to_owned(),
        method: plan.method,
        state: trained.network.state(),
    }
}

/// Writes the file and proves that it computes what was trained.
pub(crate) fn write(
    trained: &TrainedSeed,
    contract: &Contract,
    path: &Path,
    existing: Existing,
    runtime: &Runtime,
) -> Result<PolicyFile, ExportError> {
    let network = &trained.network;
    let inputs = probes(&network.inputs);
    let steps = match network.state_width() {
        0 => 1,
        _ => PROBED_STEPS,
    };
    let logits = logits_of(network, &inputs, steps);
    let reference = pubs_policy::Reference {
        inputs: &inputs,
        logits: &logits,
        steps,
    };
    pubs_policy::write(path, network, contract, reference, runtime, existing)
}

/// The network's own logits, `[row][actions]`, for episodes of so many steps.
fn logits_of(network: &Network, inputs: &[f32], steps: usize) -> Vec<f32> {
    let (width, actions) = (network.inputs.len(), network.actions());
    let mut logits = vec![0.0; inputs.len() / width * actions];
    let mut state = vec![0.0; network.state_width()];
    let rows = inputs
        .chunks_exact(width)
        .zip(logits.chunks_exact_mut(actions));
    for (step, (row, out)) in rows.enumerate() {
        if step % steps == 0 {
            state.fill(0.0);
        }
        network.forward_with_state(row, &mut state, out);
    }
    logits
}

/// Inputs spread over their ranges (additive recurrences of the generalised golden ratio, which
/// fill a cube evenly; Roberts, 2018).
fn probes(inputs: &[Feature]) -> Vec<f32> {
    let dimensions = inputs.len() as i32;
    // The positive root of x^(d+1) = x + 1.
    let root = (0..64).fold(2.0_f64, |x, _| {
        (1.0 + x).powf(1.0 / f64::from(dimensions + 1))
    });
    let row = |index: usize| {
        (1..).zip(inputs).map(move |(dimension, input)| {
            let share = (index as f64 * root.powi(-dimension)).fract();
            (input.lower + share * (input.upper - input.lower)) as f32
        })
    };
    (0..PROBES).flat_map(row).collect()
}
