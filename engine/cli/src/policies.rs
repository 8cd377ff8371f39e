//! Finding a policy that fits an object, or training one.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use pubs_core::Task;
use pubs_evaluate::{EntropyInput, Method, TrainingPlan, expected_of};
use pubs_policy::{Existing, FeatureName, PolicyFile, Runtime, task_hash};
use pubs_train::Recipe;
use pubs_train::surrogate::Goals;

use crate::failure::{Failure, chain};
use crate::object::Ready;
use crate::options::make_folder;
use crate::show;
use crate::training;

/// Seeds of a training that nobody asked for: a second one guards against a collapse.
pub const SEEDS: u64 = 2;
/// Trials on which they are compared.
pub const TRIALS: u64 = 10_000;
/// Cap on policy steps in trials and runs, §IV-A.3.
pub const MAX_STEPS: u32 = 250;

/// Where an object's policies lie: `policies` beside the folder of its object file.
pub fn folder_of(object: &Path) -> PathBuf {
    sibling_folder(object, "policies")
}

/// A folder beside the folder of an object file.
pub fn sibling_folder(object: &Path, name: &str) -> PathBuf {
    let folder = object
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    // Without `..` in it, the path reads better.
    let beside = folder.canonicalize().ok();
    beside
        .as_deref()
        .and_then(Path::parent)
        .map_or_else(|| folder.join("..").join(name), |parent| parent.join(name))
}

/// A file that the user named; it must fit every goal.
///
/// # Errors
/// Where it cannot be read or was made for something else.
pub fn named(
    path: &Path,
    foreign: Option<&[FeatureName]>,
    task: &Task,
    goals: &[Option<f64>],
) -> Result<PolicyFile, Failure> {
    let incompatible = |error: &dyn std::error::Error| Failure::incompatible(chain(error));
    if path
        .extension()
        .is_some_and(|end| end == "json" || end == "toml")
    {
        return Err(Failure::incompatible(format!(
            "{} is no policy network (.onnx); alpha vectors (.json) are for `evaluate`, which follows \
             them with a belief of their own",
            path.display()
        )));
    }
    if let Some(inputs) = foreign {
        return PolicyFile::read_foreign(path, inputs, task.actions.len())
            .map(told)
            .map_err(|error| incompatible(&error));
    }
    let file = PolicyFile::read(path).map_err(|error| incompatible(&error))?;
    for goal in goals {
        let warnings = file
            .check(&expected_of(task, method_of(&file), *goal))
            .map_err(|error| incompatible(&error))?;
        for warning in warnings {
            show::say(&format!("warning: {}: {warning}", path.display()));
        }
    }
    Ok(told(file))
}

/// A policy in `folder` that serves every one of `goals`, or a new one, trained and put there.
/// A file that does not fit is left alone.
///
/// # Errors
/// Where a training is needed and fails.
pub fn found_or_trained(
    ready: &Ready,
    folder: &Path,
    goals: &[Option<f64>],
    runtime: &Runtime,
    interrupt: &AtomicBool,
) -> Result<PolicyFile, Failure> {
    let mut passed_over = Vec::new();
    for path in candidates(folder, &ready.task.name) {
        match fits(&path, &ready.task, goals) {
            Ok(file) => return Ok(told(file)),
            Err(reason) => passed_over.push(reason),
        }
    }
    for reason in &passed_over {
        show::note(&format!("note: passed over {reason}"));
    }
    let path = free_name(folder, &ready.task);
    show::note(&format!(
        "note: no policy in {} fits; training one for every goal, which takes about half a minute",
        folder.display()
    ));
    make_folder(folder)?;
    let plan = TrainingPlan {
        method: Method::Pubs,
        entropy: EntropyInput::Belief,
        recipe: Recipe::standard(),
        goals: Goals::Every,
        seeds: (1..=SEEDS).collect(),
        trials: TRIALS,
        max_steps: MAX_STEPS,
        shield: Some(ready.task.policy.shield),
        threads: None,
    };
    let result = training::train(ready, &plan, &path, Existing::Keep, runtime, interrupt)?;
    show::note(&format!(
        "note: trained {} in {:.1} s (success {:.2} % of {} trials)",
        path.display(),
        result
            .candidates
            .iter()
            .map(|candidate| candidate.time_s)
            .fold(0.0, f64::max),
        100.0 * result.evaluation.figures.success_rate,
        result.evaluation.figures.trials,
    ));
    let file = PolicyFile::read(&path).map_err(|error| Failure::fault(&error))?;
    Ok(told(file))
}

/// The policy, named where that is asked for.
fn told(file: PolicyFile) -> PolicyFile {
    show::detail(|| format!("policy: {}", file.path().display()));
    file
}

/// The goal a policy was made for, where it serves only one.
pub fn fixed_goal(file: &PolicyFile) -> Option<f64> {
    match file.contract()?.goal {
        pubs_policy::Goal::Fixed { value, .. } => Some(value),
        pubs_policy::Goal::Every => None,
    }
}

/// What it was trained by; a file that does not say is taken for the paper's.
fn method_of(file: &PolicyFile) -> Method {
    file.contract()
        .map_or(Method::Pubs, |contract| contract.method)
}

fn fits(path: &Path, task: &Task, goals: &[Option<f64>]) -> Result<PolicyFile, String> {
    let file = PolicyFile::read(path).map_err(|error| chain(&error))?;
    let mut warnings = Vec::new();
    for goal in goals {
        warnings = file
            .check(&expected_of(task, method_of(&file), *goal))
            .map_err(|error| chain(&error))?;
    }
    for warning in warnings {
        show::say(&format!("warning: {}: {warning}", path.display()));
    }
    Ok(file)
}

/// `<object>.onnx` first, then `<object>-….onnx` and `<object>.….onnx` in order.
fn candidates(folder: &Path, object: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |path: &PathBuf| {
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or_default();
        let rest = name.strip_prefix(object).unwrap_or_default();
        rest == ".onnx"
            || ((rest.starts_with('-') || rest.starts_with('.')) && rest.ends_with(".onnx"))
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_ours).collect();
    paths.sort_by_key(|path| {
        (
            path.file_stem().is_none_or(|stem| stem != object),
            path.clone(),
        )
    });
    paths
}

/// A name that is not taken: with the head of the task's hash where another task has the plain one.
fn free_name(folder: &Path, task: &Task) -> PathBuf {
    let plain = folder.join(format!("{}.onnx", task.name));
    if !plain.exists() {
        return plain;
    }
    let hash = task_hash(&task.policy_ingredients());
    folder.join(format!("{}.{}.onnx", task.name, &hash[..8]))
}
