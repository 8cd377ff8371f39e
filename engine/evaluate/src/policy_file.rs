//! A trained policy as a file: its network, its contract, and what an object asks of one.

use std::path::Path;

use pubs_core::{Joint, Task};
use pubs_policy::{
    Contract, Dense, Existing, Expected, ExportError, Feature, FeatureName, Method, Network,
    PolicyFile, Runtime,
};
use pubs_train::Trained;
use pubs_train::surrogate::Goals;

use crate::candidates::TrainingPlan;

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
    steps: usize,
    evaluation_reward: f64,
    network: &Network,
) -> Contract {
    let ingredients = task.policy_ingredients();
    Contract {
        format_version: network.format_version(),
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
        inputs: network.inputs.clone(),
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
        steps: steps as u64,
        recipe: plan.recipe.name.to_owned(),
        evaluation_reward,
        engine_version: env!("CARGO_PKG_VERSION").to_owned(),
        method: Method::Pubs,
        state: network.state(),
    }
}

pub(crate) fn network_of(task: &Task, goals: Goals, trained: &Trained) -> Network {
    let joint = &task.joint;
    let (scaling, layers) = (trained.policy.scaling(), trained.policy.layers());
    let names = [
        (
            FeatureName::MeanState,
            joint.unit(),
            joint.lower,
            joint.upper,
        ),
        (FeatureName::Entropy, "1", 0.0, 1.0),
        (
            FeatureName::MeanMinusGoal,
            joint.unit(),
            -joint.range(),
            joint.range(),
        ),
    ];
    let inputs =
        names[..goals.features()]
            .iter()
            .enumerate()
            .map(|(index, (name, unit, lower, upper))| Feature {
                name: name.clone(),
                unit: (*unit).to_owned(),
                lower: *lower,
                upper: *upper,
                offset: f64::from(scaling.offset[index]),
                scale: f64::from(scaling.scale[index]),
            });
    let layers = layers.iter().map(|layer| Dense {
        inputs: layer.inputs,
        outputs: layer.outputs,
        weights: layer.weights.clone(),
        bias: layer.bias.clone(),
    });
    Network {
        inputs: inputs.collect(),
        lstm: Vec::new(),
        layers: layers.collect(),
    }
}

pub(crate) fn write(
    network: &Network,
    contract: &Contract,
    path: &Path,
    existing: Existing,
    runtime: &Runtime,
    joint: &Joint,
) -> Result<PolicyFile, ExportError> {
    let inputs = probes(joint, network.inputs.len());
    let mut logits = vec![0.0; PROBES * network.actions()];
    for (row, out) in inputs
        .chunks_exact(network.inputs.len())
        .zip(logits.chunks_exact_mut(network.actions()))
    {
        network.forward(row, out);
    }
    let reference = pubs_policy::Reference {
        inputs: &inputs,
        logits: &logits,
        steps: 1,
    };
    pubs_policy::write(path, network, contract, reference, runtime, existing)
}

/// Inputs spread over the limits, entropies and goals (additive recurrences of the golden ratio
/// and its kin, which fill a cube evenly).
fn probes(joint: &Joint, features: usize) -> Vec<f32> {
    let share = |index: usize, step: f64| (index as f64 * step).fract();
    (0..PROBES)
        .flat_map(|index| {
            let mean = joint.at_fraction(share(index, 0.819_172_513));
            let goal = joint.at_fraction(share(index, 0.549_700_478));
            [
                mean as f32,
                share(index, 0.671_043_606) as f32,
                (mean - goal) as f32,
            ]
            .into_iter()
            .take(features)
        })
        .collect()
}
