//! What a policy does over mean and entropy, Fig. 5, asked of its file.

use pubs_policy::{FeatureName, PolicyFile};

use super::cell::GoalName;
use super::heatmap::Heatmap;
use super::run_training::goal_state;
use super::workshop::{Prepared, Workshop, WorkshopError};
use crate::asked::Asked;

/// Asks a policy that reads mean and entropy for its action at every point of a grid over the
/// limits and [0, 1]; without a shield, as the paper's figure.
///
/// # Errors
/// In words, where the policy reads something else or fails.
pub fn heatmap(
    workshop: &Workshop<'_>,
    prepared: &Prepared,
    file: &PolicyFile,
    goal: GoalName,
) -> Result<Heatmap, WorkshopError> {
    if file.inputs() != [FeatureName::MeanState, FeatureName::Entropy] {
        let named = file.path().display();
        return Err(WorkshopError(format!(
            "{named} does not read mean and entropy alone"
        )));
    }
    let task = &prepared.task;
    let joint = &task.joint;
    let goal_state = goal_state(prepared, goal)?;
    let mut policy = file.open(workshop.runtime).map_err(WorkshopError::of)?;
    let asked = Asked {
        limits: [joint.lower, joint.upper],
        goal: goal_state,
        stop: task.stop,
    };
    let grid = asked
        .of(&mut policy, file.inputs())
        .map_err(WorkshopError::of)?;
    let (unit, factor) = joint.kind.shown_unit();
    let title = match goal {
        GoalName::Own => task.name.clone(),
        goal => format!("{}, {}", task.name, goal.name()),
    };
    Ok(Heatmap {
        task: task.name.clone(),
        title,
        unit: unit.to_owned(),
        mean: grid.mean.iter().map(|state| state * factor).collect(),
        entropy: grid.entropy,
        action: grid.action,
        actions: task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect(),
        goal: goal_state * factor,
    })
}
