//! The numbers of a run.

use pubs_draw::document::{Block, Table};
use pubs_run::{GoalReport, JudgedBy, Outcome, RunReport};

use super::story::Story;
use crate::report::text::{or_nothing, state};
use crate::reproduce::numbers::{NOTHING, decimal};

/// Why the guard stopped the arm, numbered as in the pictures.
pub(super) fn guard_stops(story: &Story<'_>) -> Vec<Block> {
    let stops = &story.recording.guard_stops;
    if stops.is_empty() {
        return Vec::new();
    }
    let mut table = Table::new(&["", "time, s", "why the guard stopped the arm"]);
    for (number, stop) in (1..).zip(stops) {
        let time_s = decimal(story.time_s(stop.time_ns), 3);
        table.push([number.to_string(), time_s, stop.reason.clone()]);
    }
    vec![Block::Table(table)]
}

/// Outcome, goals, actions, loops; as far as the recording knows them.
pub(super) fn numbers(story: &Story<'_>) -> Vec<Block> {
    let Some(report) = &story.recording.report else {
        return unfinished(story);
    };
    let mut blocks = vec![
        Block::Table(summary(story, report)),
        Block::Subheading("Goals".to_owned()),
        Block::Table(goals(story, &report.goals)),
        Block::Subheading("Actions chosen".to_owned()),
        Block::Table(actions(story, &report.goals)),
        Block::Subheading("Lateness of the loops".to_owned()),
        Block::Table(lateness(report)),
    ];
    if !report.notes.is_empty() {
        blocks.push(Block::Subheading("Recoveries of the belief".to_owned()));
        blocks.push(Block::List(report.notes.clone()));
    }
    blocks
}

pub(super) fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Reached => "reached",
        Outcome::Missed => "missed",
        Outcome::TimedOut => "timed out",
        Outcome::SafetyStop => "stopped for safety",
        Outcome::Fault => "fault",
    }
}

fn judge(judged_by: JudgedBy) -> &'static str {
    match judged_by {
        JudgedBy::Truth => "the true state",
        JudgedBy::Belief => "the belief",
    }
}

fn summary(story: &Story<'_>, report: &RunReport) -> Table {
    let joint = &story.task.joint;
    let count = |count: u32| count.to_string();
    Table::pairs([
        ("outcome", outcome(report.outcome).to_owned()),
        ("judged by", judge(report.judged_by).to_owned()),
        ("time", format!("{} s", decimal(report.time_s, 3))),
        ("policy steps", count(report.policy_steps)),
        ("last goal", state(joint, report.goal)),
        ("believed at the end", state(joint, report.belief.mean)),
        ("entropy at the end", decimal(report.belief.entropy, 3)),
        (
            "true at the end",
            or_nothing(report.true_state, |found| state(joint, found)),
        ),
        (
            "off the goal by",
            or_nothing(report.goal_error, |found| state(joint, found)),
        ),
        (
            "safety violations",
            or_nothing(report.safety_violations, count),
        ),
        ("stops by the guard", count(report.guard_stops)),
        (
            "reason of the stop",
            report.reason.clone().unwrap_or_else(|| NOTHING.to_owned()),
        ),
        ("recoveries of the belief", count(report.recoveries)),
        (
            "entries the recording lacks",
            story.recording.dropped.to_string(),
        ),
    ])
}

fn goals(story: &Story<'_>, goals: &[GoalReport]) -> Table {
    let joint = &story.task.joint;
    let mut table = Table::new(&[
        "goal",
        "at",
        "outcome",
        "judged by",
        "time, s",
        "steps",
        "believed",
        "entropy",
        "true",
        "off by",
    ]);
    for (number, goal) in (1..).zip(goals) {
        table.push([
            number.to_string(),
            state(joint, goal.goal),
            outcome(goal.outcome).to_owned(),
            judge(goal.judged_by).to_owned(),
            decimal(goal.time_s, 2),
            goal.policy_steps.to_string(),
            state(joint, goal.belief.mean),
            decimal(goal.belief.entropy, 3),
            or_nothing(goal.true_state, |found| state(joint, found)),
            or_nothing(goal.goal_error, |found| state(joint, found)),
        ]);
    }
    table
}

fn actions(story: &Story<'_>, goals: &[GoalReport]) -> Table {
    let names = &story.recording.header.actions;
    let head = ["goal"].into_iter().chain(names.iter().map(String::as_str));
    let mut table = Table::new(&head.collect::<Vec<_>>());
    for (number, goal) in (1..).zip(goals) {
        let count = |name: &String| goal.actions.get(name).copied().unwrap_or(0).to_string();
        let number = [i32::to_string(&number)];
        table.push(number.into_iter().chain(names.iter().map(count)));
    }
    table
}

fn lateness(report: &RunReport) -> Table {
    let mut table = Table::new(&[
        "loop",
        "median, ms",
        "99 %, ms",
        "worst, ms",
        "ticks left out",
    ]);
    let loops = [
        ("controller", report.lateness.controller),
        ("filter", report.lateness.filter),
        ("policy", report.lateness.policy),
    ];
    for (name, found) in loops {
        let milliseconds = |us: u32| decimal(f64::from(us) / 1000.0, 3);
        table.push([
            name.to_owned(),
            milliseconds(found.p50_us),
            milliseconds(found.p99_us),
            milliseconds(found.max_us),
            found.missed.to_string(),
        ]);
    }
    table
}

/// What a recording without the run's own report still tells.
fn unfinished(story: &Story<'_>) -> Vec<Block> {
    let (recording, joint) = (story.recording, &story.task.joint);
    let last = recording
        .beliefs
        .iter()
        .rev()
        .find(|step| step.message.valid);
    let goals = recording
        .run
        .goals
        .iter()
        .map(|(goal, _)| state(joint, *goal));
    let table = Table::pairs([
        ("outcome", "not recorded".to_owned()),
        ("recorded time", format!("{} s", decimal(story.end_s(), 3))),
        ("ticks of the controller", recording.ticks.len().to_string()),
        ("steps of the filter", recording.beliefs.len().to_string()),
        ("steps of the policy", recording.choices.len().to_string()),
        ("goals asked for", goals.collect::<Vec<_>>().join(", ")),
        (
            "last belief recorded",
            or_nothing(last, |step| {
                let summary = step.message.summary;
                format!(
                    "{}, entropy {}",
                    state(joint, summary.mean),
                    decimal(summary.entropy, 3)
                )
            }),
        ),
        ("entries the recording lacks", recording.dropped.to_string()),
    ]);
    vec![Block::Table(table)]
}
