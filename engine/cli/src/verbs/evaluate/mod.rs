//! `pubs-engine evaluate`: many simulated trials of a policy.

mod alpha;
mod problem;
mod words;

use std::path::{Path, PathBuf};

use clap::Args;
use pubs_core::goal::GoalError;
use pubs_core::{Goal, Joint};
use pubs_evaluate::grid::GridOrigin;
use pubs_evaluate::trial::goal_label;
use pubs_evaluate::{Evaluation, EvaluationOptions, GoalChoice, NetworkContestant, evaluate};
use pubs_policy::{FeatureName, PolicyFile, Runtime};
use serde::Serialize;

use crate::failure::Failure;
use crate::object::Ready;
use crate::options::{FrequencyOptions, LayerOptions, RuntimeOptions, whole};
use crate::policies::{self, MAX_STEPS};
use crate::{Ended, exit, object, show};

#[derive(Args)]
#[command(
    after_help = "Examples: pubs-engine evaluate policies/door2.onnx --trials 10000
          pubs-engine evaluate policies/door2.onnx --goal 0.5 --no-shield --json
          pubs-engine evaluate policies/door2.onnx other.onnx --goal 0.5   # on the same trials
          pubs-engine evaluate sim_object.policy.json
          pubs-engine evaluate tiger.policy.json --object tiger.pomdp"
)]
pub struct Arguments {
    /// Policy files, all of one object; they are judged on the same trials. Networks (.onnx), or
    /// alpha vectors (.json) as `solve` writes them
    #[arg(required = true, value_name = "POLICY")]
    policies: Vec<PathBuf>,
    /// Object file [default: objects/OBJECT.toml beside the policy's folder]; or a .pomdp file, for
    /// alpha vectors that were solved from one
    #[arg(long, value_name = "FILE")]
    object: Option<PathBuf>,
    /// Goal of every trial [default: the policy's; for one that serves every goal, drawn per trial]
    #[arg(long, value_name = "GOAL", allow_hyphen_values = true)]
    goal: Option<String>,
    /// Number of trials
    #[arg(long, default_value_t = 10_000, value_parser = whole::<u64>(1, u64::MAX))]
    trials: u64,
    /// A trial times out after so many policy steps
    #[arg(long, default_value_t = MAX_STEPS, value_parser = whole::<u32>(1, u32::MAX.into()))]
    max_steps: u32,
    /// Leave high-force actions unmasked, as the paper; alpha vectors and policies without a belief
    /// always do, since a shield looks at the belief
    #[arg(long)]
    no_shield: bool,
    #[command(flatten)]
    frequency: FrequencyOptions,
    /// Inputs of a policy that was exported elsewhere and carries no contract, such as mean,entropy
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    inputs: Vec<FeatureName>,
    /// Seed of the trials
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; they never change a figure [default: all cores]
    #[arg(long, value_parser = whole::<u16>(1, u16::MAX.into()))]
    threads: Option<u16>,
    #[command(flatten)]
    layers: LayerOptions,
    #[command(flatten)]
    runtime: RuntimeOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// One policy's figures, as `--json` has them.
#[derive(Serialize)]
struct Report {
    policy: PathBuf,
    object: String,
    /// Of joint states: `rad`, `m` or `1` for plain numbers.
    unit: &'static str,
    goal: String,
    shield: bool,
    seed: u64,
    #[serde(flatten)]
    evaluation: Evaluation,
    /// Null for alpha vectors, which need none.
    runtime: Option<&'static str>,
}

/// Several policies' figures on the same trials.
#[derive(Serialize)]
struct Reports<'a, R> {
    evaluations: &'a [R],
}

pub fn run(arguments: &Arguments) -> Ended {
    if let Some(file) = arguments
        .object
        .as_deref()
        .filter(|file| has_end(file, "pomdp"))
    {
        return problem::run(arguments, file);
    }
    let registry = arguments.layers.plugins.registry();
    // Of the first policy: all of them are of one object.
    let solved = alpha::solved_from(&arguments.policies[0])?;
    let object_path = object_path(arguments, solved.as_ref())?;
    let frequency = arguments
        .frequency
        .belief_frequency
        .or(solved.and_then(|origin| origin.belief_frequency));
    let ready = object::ready(
        &object_path,
        &arguments.layers.overrides(),
        frequency,
        &registry,
        arguments.seed,
    )?;
    let runtime = arguments.runtime.runtime()?;
    let mut reports = Vec::new();
    for path in &arguments.policies {
        reports.push(if has_end(path, "json") {
            alpha::judge(arguments, path, &ready)?
        } else {
            judge(arguments, path, &ready, &runtime)?
        });
    }
    let several = reports.len() > 1;
    let text = |report: &Report| words::text(&ready.task.joint, report, several);
    tell(&reports, arguments.json, text)?;
    Ok(exit::DONE)
}

/// Prints the figures of one policy or of several.
fn tell<R: Serialize>(
    reports: &[R],
    json: bool,
    text: impl Fn(&R) -> String,
) -> Result<(), Failure> {
    match reports {
        [report] if json => show::print_json(report),
        evaluations if json => show::print_json(&Reports { evaluations }),
        reports => {
            let texts: Vec<String> = reports.iter().map(text).collect();
            show::print(&texts.join("\n\n"))
        }
    }
}

impl Arguments {
    /// The trials that are asked for, without a shield.
    fn trials_of(&self, goal: Option<f64>) -> EvaluationOptions {
        EvaluationOptions {
            trials: self.trials,
            goal: goal.map_or(GoalChoice::Drawn, GoalChoice::One),
            max_steps: self.max_steps,
            shield: None,
            seed: self.seed,
            threads: self.threads.map(usize::from),
        }
    }
}

fn has_end(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|found| found == end)
}

/// The figures of one network.
fn judge(
    arguments: &Arguments,
    path: &Path,
    ready: &Ready,
    runtime: &Runtime,
) -> Result<Report, Failure> {
    let (task, joint) = (&ready.task, &ready.task.joint);
    let asked = match &arguments.goal {
        None => task.default_goal,
        Some(text) => Some(parse_goal(text, joint)?),
    };
    let foreign = (!arguments.inputs.is_empty()).then_some(arguments.inputs.as_slice());
    let file = policies::named(path, foreign, task, &[asked])?;
    let goal = asked.or_else(|| policies::fixed_goal(&file));
    if goal.is_none() && file.contract().is_none() {
        return Err(Failure::invalid(format!(
            "{} carries no contract that says its goal: add --goal, such as --goal 0.5",
            path.display()
        )));
    }
    // A shield looks at a belief, which a policy on raw observations does not have.
    let believes = file.inputs().iter().any(FeatureName::is_of_belief);
    let shield = believes && !arguments.no_shield;
    let options = EvaluationOptions {
        shield: shield.then_some(task.policy.shield),
        ..arguments.trials_of(goal)
    };
    let contestant = NetworkContestant {
        file: &file,
        runtime,
    };
    let evaluation = evaluate(task, &ready.model, &contestant, &options)
        .map_err(|error| Failure::fault(&error))?;
    Ok(Report {
        policy: path.to_owned(),
        object: task.name.clone(),
        unit: joint.unit(),
        goal: goal_label(joint, goal),
        shield,
        seed: arguments.seed,
        evaluation,
        runtime: Some(runtime.version()),
    })
}

/// Reads a goal after `--goal`.
///
/// # Errors
/// Where it is not one of this joint's.
pub fn parse_goal(text: &str, joint: &Joint) -> Result<f64, Failure> {
    let invalid = |error: GoalError| Failure::invalid(error.to_string());
    text.parse::<Goal>()
        .map_err(invalid)?
        .state(joint)
        .map_err(invalid)
}

/// The object that the user names, or else that of the policy.
fn object_path(arguments: &Arguments, solved: Option<&GridOrigin>) -> Result<PathBuf, Failure> {
    if let Some(object) = &arguments.object {
        return Ok(object.clone());
    }
    let policy = &arguments.policies[0];
    if !arguments.inputs.is_empty() {
        return Err(Failure::invalid(format!(
            "{} carries no contract that says its object: add --object FILE",
            policy.display()
        )));
    }
    let name = match solved {
        Some(origin) => origin.object.clone(),
        None => {
            let file = PolicyFile::read(policy)
                .map_err(|error| Failure::incompatible(error.to_string()))?;
            let contract = file.contract();
            contract.map_or_else(String::new, |contract| contract.object.clone())
        }
    };
    let folder = policy
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let beside = folder
        .unwrap_or(std::path::Path::new(""))
        .join("../objects")
        .join(format!("{name}.toml"));
    if beside.exists() {
        return Ok(beside);
    }
    let here = PathBuf::from("objects").join(format!("{name}.toml"));
    if here.exists() {
        return Ok(here);
    }
    Err(Failure::invalid(format!(
        "{} is for the object `{name}`, whose file is neither {} nor {}: add --object FILE",
        policy.display(),
        beside.display(),
        here.display()
    )))
}
