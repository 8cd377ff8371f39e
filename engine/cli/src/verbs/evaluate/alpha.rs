//! Alpha vectors that were solved from an object, judged on trials of the object itself.

use std::path::Path;

use pubs_evaluate::grid::{Grid, GridOrigin};
use pubs_evaluate::trial::goal_label;
use pubs_evaluate::{AlphaContestant, evaluate};
use pubs_solve::AlphaPolicy;

use super::{Arguments, Report, has_end, parse_goal};
use crate::failure::{Failure, chain};
use crate::object::Ready;

/// What a policy of alpha vectors was solved from; `None` for another kind of policy.
///
/// # Errors
/// Where the file cannot be read, or was not solved from an object.
pub(super) fn solved_from(path: &Path) -> Result<Option<GridOrigin>, Failure> {
    if !has_end(path, "json") {
        return Ok(None);
    }
    origin(path, &read(path)?).map(Some)
}

fn origin(path: &Path, policy: &AlphaPolicy) -> Result<GridOrigin, Failure> {
    GridOrigin::of(policy.origin()).ok_or_else(|| {
        Failure::invalid(format!(
            "{} was solved from the problem `{}`, not from an object: add --object {}.pomdp",
            path.display(),
            policy.problem(),
            policy.problem()
        ))
    })
}

/// A policy of alpha vectors.
///
/// # Errors
/// Where the file holds something else.
pub(super) fn read(path: &Path) -> Result<AlphaPolicy, Failure> {
    AlphaPolicy::read(path).map_err(|error| Failure::incompatible(chain(&error)))
}

/// The figures of one policy. The grid is made again, and must be the one that was solved.
pub(super) fn judge(arguments: &Arguments, path: &Path, ready: &Ready) -> Result<Report, Failure> {
    let policy = read(path)?;
    let (task, model) = (&ready.task, &ready.model);
    let origin = origin(path, &policy)?;
    if let Some(text) = &arguments.goal
        && parse_goal(text, &task.joint)? != origin.goal
    {
        return Err(Failure::invalid(format!(
            "{} was solved for the goal {}; leave out --goal, or solve for the other one",
            path.display(),
            task.joint.display(origin.goal)
        )));
    }
    let grid = Grid::new(task, model.as_ref(), origin.goal, origin.grid)
        .map_err(|error| Failure::invalid(error.to_string()))?;
    policy.check_problem(&grid.pomdp).map_err(|_| {
        Failure::incompatible(format!(
            "{} was solved for another {} ({}); solve it again",
            path.display(),
            origin.object,
            origin.grid
        ))
    })?;
    let contestant = AlphaContestant {
        policy: &policy,
        grid: &grid,
    };
    let options = arguments.trials_of(Some(origin.goal));
    let evaluation =
        evaluate(task, model, &contestant, &options).map_err(|error| Failure::fault(&error))?;
    Ok(Report {
        policy: path.to_owned(),
        object: task.name.clone(),
        unit: task.joint.unit(),
        goal: goal_label(&task.joint, Some(origin.goal)),
        shield: false,
        seed: arguments.seed,
        evaluation,
        runtime: None,
    })
}
