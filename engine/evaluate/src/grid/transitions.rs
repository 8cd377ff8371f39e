//! Where an action leads, as probabilities of the states of a grid.

use pubs_core::Task;

use super::GridError;
use super::observations::Observer;

/// Distribution over `states` after one policy step of a moving action from `state`. Each part of
/// the step moves or is hindered on its own, as in the trainer's simulator; what ends between two
/// states is shared between them.
pub(super) fn moved(
    task: &Task,
    observer: &mut Observer<'_>,
    states: &[f64],
    index: usize,
    state: f64,
) -> Result<Vec<(usize, f64)>, GridError> {
    let action = &task.actions[index];
    let parts = action.observations();
    let part = action.displacement() / f64::from(parts);
    let joint = &task.joint;
    let at = |moved: u32| (state + part * f64::from(moved)).clamp(joint.lower, joint.upper);
    // Probability that so many of the parts have moved.
    let mut moved = vec![1.0];
    for _ in 0..parts {
        let mut next = vec![0.0; moved.len() + 1];
        for (count, probability) in moved.iter().enumerate() {
            let moves = chance_to_move(task, observer, index, at(count as u32))?;
            next[count + 1] += probability * moves;
            next[count] += probability * (1.0 - moves);
        }
        moved = next;
    }
    let mut row = Vec::new();
    for (count, probability) in moved.into_iter().enumerate() {
        if probability > 0.0 {
            share(states, at(count as u32), probability, &mut row);
        }
    }
    Ok(row)
}

/// As m_p is modelled at the state before, or where it is not, as the force there against the safe
/// mode's threshold; off the arm always.
fn chance_to_move(
    task: &Task,
    observer: &mut Observer<'_>,
    index: usize,
    state: f64,
) -> Result<f64, GridError> {
    let Some(control) = task.control else {
        return Ok(1.0);
    };
    observer.ask(index, state, state)?;
    if let Some((probability, _)) = observer.moment("m_p") {
        return Ok(probability.clamp(0.0, 1.0));
    }
    match observer.moment("f_d") {
        Some((mean, sigma)) if !task.actions[index].is_high_force() => {
            let above = (control.force_threshold_n - mean) / (sigma * std::f64::consts::SQRT_2);
            Ok(1.0 - 0.5 * libm::erfc(above))
        }
        _ => Ok(1.0),
    }
}

/// Shares a probability between the two states around a place, by nearness.
fn share(states: &[f64], at: f64, probability: f64, row: &mut Vec<(usize, f64)>) {
    let spacing = states[1] - states[0];
    let place = ((at - states[0]) / spacing).clamp(0.0, (states.len() - 1) as f64);
    let (below, rest) = (place.floor() as usize, place.fract());
    // Rounding must not split what lies on a state.
    if rest < 1e-9 {
        row.push((below, probability));
    } else if rest > 1.0 - 1e-9 {
        row.push((below + 1, probability));
    } else {
        row.push((below, probability * (1.0 - rest)));
        row.push((below + 1, probability * rest));
    }
}
