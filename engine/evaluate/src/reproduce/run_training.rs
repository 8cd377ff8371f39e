//! A cell of training: one seed, trained and judged.

use std::ops::ControlFlow;

use pubs_core::seed::stream;
use pubs_core::shield::Shield;
use pubs_policy::{Existing, PolicyFile};
use pubs_train::surrogate::Goals;
use pubs_train::{Progress, Recipe};

use super::cell::{CellResult, GoalName, Judged, Method, Unit};
use super::seeds::Training;
use super::workshop::{Prepared, Workshop, WorkshopError};
use crate::candidates::TrainingPlan;
use crate::evaluation::{EvaluationOptions, GoalChoice, NetworkContestant, evaluate};
use crate::policy_file::{contract_of, write};
use crate::training::train_seed;

/// Trains with one seed, writes the policy as `<id>.onnx` and judges it on two sets of trials.
///
/// # Errors
/// In words, where something fails or `report` breaks.
pub fn train(
    workshop: &Workshop<'_>,
    prepared: &Prepared,
    training: Training<'_>,
    seed: u64,
    report: &dyn Fn(&Progress) -> ControlFlow<()>,
) -> Result<CellResult, WorkshopError> {
    let Prepared { task, model } = prepared;
    let goal = goal_state(prepared, training.goal)?;
    let mut recipe = Recipe::usual(task, training.method.has_belief());
    recipe.steps = workshop.steps.unwrap_or(recipe.steps);
    recipe.shielded = training.shielded;
    let plan = TrainingPlan {
        method: training.method,
        entropy: training.entropy,
        recipe,
        goals: Goals::One(goal),
        seeds: vec![seed],
        trials: workshop.trials,
        max_steps: workshop.max_steps,
        shield: shield_of(prepared, training.method),
        threads: Some(1),
    };
    let trained = train_seed(task, model, &plan, seed, report).map_err(WorkshopError::of)?;
    let name = policy_file(&training.unit(seed));
    let path = workshop.policy(&name);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(WorkshopError::of)?;
    }
    let store = |reward: f64| {
        let contract = contract_of(task, &plan, seed, reward, &trained);
        let (replace, runtime) = (Existing::Replace, workshop.runtime);
        write(&trained, &contract, &path, replace, runtime).map_err(WorkshopError::of)
    };
    // The reward goes into the contract, and the file is needed to find it.
    let draft = store(0.0)?;
    let judge = |trials| judge(workshop, prepared, &draft, goal, plan.shield, trials);
    let (selection, fresh) = (judge("selection")?, judge("report")?);
    let written = store(fresh.plain.mean_reward)?;
    Ok(CellResult::Training {
        policy: name,
        policy_sha256: written.sha256().to_owned(),
        recipe: plan.recipe.name.to_owned(),
        steps: trained.progress.steps as u64,
        training_s: trained.progress.time_s,
        selection,
        fresh,
    })
}

/// Name of the policy file of a training.
pub fn policy_file(unit: &Unit) -> String {
    format!("{}.onnx", unit.id())
}

/// The goal as a state (rad, m or plain).
///
/// # Errors
/// Where the object's own goal is asked for and it has none.
pub fn goal_state(prepared: &Prepared, goal: GoalName) -> Result<f64, WorkshopError> {
    let task = &prepared.task;
    match goal {
        GoalName::Open => Ok(task.joint.upper),
        GoalName::Middle => Ok(task.joint.at_fraction(0.5)),
        GoalName::Closed => Ok(task.joint.lower),
        GoalName::Own => task
            .default_goal
            .ok_or_else(|| WorkshopError(format!("object `{}` has no goal of its own", task.name))),
    }
}

/// The object's shield where a policy of this method can have one: it looks at the belief, and
/// masks high-force actions.
fn shield_of(prepared: &Prepared, method: Method) -> Option<Shield> {
    let task = &prepared.task;
    let masks = task.actions.iter().any(|action| action.is_high_force());
    (method.has_belief() && masks).then_some(task.policy.shield)
}

fn judge(
    workshop: &Workshop<'_>,
    prepared: &Prepared,
    file: &PolicyFile,
    goal: f64,
    shield: Option<Shield>,
    trials: &str,
) -> Result<Judged, WorkshopError> {
    let contestant = NetworkContestant {
        file,
        runtime: workshop.runtime,
    };
    let figures = |shield| {
        let options = EvaluationOptions {
            trials: workshop.trials,
            goal: GoalChoice::One(goal),
            max_steps: workshop.max_steps,
            shield,
            seed: stream(0, trials),
            threads: Some(1),
        };
        evaluate(&prepared.task, &prepared.model, &contestant, &options)
            .map(|evaluation| evaluation.figures)
            .map_err(WorkshopError::of)
    };
    Ok(Judged {
        plain: figures(None)?,
        shielded: shield.map(|shield| figures(Some(shield))).transpose()?,
    })
}
