//! Training with several seeds, and keeping the best.
//!
//! One seed in some twenty collapses to never stopping, so a policy is the best of several,
//! chosen on common trials and then judged on fresh ones: choosing and judging on the same trials
//! would flatter it.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_core::seed::stream;
use pubs_core::shield::Shield;
use pubs_policy::{Contract, ExportError, Method, Runtime};
use pubs_train::surrogate::Goals;
use pubs_train::{Progress, Recipe};

use crate::evaluation::{
    EvaluateError, Evaluation, EvaluationOptions, GoalChoice, NetworkContestant, evaluate,
};
use crate::policy_file::{contract_of, write};
use crate::reads::EntropyInput;
use crate::training::{TrainSeedError, TrainedSeed, train_seed};

/// What to train.
#[derive(Debug, Clone)]
pub struct TrainingPlan {
    /// The paper's method or one of its baselines.
    pub method: Method,
    /// What the policy sees as entropy; of no account where the method has no belief.
    pub entropy: EntropyInput,
    /// PPO's settings.
    pub recipe: Recipe,
    /// One goal or every one.
    pub goals: Goals,
    /// Seeds, one training each.
    pub seeds: Vec<u64>,
    /// Trials on which seeds are compared, and as many fresh ones for the figures.
    pub trials: u64,
    /// Cap on policy steps in trials.
    pub max_steps: u32,
    /// Mask of high-force actions in trials.
    pub shield: Option<Shield>,
    /// Trainings at once; `None`: one per core.
    pub threads: Option<usize>,
}

/// One seed's training.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Its seed.
    pub seed: u64,
    /// Steps done.
    pub steps: usize,
    /// Time of its training, s.
    pub time_s: f64,
    /// Share of that spent on gradient steps.
    pub learning_s: f64,
    /// Its figures on the common trials.
    pub evaluation: Evaluation,
    trained: TrainedSeed,
}

impl Candidate {
    /// How its training stood on the way.
    pub fn curve(&self) -> &[Progress] {
        &self.trained.curve
    }
}

/// Why no policy came out.
#[derive(Debug, thiserror::Error)]
pub enum TrainBestError {
    /// A training failed.
    #[error("training with seed {seed} failed: {source}")]
    Train {
        /// Which.
        seed: u64,
        /// Why.
        source: TrainSeedError,
    },
    /// A candidate could not be evaluated.
    #[error("the policy of seed {seed} cannot be evaluated: {source}")]
    Evaluate {
        /// Which.
        seed: u64,
        /// Why.
        source: EvaluateError,
    },
    /// A file could not be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// No room for candidates.
    #[error("cannot make a temporary folder: {0}")]
    Temporary(std::io::Error),
    /// No seeds.
    #[error("there is no seed to train with")]
    NoSeed,
}

/// Trains with every seed, chooses the best by mean discounted reward on common trials, judges it
/// on fresh ones and writes it to `path`. All candidates, in the order of their seeds, the index
/// of the best, and its fresh figures. `report` hears of the seed by index and may cancel.
///
/// # Errors
/// [`TrainBestError`]; nothing is written then.
pub fn train_best(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    plan: &TrainingPlan,
    path: &Path,
    existing: pubs_policy::Existing,
    runtime: &Runtime,
    report: &(dyn Fn(usize, &Progress) -> ControlFlow<()> + Sync),
) -> Result<(Vec<Candidate>, usize, Evaluation), TrainBestError> {
    let folder = tempfile::tempdir().map_err(TrainBestError::Temporary)?;
    let judge = |trained: &TrainedSeed, contract: &Contract, trials: &str| {
        let draft = folder
            .path()
            .join(format!("{trials}-{}.onnx", contract.seed));
        judge(
            task, model, plan, trained, contract, &draft, runtime, trials,
        )
    };
    let trained = train_all(task, model, plan, report);
    let mut candidates = Vec::new();
    for (seed, result) in plan.seeds.iter().copied().zip(trained) {
        let trained = result.map_err(|source| TrainBestError::Train { seed, source })?;
        let contract = contract_of(task, plan, seed, 0.0, &trained);
        let evaluation = judge(&trained, &contract, "selection")?;
        candidates.push(Candidate {
            seed,
            steps: trained.progress.steps,
            time_s: trained.progress.time_s,
            learning_s: trained.learning_s,
            evaluation,
            trained,
        });
    }
    let score = |index: &usize| candidates[*index].evaluation.figures.mean_discounted_reward;
    let best = (0..candidates.len()).max_by(|one, other| score(one).total_cmp(&score(other)));
    let best = best.ok_or(TrainBestError::NoSeed)?;
    let Candidate { seed, trained, .. } = &candidates[best];
    let draft = contract_of(task, plan, *seed, 0.0, trained);
    let fresh = judge(trained, &draft, "report")?;
    let contract = contract_of(task, plan, *seed, fresh.figures.mean_reward, trained);
    write(trained, &contract, path, existing, runtime)?;
    Ok((candidates, best, fresh))
}

/// All trainings, a few at a time, in the order of the seeds.
fn train_all(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    plan: &TrainingPlan,
    report: &(dyn Fn(usize, &Progress) -> ControlFlow<()> + Sync),
) -> Vec<Result<TrainedSeed, TrainSeedError>> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = plan
        .threads
        .unwrap_or(cores)
        .clamp(1, plan.seeds.len().max(1));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(&seed) = plan.seeds.get(index) else {
                        break;
                    };
                    let result =
                        train_seed(task, model, plan, seed, &|progress| report(index, progress));
                    results
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .push((index, result));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|&(index, _)| index);
    results.into_iter().map(|(_, result)| result).collect()
}

#[expect(
    clippy::too_many_arguments,
    reason = "each is one thing, and only this file calls it"
)]
fn judge(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    plan: &TrainingPlan,
    trained: &TrainedSeed,
    contract: &Contract,
    draft: &Path,
    runtime: &Runtime,
    trials: &str,
) -> Result<Evaluation, TrainBestError> {
    let file = write(
        trained,
        contract,
        draft,
        pubs_policy::Existing::Replace,
        runtime,
    )?;
    let options = EvaluationOptions {
        trials: plan.trials,
        goal: match plan.goals {
            Goals::One(state) => GoalChoice::One(state),
            Goals::Every => GoalChoice::Drawn,
        },
        max_steps: plan.max_steps,
        shield: plan.shield,
        seed: stream(0, trials),
        threads: plan.threads,
    };
    let contestant = NetworkContestant {
        file: &file,
        runtime,
    };
    evaluate(task, model, &contestant, &options).map_err(|source| TrainBestError::Evaluate {
        seed: contract.seed,
        source,
    })
}
