//! Made-up cells, in a folder that goes with the test.

#![allow(clippy::unwrap_used, dead_code)]

use std::collections::BTreeMap;
use std::path::Path;

use pubs_evaluate::reproduce::CELLS;
use pubs_evaluate::reproduce::cell::{
    ArmTrial, Cell, CellResult, EntropyInput, Figures, GoalName, Judged, Method, Outcome,
    SolverMethod, Unit,
};

pub fn figures(discounted: f64, se: f64, safety_violations: u64) -> Figures {
    Figures {
        trials: 10_000,
        mean_reward: 100.0 * discounted,
        mean_reward_se: 100.0 * se,
        mean_discounted_reward: discounted,
        mean_discounted_reward_se: se,
        success_rate: 0.9,
        safety_violations,
        time_outs: 0,
        failed_stops: 1000 - safety_violations.min(1000),
        mean_goal_error: Some(0.01),
        mean_steps: 40.0,
        coverage_90: Some(0.93),
    }
}

pub fn training(task: &str, goal: GoalName, method: Method, seed: u64) -> Unit {
    let entropy = match method {
        Method::Pubs => EntropyInput::Belief,
        _ => EntropyInput::None,
    };
    varied(task, goal, method, entropy, None, seed)
}

pub fn varied(
    task: &str,
    goal: GoalName,
    method: Method,
    entropy: EntropyInput,
    belief_frequency: Option<u32>,
    seed: u64,
) -> Unit {
    Unit::Training {
        task: task.to_owned(),
        goal,
        method,
        entropy,
        belief_frequency,
        shielded: task == "sim_object",
        seed,
    }
}

/// The same training with the shield in it.
pub fn under_shield(mut unit: Unit) -> Unit {
    if let Unit::Training { shielded, .. } = &mut unit {
        *shielded = true;
    }
    unit
}

/// Mean reward on the trials of the selection and on fresh ones, and violations on both.
pub fn trained(selection: f64, fresh: f64, se: f64, violations: u64, shield: bool) -> CellResult {
    let judged = |mean: f64| Judged {
        plain: figures(mean, se, violations),
        shielded: shield.then(|| figures(mean + 0.01, se, 0)),
    };
    CellResult::Training {
        policy: "policy.onnx".to_owned(),
        policy_sha256: String::new(),
        recipe: "defaults".to_owned(),
        steps: 500_000,
        training_s: 100.0,
        selection: judged(selection),
        fresh: judged(fresh),
    }
}

pub fn solver(task: &str, method: SolverMethod) -> Unit {
    Unit::Solver {
        task: task.to_owned(),
        method,
        timeout_s: 60.0,
        belief_frequency: None,
    }
}

pub fn solved(reward: f64) -> CellResult {
    CellResult::Solver {
        lower: 67.0,
        upper: 89.5,
        alpha_vectors: 1303,
        solve_s: 60.0,
        policy: "policy.alpha".to_owned(),
        evaluation: figures(reward, 0.001, 0),
    }
}

pub fn arm(task: &str, drift: bool) -> Unit {
    Unit::Arm {
        task: task.to_owned(),
        trials: 4,
        drift,
    }
}

/// A trial with the goal at 0.5.
pub fn arm_trial(outcome: Outcome, start: f64, goal_error: f64, time_s: f64) -> ArmTrial {
    ArmTrial {
        seed: 1,
        start,
        goal: 0.5,
        outcome,
        goal_error: Some(goal_error),
        time_s,
        safety_violations: u64::from(outcome == Outcome::SafetyStop),
        world: BTreeMap::from([("friction".to_owned(), 1.1)]),
    }
}

pub fn store(folder: &Path, unit: Unit, result: CellResult) {
    let cell = Cell {
        engine_version: "0.1.0".to_owned(),
        vector_unit: "avx2".to_owned(),
        task_hash: "0123456789abcdef".to_owned(),
        filter_hash: None,
        shield_hash: None,
        made_at: "2026-01-02T03:04:05Z".to_owned(),
        time_s: 120.0,
        without_policy: false,
        unit,
        result,
    };
    let cells = folder.join(CELLS);
    std::fs::create_dir_all(&cells).unwrap();
    let file = cells.join(format!("{}.json", cell.unit.id()));
    std::fs::write(file, serde_json::to_string_pretty(&cell).unwrap()).unwrap();
}
