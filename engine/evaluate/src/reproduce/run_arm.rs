//! A cell of Table IV: trials through the whole run loop on the virtual arm, §IV-E.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pubs_core::seed::stream;
use pubs_policy::PolicyFile;
use pubs_run::{Actor, GoalPlan, RunOptions, RunReport};
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::{Map, Value, json};

use super::cell::{ArmTrial, CellResult, GoalName};
use super::run_training::goal_state;
use super::workshop::{Prepared, Workshop, WorkshopError};

/// Friction, catch and seal of a trial are those of the world times a factor of this range.
const VARIED: std::ops::Range<f64> = 0.8..1.2;

/// What the sensor has drifted by at the last trial, N; it grows evenly from trial to trial, in a
/// direction of its own for each object.
pub const DRIFT_N: f64 = 2.5;

/// Runs `trials` trials with the given policy to the middle goal.
///
/// # Errors
/// In words, where a run cannot begin.
pub fn run(
    workshop: &Workshop<'_>,
    prepared: &Prepared,
    policy: &PolicyFile,
    trials: u64,
    drift: bool,
) -> Result<CellResult, WorkshopError> {
    let drift_n = if drift { DRIFT_N } else { 0.0 };
    let direction = direction(&prepared.task.name);
    let trials = (0..trials)
        .map(|index| {
            let grown_n = drift_n * (index + 1) as f64 / trials as f64;
            let offset_n = direction.map(|component| component * grown_n);
            trial(workshop, prepared, policy, index, offset_n)
        })
        .collect::<Result<_, _>>()?;
    Ok(CellResult::Arm {
        policy_sha256: policy.sha256().to_owned(),
        trials,
    })
}

fn trial(
    workshop: &Workshop<'_>,
    prepared: &Prepared,
    policy: &PolicyFile,
    index: u64,
    offset_n: [f64; 3],
) -> Result<ArmTrial, WorkshopError> {
    let (task, goal) = (&prepared.task, goal_state(prepared, GoalName::Middle)?);
    let seed = index + 1;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(stream(seed, "arm trials"));
    let start: f64 = rng.random();
    let world: BTreeMap<String, f64> = ["friction_scale", "catch_scale"]
        .map(|name| (name.to_owned(), rng.random_range(VARIED)))
        .into();
    let mut params: Map<String, Value> = world
        .iter()
        .map(|(name, factor)| (name.clone(), json!(factor)))
        .collect();
    params.insert("start".to_owned(), json!(start));
    params.insert("sensor_offset_n".to_owned(), json!(offset_n));
    let arm = workshop.arm(task, &params, seed)?;
    let actor = Actor::open(policy, workshop.runtime, prepared.model.as_ref())
        .map_err(WorkshopError::of)?;
    let options = RunOptions {
        goals: vec![GoalPlan {
            state: goal,
            policy: 0,
        }],
        shield: Some(task.policy.shield),
        max_steps: workshop.max_steps,
        lockstep: true,
        seed,
        policy: policy.path().display().to_string(),
        interrupt: Arc::new(AtomicBool::new(false)),
    };
    let model = Arc::clone(&prepared.model);
    let report = pubs_run::run(
        task,
        Box::new(arm),
        model,
        vec![actor],
        &options,
        &mut |_| {},
    )
    .map_err(WorkshopError::of)?;
    Ok(told(&report, seed, task.joint.at_fraction(start), world))
}

fn told(report: &RunReport, seed: u64, start: f64, world: BTreeMap<String, f64>) -> ArmTrial {
    ArmTrial {
        seed,
        start,
        goal: report.goal,
        outcome: report.outcome,
        goal_error: report.goal_error,
        time_s: report.goals.last().map_or(0.0, |goal| goal.time_s),
        safety_violations: report.safety_violations.map_or(0, u64::from),
        world,
    }
}

/// A unit vector, drawn once for each object.
fn direction(object: &str) -> [f64; 3] {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(stream(0, object));
    let drawn: [f64; 3] = std::array::from_fn(|_| normal(&mut rng));
    let length = drawn.iter().map(|part| part * part).sum::<f64>().sqrt();
    drawn.map(|part| part / length)
}

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}
