//! Running cells: some at once, each stored as soon as it is done, none done twice.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use pubs_core::goal::fraction_label;
use pubs_core::shield::{self, Shield};
use pubs_core::vector::VectorUnit;
use pubs_core::{Action, Task};
use pubs_policy::PolicyFile;
use serde_json::{Value, json};

use super::cell::{Cell, CellResult, GoalName, Method, Unit};
use super::heatmap::{PICTURES, heatmap_id};
use super::paper::{GOALS, OBJECTS};
use super::results::{CELLS, HEATMAPS, Results};
use super::run_arm;
use super::run_heatmap::heatmap;
use super::run_solver;
use super::run_training::{goal_state, policy_file, train};
use super::seeds::Training;
use super::workshop::{Prepared, Workshop, WorkshopError, write_whole};

/// What happens to a unit; `index` is its place in the plan.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// It was stored by an earlier run and still holds.
    Kept,
    /// It is under way; the share that is done.
    Running(f32),
    /// It is stored.
    Made {
        /// Wall time, s.
        time_s: f64,
    },
    /// It was broken off and is not stored.
    Interrupted,
    /// It is not stored.
    Failed(String),
}

/// Stages that wait for each other: the trials on the arm take the best of the trained policies,
/// and the long trainings must not keep them waiting.
const STAGES: [fn(&Unit) -> bool; 3] = [
    |unit| !is_arm(unit) && !is_recurrent(unit),
    is_arm,
    is_recurrent,
];

/// Runs what is not stored yet. Without `again`, a stored cell of the same unit, object, engine
/// version and number of trials is kept.
///
/// # Errors
/// Where the folder of results cannot be read; what happens to single units is reported.
pub fn run(
    workshop: &Workshop<'_>,
    units: &[Unit],
    threads: usize,
    again: bool,
    interrupt: &AtomicBool,
    report: &(dyn Fn(usize, &Event) + Sync),
) -> Result<(), WorkshopError> {
    let stored = Results::read(&workshop.results).map_err(WorkshopError::of)?;
    for stage in STAGES {
        let waiting: Vec<usize> = (0..units.len())
            .filter(|&index| stage(&units[index]))
            .collect();
        let next = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..threads.clamp(1, waiting.len().max(1)) {
                scope.spawn(|| {
                    while let Some(&index) = waiting.get(next.fetch_add(1, Ordering::Relaxed)) {
                        if interrupt.load(Ordering::Relaxed) {
                            break;
                        }
                        let unit = &units[index];
                        let job = Job {
                            workshop,
                            unit,
                            interrupt,
                        };
                        let earlier = stored.cell(unit).filter(|_| !again);
                        report(
                            index,
                            &job.done(earlier, &|share| {
                                report(index, &Event::Running(share));
                            }),
                        );
                    }
                });
            }
        });
    }
    Ok(())
}

/// One unit on its way.
struct Job<'a> {
    workshop: &'a Workshop<'a>,
    unit: &'a Unit,
    interrupt: &'a AtomicBool,
}

impl Job<'_> {
    fn done(&self, earlier: Option<&Cell>, progress: &dyn Fn(f32)) -> Event {
        match self.store(earlier, progress) {
            Ok(None) => Event::Kept,
            Ok(Some(time_s)) => Event::Made { time_s },
            Err(_) if self.interrupt.load(Ordering::Relaxed) => Event::Interrupted,
            Err(error) => Event::Failed(error.to_string()),
        }
    }

    /// Makes and stores the cell, unless the earlier one holds; the time it took.
    fn store(
        &self,
        earlier: Option<&Cell>,
        progress: &dyn Fn(f32),
    ) -> Result<Option<f64>, WorkshopError> {
        let begun = Instant::now();
        let prepared = self
            .workshop
            .object(self.unit.task(), self.unit.belief_frequency())?;
        let task_hash = hash_of(&prepared.task);
        let filter_hash = filter_hash_of(&prepared.task, self.unit);
        let shield_hash = shield_hash_of(&prepared.task, self.unit);
        if earlier.is_some_and(|cell| {
            cell.task_hash == task_hash
                && cell.filter_hash == filter_hash
                && cell.shield_hash == shield_hash
                && self.holds(cell)
        }) {
            return Ok(None);
        }
        let result = self.result(&prepared, progress)?;
        let time_s = begun.elapsed().as_secs_f64();
        let cell = Cell {
            unit: self.unit.clone(),
            engine_version: env!("CARGO_PKG_VERSION").to_owned(),
            vector_unit: VectorUnit::best().to_string(),
            task_hash,
            filter_hash,
            shield_hash,
            made_at: pubs_run::utc::now(),
            time_s,
            without_policy: false,
            result,
        };
        store_json(self.workshop, CELLS, &self.unit.id(), &cell)?;
        Ok(Some(time_s))
    }

    /// Whether a cell of the same object and shield is of this unit and made as asked.
    fn holds(&self, cell: &Cell) -> bool {
        let workshop = self.workshop;
        let same = cell.unit == *self.unit && cell.engine_version == env!("CARGO_PKG_VERSION");
        let there = |policy: &str| cell.without_policy || workshop.policy(policy).is_file();
        let as_asked = match &cell.result {
            CellResult::Training {
                fresh,
                steps,
                policy,
                ..
            } => {
                let steps_asked = workshop.steps.map(|steps| steps as u64);
                there(policy)
                    && fresh.plain.trials == workshop.trials
                    && steps_asked.is_none_or(|asked| *steps >= asked && *steps < 2 * asked)
            }
            CellResult::Solver {
                evaluation, policy, ..
            } => there(policy) && evaluation.trials == workshop.trials,
            // Another seed may have become the best since.
            CellResult::Arm { policy_sha256, .. } => {
                self.arm_policy_sha256().as_ref() == Some(policy_sha256)
            }
        };
        same && as_asked
    }

    /// The training whose best policy trials on the arm take.
    fn arm_training(&self) -> Training<'_> {
        deployed(self.unit.task(), GoalName::Middle)
    }

    /// What its cell says of that policy's weights; the file itself may be in a kept report only.
    fn arm_policy_sha256(&self) -> Option<String> {
        let results = Results::read(&self.workshop.results).ok()?;
        let training = self.arm_training();
        let best = training.seeds(&results)?.best.seed;
        match &results.cell(&training.unit(best))?.result {
            CellResult::Training { policy_sha256, .. } => Some(policy_sha256.clone()),
            CellResult::Solver { .. } | CellResult::Arm { .. } => None,
        }
    }

    fn result(
        &self,
        prepared: &Prepared,
        progress: &dyn Fn(f32),
    ) -> Result<CellResult, WorkshopError> {
        match self.unit {
            Unit::Training {
                task,
                goal,
                method,
                entropy,
                belief_frequency,
                shielded,
                seed,
            } => {
                let training = Training {
                    task,
                    goal: *goal,
                    method: *method,
                    entropy: *entropy,
                    belief_frequency: *belief_frequency,
                    shielded: *shielded,
                };
                train(self.workshop, prepared, training, *seed, &|now| {
                    progress(now.steps as f32 / now.total_steps.max(1) as f32);
                    self.flow()
                })
            }
            Unit::Solver {
                method,
                timeout_s,
                belief_frequency,
                ..
            } => run_solver::solve(
                self.workshop,
                prepared,
                &self.unit.id(),
                *method,
                *timeout_s,
                *belief_frequency,
                &|share| {
                    progress(share);
                    self.flow()
                },
            ),
            Unit::Arm { trials, drift, .. } => {
                let results = Results::read(&self.workshop.results).map_err(WorkshopError::of)?;
                let policy = best_policy(self.workshop, &results, &self.arm_training())?;
                run_arm::run(self.workshop, prepared, &policy, *trials, *drift)
            }
        }
    }

    fn flow(&self) -> ControlFlow<()> {
        if self.interrupt.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Copies the best policies under the shield of the four objects and three goals, as the paper
/// deploys the best seed, to `folder`, as `<object>-<goal>.onnx`; those not trained yet are left
/// out.
///
/// # Errors
/// Where a policy cannot be read or written.
pub fn keep(
    workshop: &Workshop<'_>,
    results: &Results,
    folder: &Path,
) -> Result<(), WorkshopError> {
    for task in OBJECTS {
        for goal in GOALS {
            let Ok(policy) = best_policy(workshop, results, &deployed(task, goal)) else {
                continue;
            };
            let prepared = workshop.object(task, None)?;
            let state = goal_state(&prepared, goal)?;
            let label = fraction_label(&prepared.task.joint, state);
            let path = folder.join(format!("{task}-{label}.onnx"));
            let bytes = std::fs::read(policy.path()).map_err(WorkshopError::of)?;
            write_whole(&path, &bytes).map_err(WorkshopError::of)?;
        }
    }
    Ok(())
}

/// Pictures of Fig. 5 from the best policies that are stored; those not trained yet are left out.
///
/// # Errors
/// Where a policy cannot be asked or a file written.
pub fn heatmaps(workshop: &Workshop<'_>, results: &Results) -> Result<(), WorkshopError> {
    for (task, goal, _) in PICTURES {
        let training = Training::new(task, goal, Method::Pubs);
        let Ok(policy) = best_policy(workshop, results, &training) else {
            continue;
        };
        let prepared = workshop.object(task, None)?;
        let drawn = heatmap(workshop, &prepared, &policy, goal)?;
        store_json(workshop, HEATMAPS, &heatmap_id(task, goal), &drawn)?;
    }
    Ok(())
}

/// The training whose best seed moves an arm: PuBS under the shield.
fn deployed(task: &str, goal: GoalName) -> Training<'_> {
    Training {
        shielded: true,
        ..Training::new(task, goal, Method::Pubs)
    }
}

/// The policy of the best seed of a training.
fn best_policy(
    workshop: &Workshop<'_>,
    results: &Results,
    training: &Training<'_>,
) -> Result<PolicyFile, WorkshopError> {
    let seeds = training.seeds(results).ok_or_else(|| {
        WorkshopError(format!(
            "no policy of {} for the goal {} is trained yet",
            training.task,
            training.goal.name()
        ))
    })?;
    let unit = training.unit(seeds.best.seed);
    let path = workshop.policy(&policy_file(&unit));
    if !path.is_file() {
        return Err(WorkshopError(format!(
            "the policy {} is not there, as where its cell was taken from a kept report: make it with --cells {} --again",
            path.display(),
            unit.id()
        )));
    }
    PolicyFile::read(&path).map_err(WorkshopError::of)
}

fn store_json(
    workshop: &Workshop<'_>,
    folder: &str,
    id: &str,
    value: &impl serde::Serialize,
) -> Result<(), WorkshopError> {
    let text = serde_json::to_string_pretty(value).map_err(WorkshopError::of)?;
    let path = workshop.results.join(folder).join(format!("{id}.json"));
    write_whole(&path, text.as_bytes())
        .map_err(|error| WorkshopError(format!("cannot write {}: {error}", path.display())))
}

/// Of the task, less its filter, and of its observation model: a cell holds for both.
fn hash_of(task: &Task) -> String {
    let task_hash = short_hash(&task.raw_policy_ingredients());
    format!("{task_hash}-{}", &task.observation_hash()[..16])
}

/// Of the filter, where one follows.
fn filter_hash_of(task: &Task, unit: &Unit) -> Option<String> {
    let follows = match unit {
        Unit::Training { method, .. } => method.has_belief(),
        // The belief of alpha vectors is exact.
        Unit::Solver { .. } => false,
        Unit::Arm { .. } => true,
    };
    follows.then(|| short_hash(&task.filter_ingredients()))
}

/// Of the shield, where one has a say in the cell.
fn shield_hash_of(task: &Task, unit: &Unit) -> Option<String> {
    let Shield { mass, flattening } = task.policy.shield;
    let shield = json!({ "mass": mass, "flattening": flattening, "margin": shield::margin(task) });
    may_be_shielded(task, unit).then(|| short_hash(&shield))
}

fn short_hash(ingredients: &Value) -> String {
    pubs_policy::task_hash(ingredients)[..16].to_owned()
}

/// Whether a shield has a say in a cell: in training, in half of the trials, or on the arm.
fn may_be_shielded(task: &Task, unit: &Unit) -> bool {
    let masks = task.actions.iter().any(Action::is_high_force);
    match unit {
        Unit::Training { method, .. } => masks && method.has_belief(),
        Unit::Solver { .. } => false,
        Unit::Arm { .. } => masks,
    }
}

fn is_arm(unit: &Unit) -> bool {
    matches!(unit, Unit::Arm { .. })
}

fn is_recurrent(unit: &Unit) -> bool {
    matches!(unit, Unit::Training { method, .. } if method.lstm_layers() > 0)
}
