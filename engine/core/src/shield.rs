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

/// How far the handle may be ahead of a belief that is sure (rad, m or plain; 0 for abstract
/// joints). The belief that a policy acts on is up to two filter periods old. And it takes the tool
/// for the handle: after a press against a limit, up to the force threshold, the handle stays
/// nearer to that limit than the tool's way back says, by the give of grasp and stop.
pub fn margin(task: &Task) -> f64 {
    task.control.map_or(0.0, |control| {
        let behind_m = control.high_speed_m_s * 2.0 / task.belief.rate_hz;
        let give_m = control.force_threshold_n / control.contact_stiffness_n_per_m;
        (behind_m + give_m) * task.joint.per_metre()
    })
}

/// Which actions the shield allows, by index. Stop and safe actions always are; a high-force
/// action is not where more than `mass` of the flattened belief lies within its Δs and the
/// [`margin`] of the limit it moves towards.
pub fn allowed(shield: Option<&Shield>, task: &Task, belief: &Filter, allowed: &mut [bool]) {
    allowed.fill(true);
    let Some(shield) = shield else { return };
    let margin = margin(task);
    for (action, allowed) in task.actions.iter().zip(allowed) {
        if !action.is_high_force() {
            continue;
        }
        let displacement = action.displacement();
        let mass = if displacement > 0.0 {
            let from = task.joint.upper - displacement - margin;
            belief.flattened_mass_above(from, shield.flattening)
        } else {
            let to = task.joint.lower - displacement + margin;
            belief.flattened_mass_below(to, shield.flattening)
        };
        *allowed = mass <= shield.mass;
    }
}
