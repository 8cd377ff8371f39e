//! `pubs-engine train`: a policy for an object.

use std::path::PathBuf;

use clap::Args;
use pubs_core::goal::fraction_label;
use pubs_evaluate::{EntropyInput, Evaluation, Figures, Method, TrainingPlan};
use pubs_policy::Existing;
use pubs_train::Recipe;
use pubs_train::surrogate::Goals;
use serde::Serialize;

use crate::failure::Failure;
use crate::options::{
    FrequencyOptions, ObjectOptions, RuntimeOptions, check_folder, make_folder, whole,
};
use crate::policies::{self, MAX_STEPS, TRIALS};
use crate::training::TrainingResult;
use crate::verbs::evaluate::parse_goal;
use crate::{Ended, exit, interrupt, object, show, training};

#[derive(Args)]
#[command(after_help = "Examples: pubs-engine train objects/door2.toml
          pubs-engine train objects/door2.toml --goal 0.5 --recipe paper --seeds 5
          pubs-engine train objects/door2.toml --goal 0.5 --method lstm1 --seeds 1")]
pub struct Arguments {
    #[command(flatten)]
    object: ObjectOptions,
    /// Train for this goal alone, as the paper [default: one policy for every goal; on an abstract joint the goal of its file]
    #[arg(long, value_name = "GOAL", allow_hyphen_values = true)]
    goal: Option<String>,
    /// `pubs`, or a baseline on raw observations: `ppo`, `lstm1`, `lstm2`
    #[arg(long, default_value = "pubs", value_name = "NAME")]
    method: Method,
    /// What the policy sees as entropy: `belief`, or an ablation: `random`, `none`
    #[arg(long, default_value = "belief", value_name = "NAME")]
    entropy: EntropyInput,
    #[command(flatten)]
    frequency: FrequencyOptions,
    /// Settings of PPO: `standard`, `benchmark`, or `paper` for the paper's [default: standard; on an abstract joint benchmark]
    #[arg(long, value_name = "NAME")]
    recipe: Option<String>,
    /// Steps of the surrogate to learn from, rounded up to whole rollouts [default: the recipe's, 500000; 1000000 of benchmark]
    #[arg(long, value_parser = whole::<u64>(1, u64::MAX))]
    steps: Option<u64>,
    /// Train so many seeds and keep the best
    #[arg(long, default_value_t = 3, value_parser = whole::<u64>(1, 1000))]
    seeds: u64,
    /// First of the seeds
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Trials on which seeds are compared
    #[arg(long, default_value_t = TRIALS, value_parser = whole::<u64>(1, u64::MAX))]
    trials: u64,
    /// Leave high-force actions unmasked, as the paper
    #[arg(long)]
    no_shield: bool,
    /// Write the policy here [default: policies/OBJECT.onnx, or OBJECT-GOAL.onnx; baselines and ablations with their name before it]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace a policy file that differs
    #[arg(long)]
    overwrite: bool,
    /// Trainings at once [default: one per core]
    #[arg(long, value_parser = whole::<u16>(1, u16::MAX.into()))]
    threads: Option<u16>,
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
    method: Method,
    entropy: EntropyInput,
    goal: String,
    recipe: &'static str,
    steps: usize,
    steps_per_s: f64,
    time_s: f64,
    seeds: Vec<SeedReport>,
    best: u64,
    evaluation: Evaluation,
}

#[derive(Serialize)]
struct SeedReport {
    seed: u64,
    time_s: f64,
    steps_per_s: f64,
    learning_s: f64,
    evaluation: Evaluation,
}

pub fn run(arguments: &Arguments) -> Ended {
    let registry = arguments.object.layers.plugins.registry();
    let ready = object::ready(
        &arguments.object.object,
        &arguments.object.layers.overrides(),
        arguments.frequency.belief_frequency,
        &registry,
        arguments.seed,
    )?;
    let runtime = arguments.runtime.runtime()?;
    let joint = &ready.task.joint;
    let goal = match &arguments.goal {
        None => ready.task.default_goal,
        Some(text) => Some(parse_goal(text, joint)?),
    };
    if !arguments.method.has_belief() && arguments.entropy != EntropyInput::Belief {
        return Err(Failure::invalid(format!(
            "--entropy {} is for `pubs`; `{}` reads no belief",
            arguments.entropy.name(),
            arguments.method.name()
        )));
    }
    let mut recipe = match &arguments.recipe {
        None => Recipe::usual(&ready.task, arguments.method.has_belief()),
        Some(name) => name
            .parse()
            .map_err(|error: pubs_train::UnknownRecipe| Failure::invalid(error.to_string()))?,
    };
    recipe.steps = arguments.steps.map_or(recipe.steps, |steps| steps as usize);
    let label = goal.map(|state| fraction_label(joint, state));
    let path = arguments.output.clone().unwrap_or_else(|| {
        policies::folder_of(&arguments.object.object).join(file_name(
            arguments,
            &ready.task.name,
            label.as_deref(),
        ))
    });
    if arguments.output.is_some() {
        check_folder(&path, "--output")?;
    }
    let shield = ready.task.policy.shield;
    let plan = TrainingPlan {
        method: arguments.method,
        entropy: arguments.entropy,
        recipe,
        goals: goal.map_or(Goals::Every, Goals::One),
        seeds: (arguments.seed..arguments.seed + arguments.seeds).collect(),
        trials: arguments.trials,
        max_steps: MAX_STEPS,
        // A shield looks at the belief, which the baselines do not have.
        shield: (!arguments.no_shield && arguments.method.has_belief()).then_some(shield),
        threads: arguments.threads.map(usize::from),
    };
    let existing = if arguments.overwrite {
        Existing::Replace
    } else {
        Existing::Keep
    };
    if let Some(folder) = path.parent() {
        make_folder(folder)?;
    }
    let interrupt = interrupt::flag()?;
    let result = training::train(&ready, &plan, &path, existing, &runtime, &interrupt)?;
    let report = report(&ready.task.name, label, &plan, path, result);
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&text(&report))?;
    }
    Ok(exit::DONE)
}

/// `door2.onnx`, `door2-0.5.onnx`; a baseline or an ablation says so, and is not what `run` looks
/// for.
fn file_name(arguments: &Arguments, object: &str, label: Option<&str>) -> String {
    let mut variant = Vec::new();
    if arguments.method != Method::Pubs {
        variant.push(arguments.method.name().to_owned());
    } else if arguments.entropy != EntropyInput::Belief {
        variant.push(format!("entropy_{}", arguments.entropy.name()));
    }
    if let Some(times) = arguments.frequency.belief_frequency {
        variant.push(format!("k{times}"));
    }
    let goal = label.map_or_else(String::new, |label| format!("-{label}"));
    if variant.is_empty() {
        return format!("{object}{goal}.onnx");
    }
    format!("{}_{object}{goal}.onnx", variant.join("_"))
}

fn report(
    object: &str,
    label: Option<String>,
    plan: &TrainingPlan,
    policy: PathBuf,
    result: TrainingResult,
) -> Report {
    let seed_report = |candidate: &pubs_evaluate::Candidate| SeedReport {
        seed: candidate.seed,
        time_s: candidate.time_s,
        steps_per_s: candidate.steps as f64 / candidate.time_s,
        learning_s: candidate.learning_s,
        evaluation: candidate.evaluation.clone(),
    };
    let best = &result.candidates[result.best];
    Report {
        policy,
        object: object.to_owned(),
        method: plan.method,
        entropy: plan.entropy,
        goal: label.unwrap_or_else(|| "every".to_owned()),
        recipe: plan.recipe.name,
        steps: best.steps,
        steps_per_s: best.steps as f64 / best.time_s,
        time_s: result
            .candidates
            .iter()
            .map(|candidate| candidate.time_s)
            .sum(),
        seeds: result.candidates.iter().map(seed_report).collect(),
        best: best.seed,
        evaluation: result.evaluation,
    }
}

fn text(report: &Report) -> String {
    let mut text = format!(
        "{}: goal {}, method {}{}, recipe {}, {} steps\n",
        report.object,
        report.goal,
        report.method,
        match report.entropy {
            EntropyInput::Belief => String::new(),
            other => format!(" (entropy {})", other.name()),
        },
        report.recipe,
        report.steps
    );
    for seed in &report.seeds {
        let kept = if seed.seed == report.best {
            "  <- kept"
        } else {
            ""
        };
        text += &format!(
            "  seed {:<3} {:>8.0} steps/s  {}{kept}\n",
            seed.seed,
            seed.steps_per_s,
            line(&seed.evaluation.figures)
        );
    }
    text += &format!(
        "  fresh trials              {}\n",
        line(&report.evaluation.figures)
    );
    text + &format!("policy: {}", report.policy.display())
}

fn line(figures: &Figures) -> String {
    format!(
        "discounted {:.3} ± {:.3}, success {:.2} %, violations {}, time-outs {} in {} trials",
        figures.mean_discounted_reward,
        figures.mean_discounted_reward_se,
        100.0 * figures.success_rate,
        figures.safety_violations,
        figures.time_outs,
        figures.trials,
    )
}
