//! What a policy does over mean and entropy, Fig. 5, asked of its file.

use pubs_core::{Joint, JointKind};
use pubs_policy::{FeatureName, PolicyFile, choose};

use super::cell::GoalName;
use super::heatmap::Heatmap;
use super::run_training::goal_state;
use super::workshop::{Prepared, Workshop, WorkshopError};

/// Cells of the picture.
const COLUMNS: usize = 121;
const ROWS: usize = 61;

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
    let share = |index: usize, count: usize| index as f64 / (count - 1) as f64;
    let mean: Vec<f64> = (0..COLUMNS)
        .map(|column| joint.at_fraction(share(column, COLUMNS)))
        .collect();
    let entropy: Vec<f64> = (0..ROWS).map(|row| share(row, ROWS)).collect();
    let inputs: Vec<f32> = entropy
        .iter()
        .flat_map(|&entropy| {
            mean.iter()
                .flat_map(move |&mean| [mean as f32, entropy as f32])
        })
        .collect();
    let mut policy = file.open(workshop.runtime).map_err(WorkshopError::of)?;
    let mut logits = Vec::new();
    policy
        .logits(&inputs, COLUMNS * ROWS, &mut logits)
        .map_err(WorkshopError::of)?;
    let chosen: Vec<usize> = logits
        .chunks_exact(task.actions.len())
        .map(|logits| choose(logits, task.stop, |_| true))
        .collect();
    let (unit, factor) = shown_unit(joint);
    let title = match goal {
        GoalName::Own => task.name.clone(),
        goal => format!("{}, {}", task.name, goal.name()),
    };
    Ok(Heatmap {
        task: task.name.clone(),
        title,
        unit: unit.to_owned(),
        mean: mean.iter().map(|state| state * factor).collect(),
        entropy,
        action: chosen
            .chunks_exact(COLUMNS)
            .map(<[usize]>::to_vec)
            .collect(),
        actions: task
            .actions
            .iter()
            .map(|action| action.name.clone())
            .collect(),
        goal: goal_state * factor,
    })
}

/// The unit in which a person reads a state, and how many of them are in one of SI.
fn shown_unit(joint: &Joint) -> (&'static str, f64) {
    match joint.kind {
        JointKind::Revolute { .. } => ("deg", 1_f64.to_degrees()),
        JointKind::Prismatic { .. } => ("cm", 100.0),
        JointKind::Abstract { .. } => ("", 1.0),
    }
}
