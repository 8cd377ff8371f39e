//! A cell of an offline solver: solved on a grid, judged on trials of the object itself.

use std::ops::ControlFlow;
use std::time::Duration;

use pubs_core::seed::stream;
use pubs_solve::{Method, SolveOptions, solve as solve_pomdp};

use super::cell::{CellResult, GoalName, SolverMethod};
use super::run_training::goal_state;
use super::workshop::{Prepared, Workshop, WorkshopError};
use crate::alpha_decider::AlphaContestant;
use crate::evaluation::{EvaluationOptions, GoalChoice, evaluate};
use crate::grid::{Grid, GridOptions, GridOrigin};

/// The gap at which a solver is done before its time, in units of reward.
const PRECISION: f64 = 1e-3;

/// Solves and judges; `report` hears the share of the time that has passed and may cancel.
///
/// # Errors
/// In words.
pub fn solve(
    workshop: &Workshop<'_>,
    prepared: &Prepared,
    id: &str,
    method: SolverMethod,
    timeout_s: f64,
    belief_frequency: Option<u32>,
    report: &dyn Fn(f32) -> ControlFlow<()>,
) -> Result<CellResult, WorkshopError> {
    let Prepared { task, model } = prepared;
    let goal = goal_state(prepared, GoalName::Own)?;
    let options = GridOptions::of(task, model.as_ref(), None, None).map_err(WorkshopError::of)?;
    let grid = Grid::new(task, model.as_ref(), goal, options).map_err(WorkshopError::of)?;
    let options = SolveOptions {
        method: match method {
            SolverMethod::Qmdp => Method::Qmdp,
            SolverMethod::Sarsop => Method::Sarsop,
        },
        precision: PRECISION,
        timeout: Some(Duration::from_secs_f64(timeout_s)),
        ..SolveOptions::default()
    };
    let solution = solve_pomdp(&grid.pomdp, &options, |progress| {
        report((progress.time_s / timeout_s) as f32)
    });
    if report(1.0).is_break() {
        return Err(WorkshopError("interrupted".to_owned()));
    }
    let name = format!("{id}.json");
    let path = workshop.policy(&name);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(WorkshopError::of)?;
    }
    let origin = GridOrigin {
        object: task.name.clone(),
        goal,
        grid: grid.options,
        belief_frequency,
    };
    let policy = solution.policy.with_origin(origin.to_value());
    policy.write(&path).map_err(WorkshopError::of)?;
    let contestant = AlphaContestant {
        policy: &policy,
        grid: &grid,
    };
    let options = EvaluationOptions {
        trials: workshop.trials,
        goal: GoalChoice::One(goal),
        max_steps: workshop.max_steps,
        shield: None,
        seed: stream(0, "report"),
        threads: Some(1),
    };
    let evaluation = evaluate(task, model, &contestant, &options).map_err(WorkshopError::of)?;
    Ok(CellResult::Solver {
        lower: solution.lower,
        upper: solution.upper,
        alpha_vectors: policy.alpha_vectors().len() as u64,
        solve_s: solution.time_s,
        policy: name,
        evaluation: evaluation.figures,
    })
}
