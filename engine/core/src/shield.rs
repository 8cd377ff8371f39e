//! The shield: high-force actions are masked where the belief, made flatter, sees a limit near.

use crate::belief::Filter;
use crate::task::Task;

/// `shield = { mass, flattening }`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shield {
    /// δ: an action is masked above this much mass.
    pub mass: f64,
    /// τ: the mass is counted with weights^τ, normalised, so that a filter that is wrongly sure of
    /// itself still leaves some mass elsewhere.
    pub flattening: f64,
}

/// Which actions the shield allows, by index. Stop and safe actions always are; a high-force
/// action is not where more than `mass` of the flattened belief lies within its Δs of the limit
/// it moves towards.
pub fn allowed(shield: Option<&Shield>, task: &Task, belief: &Filter, allowed: &mut [bool]) {
    allowed.fill(true);
    let Some(shield) = shield else { return };
    for (action, allowed) in task.actions.iter().zip(allowed) {
        if !action.is_high_force() {
            continue;
        }
        let displacement = action.displacement();
        let mass = if displacement > 0.0 {
            belief.flattened_mass_above(task.joint.upper - displacement, shield.flattening)
        } else {
            belief.flattened_mass_below(task.joint.lower - displacement, shield.flattening)
        };
        *allowed = mass <= shield.mass;
    }
}
