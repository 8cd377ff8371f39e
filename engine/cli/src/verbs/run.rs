//! `pubs-engine run`: moves an object to its goals.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;
use pubs_core::{Joint, Task};
use pubs_policy::{FeatureName, PolicyFile, Runtime};
use pubs_run::{Actor, GoalPlan, GoalReport, Outcome, RunError, RunOptions, RunReport, Status};

use crate::driver::{self, DriverOptions};
use crate::failure::Failure;
use crate::live::{self, LiveOptions};
use crate::object::Ready;
use crate::options::{FrequencyOptions, ObjectOptions, RuntimeOptions, whole};
use crate::policies::{self, MAX_STEPS};
use crate::recorded::{self, RecordingOptions, Setup};
use crate::verbs::evaluate::parse_goal;
use crate::{Ended, exit, interrupt, object, show};

#[derive(Args)]
#[command(after_help = "Examples: pubs-engine run objects/door2.toml --goal 0.5
          pubs-engine run objects/door2.toml --goal 40deg --goal closed --lockstep --seed 7
          pubs-engine run objects/door2.toml --goal open --dashboard --wait-for-viewer
A goal is a fraction of the range (0.5), open, closed, middle, 40deg, 12cm, or @50 in the joint's own unit.")]
pub struct Arguments {
    #[command(flatten)]
    object: ObjectOptions,
    /// Goal; several are reached one after the other, keeping the belief
    #[arg(
        long = "goal",
        value_name = "GOAL",
        required = true,
        allow_hyphen_values = true
    )]
    goals: Vec<String>,
    /// Use this policy [default: one that fits from the folder of policies, or a new one]
    #[arg(long, value_name = "FILE")]
    policy: Option<PathBuf>,
    /// Folder of policies [default: policies, beside the object's folder]
    #[arg(long, value_name = "DIR")]
    policies: Option<PathBuf>,
    /// Inputs of a policy that was exported elsewhere and carries no contract, such as mean,entropy
    #[arg(long, value_delimiter = ',', value_name = "NAMES", requires = "policy")]
    inputs: Vec<FeatureName>,
    #[command(flatten)]
    driver: DriverOptions,
    #[command(flatten)]
    frequency: FrequencyOptions,
    /// Leave high-force actions unmasked, as the paper
    #[arg(long)]
    no_shield: bool,
    /// Give up a goal after so many policy steps
    #[arg(long, default_value_t = MAX_STEPS, value_parser = whole::<u32>(1, u32::MAX.into()))]
    max_steps: u32,
    /// Seed of everything that is drawn
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    runtime: RuntimeOptions,
    #[command(flatten)]
    recording: RecordingOptions,
    #[command(flatten)]
    live: LiveOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Ended {
    if cfg!(debug_assertions) {
        show::say("warning: this is a debug build; its loops will be late (use --release)");
    }
    let layers = &arguments.object.layers;
    let registry = layers.plugins.registry();
    let ready = object::ready(
        &arguments.object.object,
        &arguments.driver.overrides(layers),
        arguments.frequency.belief_frequency,
        &registry,
        arguments.seed,
    )?;
    if ready.task.control.is_none() {
        let error = RunError::Abstract(ready.task.name.clone());
        return Err(Failure::invalid(error.to_string()));
    }
    let goals = arguments
        .goals
        .iter()
        .map(|goal| parse_goal(goal, &ready.task.joint))
        .collect::<Result<Vec<f64>, Failure>>()?;
    let runtime = arguments.runtime.runtime()?;
    let interrupt = interrupt::flag()?;
    let file = policy(arguments, &ready, &goals, &runtime, &interrupt)?;
    let policy = Actor::open(&file, &runtime, ready.model.as_ref())
        .map_err(|error| Failure::incompatible(error.to_string()))?;
    let views = live::start(&arguments.live, &ready, &goals, &interrupt)?;
    let arm = driver::open(&ready.task, &registry, &arguments.driver, arguments.seed)?;
    driver::check_sensor(&ready.task, &arm, arguments.driver.accept_sensor)?;
    let setup = Setup {
        ready: &ready,
        object: &arguments.object.object,
        overrides: &arguments.driver.overrides(layers),
        belief_frequency: arguments.frequency.belief_frequency,
        policy: &file,
        runtime: &runtime,
        arm: &arm,
    };
    let options = RunOptions {
        goals: goals
            .iter()
            .map(|&state| GoalPlan { state, policy: 0 })
            .collect(),
        shield: (!arguments.no_shield).then_some(ready.task.policy.shield),
        max_steps: arguments.max_steps,
        lockstep: arguments.driver.lockstep,
        seed: arguments.seed,
        policy: file.path().display().to_string(),
        interrupt,
    };
    let recorder = recorded::recorder(&arguments.recording, &setup, &options, views.listeners())?;
    let bar = show::status_line();
    let mut watch = |status: &Status| bar.set_message(status_text(&ready.task, &goals, status));
    let report = pubs_run::run_recorded(
        &ready.task,
        Box::new(arm),
        Arc::clone(&ready.model),
        vec![policy],
        &options,
        recorder,
        &mut watch,
    );
    bar.finish_and_clear();
    views.finish();
    let report = report.map_err(|error| Failure::invalid(error.to_string()))?;
    for note in &report.notes {
        show::note(&format!("note: {note}"));
    }
    if let Some(reason) = &report.reason {
        show::say(&format!("stopped: {reason}"));
    }
    if let Some(trouble) = recorded::trouble(&report) {
        show::say(&format!("warning: {trouble}"));
    }
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&summary(&ready.task.joint, &report))?;
    }
    Ok(code(&report))
}

fn code(report: &RunReport) -> u8 {
    let code = |outcome: Outcome| match outcome {
        Outcome::Reached => exit::DONE,
        Outcome::Missed | Outcome::TimedOut => exit::MISSED,
        Outcome::SafetyStop => exit::SAFETY_STOP,
        Outcome::Fault => exit::FAULT,
    };
    let worst_goal = report.goals.iter().map(|goal| code(goal.outcome)).max();
    match (code(report.outcome), worst_goal) {
        (exit::DONE, Some(exit::DONE) | None) if recorded::trouble(report).is_some() => {
            exit::MISSED
        }
        (exit::DONE, worst_goal) => worst_goal.unwrap_or(exit::DONE),
        (other, _) => other,
    }
}

fn policy(
    arguments: &Arguments,
    ready: &Ready,
    goals: &[f64],
    runtime: &Runtime,
    interrupt: &AtomicBool,
) -> Result<PolicyFile, Failure> {
    let wanted: Vec<Option<f64>> = goals.iter().copied().map(Some).collect();
    let foreign = (!arguments.inputs.is_empty()).then_some(arguments.inputs.as_slice());
    match &arguments.policy {
        Some(path) => policies::named(path, foreign, &ready.task, &wanted),
        None => {
            let folder = arguments
                .policies
                .clone()
                .unwrap_or_else(|| policies::folder_of(&arguments.object.object));
            policies::found_or_trained(ready, &folder, &wanted, runtime, interrupt)
        }
    }
}

fn status_text(task: &Task, goals: &[f64], status: &Status) -> String {
    format!(
        "{:5.1} s  believed {} of goal {}  entropy {:.2}  {}  step {}",
        status.time_s,
        task.joint.display(status.summary.mean),
        task.joint.display(goals[status.goal.min(goals.len() - 1)]),
        status.summary.entropy,
        task.actions[status.action].name,
        status.steps,
    )
}

fn summary(joint: &Joint, report: &RunReport) -> String {
    let mut text = String::new();
    for goal in &report.goals {
        text += &goal_text(joint, goal);
    }
    let shield = if report.shield { "on" } else { "off" };
    text += &format!("policy {}, shield {shield}\n", report.policy);
    let violations = report
        .safety_violations
        .map_or_else(|| "unknown".to_owned(), |count| count.to_string());
    text += &format!(
        "{}: {} in {:.1} s, {} policy steps; safety violations {violations}, guard stops {}, belief recoveries {}\n",
        report.object,
        outcome_word(report.outcome),
        report.time_s,
        report.policy_steps,
        report.guard_stops,
        report.recoveries,
    );
    let loops = [
        ("controller", report.lateness.controller),
        ("filter", report.lateness.filter),
        ("policy", report.lateness.policy),
    ];
    for (name, late) in loops {
        text += &format!(
            "{name:<10} late by p50 {} µs, p99 {} µs, max {} µs; {} deadlines missed\n",
            late.p50_us, late.p99_us, late.max_us, late.missed
        );
    }
    text += &recorded::summary(report);
    text.trim_end().to_owned()
}

fn goal_text(joint: &Joint, goal: &GoalReport) -> String {
    let used: Vec<String> = goal
        .actions
        .iter()
        .filter(|&(_, &count)| count > 0)
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    let truth = match (goal.true_state, goal.goal_error) {
        (Some(state), Some(error)) => format!(
            "truly at {}, {} from the goal",
            joint.display(state),
            joint.display(error)
        ),
        _ => "judged by the belief; nobody knows the true state".to_owned(),
    };
    format!(
        "goal {}: {} in {:.1} s, believed at {} (entropy {:.2}), {truth}\n  actions: {}\n",
        joint.display(goal.goal),
        outcome_word(goal.outcome),
        goal.time_s,
        joint.display(goal.belief.mean),
        goal.belief.entropy,
        used.join(", "),
    )
}

fn outcome_word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Reached => "reached",
        Outcome::Missed => "missed",
        Outcome::TimedOut => "timed out",
        Outcome::SafetyStop => "stopped for safety",
        Outcome::Fault => "failed",
    }
}
