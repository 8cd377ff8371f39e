//! A trained policy as a file: its network, its contract, and what an object asks of one.

use std::path::Path;

use pubs_core::Task;
use pubs_policy::{Contract, Existing, Expected, ExportError, Feature, PolicyFile, Runtime};
use pubs_train::surrogate::Goals;

use crate::candidates::TrainingPlan;
use crate::training::TrainedSeed;

/// Inputs on which the written file is compared with the trainer's network.
const PROBES: usize = 1000;

/// What `task` asks of a policy, for this goal state or for any.
pub fn expected_of(task: &Task, goal: Option<f64>) -> Expected {
    Expected {
        task: task.policy_ingredients(),
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
    let ingredients = task.policy_ingredients();
    Contract {
        format_version: pubs_policy::FORMAT_VERSION,
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
    let mut logits = vec![0.0; PROBES * network.actions()];
    network.forward(&inputs, &mut logits);
    let reference = pubs_policy::Reference {
        inputs: &inputs,
        logits: &logits,
    };
    pubs_policy::write(path, network, contract, reference, runtime, existing)
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
