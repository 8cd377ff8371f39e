//! Training with a progress bar.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};

use pubs_evaluate::{
    Candidate, Evaluation, LearningCurves, TrainBestError, TrainingPlan, train_best,
};
use pubs_policy::{Existing, ExportError, PolicyFile, Runtime};
use pubs_train::Progress;

use crate::failure::Failure;
use crate::object::Ready;
use crate::show;

/// What a training brought.
pub struct TrainingResult {
    /// One per seed.
    pub candidates: Vec<Candidate>,
    /// Index of the one that was kept.
    pub best: usize,
    /// Its figures on fresh trials.
    pub evaluation: Evaluation,
}

/// Trains, showing steps/s, return, success and violations, and writes the best policy to `path`.
///
/// # Errors
/// Where a training fails or the file cannot be written.
pub fn train(
    ready: &Ready,
    plan: &TrainingPlan,
    path: &Path,
    existing: Existing,
    runtime: &Runtime,
    interrupt: &AtomicBool,
) -> Result<TrainingResult, Failure> {
    let recipe = &plan.recipe;
    let steps = recipe.updates() * recipe.rollout * recipe.environments * plan.seeds.len();
    let template = "training {bar:30} {percent:>3} %  {msg}  ({eta} left)";
    let bar = show::bar(steps as u64, template);
    let latest = Mutex::new(vec![Progress::default(); plan.seeds.len()]);
    let report = |index: usize, progress: &Progress| {
        let mut latest = latest.lock().unwrap_or_else(PoisonError::into_inner);
        latest[index] = *progress;
        bar.set_position(latest.iter().map(|progress| progress.steps as u64).sum());
        bar.set_message(describe(plan.seeds[index], progress));
        if interrupt.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let result = train_best(
        &ready.task,
        &ready.model,
        plan,
        path,
        existing,
        runtime,
        &report,
    );
    bar.finish_and_clear();
    let (candidates, best, evaluation) = result.map_err(failure)?;
    let result = TrainingResult {
        candidates,
        best,
        evaluation,
    };
    keep_curves(path, &result)?;
    Ok(result)
}

/// Puts the learning curves beside the policy; a policy is of use without them.
fn keep_curves(path: &Path, result: &TrainingResult) -> Result<(), Failure> {
    let file = PolicyFile::read(path).map_err(|error| Failure::fault(&error))?;
    let TrainingResult {
        candidates,
        best,
        evaluation,
    } = result;
    let curves = LearningCurves::of(file.sha256(), candidates, *best, evaluation);
    if let Err(error) = curves.write(path) {
        show::say(&format!(
            "warning: the learning curves cannot be kept in {}: {error}",
            LearningCurves::file_of(path).display()
        ));
    }
    Ok(())
}

fn failure(error: TrainBestError) -> Failure {
    match &error {
        TrainBestError::Export(ExportError::Exists { .. }) => {
            Failure::invalid(format!("{error}; --overwrite replaces it"))
        }
        _ => Failure::fault(&error),
    }
}

fn describe(seed: u64, progress: &Progress) -> String {
    let percent = |rate: Option<f32>| {
        rate.map_or_else(|| "–".to_owned(), |rate| format!("{:.1} %", 100.0 * rate))
    };
    let mean_return = progress
        .mean_return
        .map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
    format!(
        "seed {seed}: {:.0} steps/s, return {mean_return}, success {}, violations {}",
        progress.steps_per_s(),
        percent(progress.success_rate),
        percent(progress.violation_rate),
    )
}
