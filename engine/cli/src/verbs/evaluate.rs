//! `pubs-engine evaluate`: many simulated trials of a policy.

use std::path::PathBuf;

use clap::Args;
use pubs_core::goal::GoalError;
use pubs_core::{Goal, Joint};
use pubs_evaluate::trial::goal_label;
use pubs_evaluate::{Evaluation, EvaluationOptions, GoalChoice, evaluate};
use pubs_policy::{FeatureName, PolicyFile};
use serde::Serialize;

use crate::failure::Failure;
use crate::options::{LayerOptions, RuntimeOptions};
use crate::policies::{self, MAX_STEPS};
use crate::{Ended, built_in, exit, object, show};

#[derive(Args)]
#[command(
    after_help = "Examples: pubs-engine evaluate policies/door2.onnx --trials 10000
          pubs-engine evaluate policies/door2.onnx --goal 0.5 --no-shield --json"
)]
pub struct Arguments {
    /// Policy file
    policy: PathBuf,
    /// Object file [default: objects/OBJECT.toml beside the policy's folder]
    #[arg(long, value_name = "FILE")]
    object: Option<PathBuf>,
    /// Goal of every trial [default: the policy's; for one that serves every goal, drawn per trial]
    #[arg(long, value_name = "GOAL", allow_hyphen_values = true)]
    goal: Option<String>,
    /// Number of trials
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..))]
    trials: u64,
    /// A trial times out after so many policy steps
    #[arg(long, default_value_t = MAX_STEPS, value_parser = clap::value_parser!(u32).range(1..))]
    max_steps: u32,
    /// Leave high-force actions unmasked, as the paper
    #[arg(long)]
    no_shield: bool,
    /// Inputs of a policy that was exported elsewhere and carries no contract, such as mean,entropy
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    inputs: Vec<FeatureName>,
    /// Seed of the trials
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; they never change a figure [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    layers: LayerOptions,
    #[command(flatten)]
    runtime: RuntimeOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    policy: PathBuf,
    object: String,
    goal: String,
    shield: bool,
    seed: u64,
    trials: u64,
    mean_reward: f64,
    mean_reward_se: f64,
    mean_discounted_reward: f64,
    mean_discounted_reward_se: f64,
    success_rate: f64,
    safety_violations: u64,
    time_outs: u64,
    failed_stops: u64,
    mean_goal_error: Option<f64>,
    mean_steps: f64,
    coverage_90: f64,
    recovered_trials: u64,
    vector_unit: String,
    runtime: &'static str,
    time_s: f64,
    trials_per_s: f64,
}

pub fn run(arguments: &Arguments) -> Ended {
    let registry = built_in::registry(&arguments.layers.plugin_dirs);
    let object_path = object_path(arguments)?;
    let ready = object::ready(
        &object_path,
        &arguments.layers.overrides(),
        &registry,
        arguments.seed,
    )?;
    let (task, joint) = (&ready.task, &ready.task.joint);
    let asked = match &arguments.goal {
        None => task.default_goal,
        Some(text) => Some(parse_goal(text, joint)?),
    };
    let foreign = (!arguments.inputs.is_empty()).then_some(arguments.inputs.as_slice());
    let file = policies::named(&arguments.policy, foreign, task, &[asked])?;
    let goal = asked.or_else(|| policies::fixed_goal(&file));
    if goal.is_none() && file.contract().is_none() {
        return Err(Failure::invalid(
            "a policy without a contract does not say its goal: add --goal",
        ));
    }
    let runtime = arguments.runtime.runtime()?;
    let options = EvaluationOptions {
        trials: arguments.trials,
        goal: goal.map_or(GoalChoice::Drawn, GoalChoice::One),
        max_steps: arguments.max_steps,
        shield: (!arguments.no_shield).then_some(task.policy.shield),
        seed: arguments.seed,
        threads: arguments.threads.map(usize::from),
    };
    let found = evaluate(task, &ready.model, &file, &runtime, &options)
        .map_err(|error| Failure::fault(&error))?;
    let label = goal_label(joint, goal);
    if arguments.json {
        show::print_json(&report(
            arguments,
            &task.name,
            label,
            runtime.version(),
            found,
        ))?;
    } else {
        show::print(&text(
            &task.name,
            &label,
            joint,
            !arguments.no_shield,
            &found,
        ))?;
    }
    Ok(exit::DONE)
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
fn object_path(arguments: &Arguments) -> Result<PathBuf, Failure> {
    if let Some(object) = &arguments.object {
        return Ok(object.clone());
    }
    if !arguments.inputs.is_empty() {
        return Err(Failure::invalid(
            "a policy without a contract does not say its object: add --object FILE",
        ));
    }
    let file = PolicyFile::read(&arguments.policy)
        .map_err(|error| Failure::incompatible(error.to_string()))?;
    let name = file
        .contract()
        .map(|contract| contract.object.clone())
        .unwrap_or_default();
    let folder = arguments
        .policy
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let beside = folder
        .unwrap_or(std::path::Path::new("."))
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
        "the policy is for the object `{name}`; its file is neither {} nor {}: add --object FILE",
        beside.display(),
        here.display()
    )))
}

fn report(
    arguments: &Arguments,
    object: &str,
    goal: String,
    runtime: &'static str,
    found: Evaluation,
) -> Report {
    Report {
        policy: arguments.policy.clone(),
        object: object.to_owned(),
        goal,
        shield: !arguments.no_shield,
        seed: arguments.seed,
        trials: found.trials,
        mean_reward: found.mean_reward,
        mean_reward_se: found.mean_reward_se,
        mean_discounted_reward: found.mean_discounted_reward,
        mean_discounted_reward_se: found.mean_discounted_reward_se,
        success_rate: found.success_rate,
        safety_violations: found.safety_violations,
        time_outs: found.time_outs,
        failed_stops: found.failed_stops,
        mean_goal_error: found.mean_goal_error,
        mean_steps: found.mean_steps,
        coverage_90: found.coverage_90,
        recovered_trials: found.recovered_trials,
        vector_unit: found.vector_unit,
        runtime,
        time_s: found.time_s,
        trials_per_s: found.trials_per_s,
    }
}

fn text(object: &str, goal: &str, joint: &Joint, shield: bool, found: &Evaluation) -> String {
    let error = found
        .mean_goal_error
        .map_or_else(|| "–".to_owned(), |error| joint.display(error));
    format!(
        "{object}, goal {goal}, {} trials, shield {}\n\
         reward             {:.4} ± {:.4}\n\
         discounted reward  {:.4} ± {:.4}\n\
         success            {:.2} %\n\
         safety violations  {}\n\
         time-outs          {}\n\
         failed stops       {}\n\
         goal error         {error} (mean of the stops)\n\
         steps              {:.1}\n\
         90 % interval held the true state in {:.1} %\n\
         {:.2} s, {:.0} trials/s on {}",
        found.trials,
        if shield { "on" } else { "off" },
        found.mean_reward,
        found.mean_reward_se,
        found.mean_discounted_reward,
        found.mean_discounted_reward_se,
        100.0 * found.success_rate,
        found.safety_violations,
        found.time_outs,
        found.failed_stops,
        found.mean_steps,
        100.0 * found.coverage_90,
        found.time_s,
        found.trials_per_s,
        found.vector_unit,
    )
}
