//! Setting up a run and summing it up.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pubs_core::Task;
use pubs_core::belief::{Filter, Model, ModelError};
use pubs_core::observation::ARM_CHANNELS;
use pubs_core::seed::stream;
use pubs_core::shield::Shield;

use crate::actor::Actor;
use crate::arm::Arm;
use crate::filter_loop::FilterLoop;
use crate::grip::GripWatch;
use crate::guard::Trip;
use crate::loops::{Drive, Driven, Period, Rates, Tap};
use crate::messages::{Signals, Status};
use crate::policy_loop::PolicyLoop;
use crate::recording::RunRecorder;
use crate::report::{Outcome, RunReport};

/// One goal and which of the policies serves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoalPlan {
    /// s_g (rad or m).
    pub state: f64,
    /// Index into the policies.
    pub policy: usize,
}

/// How to run.
#[derive(Clone)]
pub struct RunOptions {
    /// Goals, reached one after the other with one belief.
    pub goals: Vec<GoalPlan>,
    /// Mask of high-force actions; `None` is the paper's way.
    pub shield: Option<Shield>,
    /// Policy steps allowed for each goal.
    pub max_steps: u32,
    /// On a virtual clock instead of in real time.
    pub lockstep: bool,
    /// Seed, for the report; driver and model were made with streams of it.
    pub seed: u64,
    /// The policy's name, for the report.
    pub policy: String,
    /// Set from outside to stop.
    pub interrupt: Arc<AtomicBool>,
}

/// Why a run could not begin.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RunError {
    /// An abstract object.
    #[error("object `{0}` has an abstract joint; no robot can move it, `evaluate` runs it")]
    Abstract(String),
    /// No goals.
    #[error("there is no goal to reach")]
    NoGoal,
    /// The model observes what no arm gives.
    #[error("the observation model has a channel `{channel}`; an arm gives {}", ARM_CHANNELS.join(", "))]
    Channel {
        /// Its name.
        channel: String,
    },
    /// The observation model fails.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A goal of a policy that is not there.
    #[error("a goal asks for policy {policy} of {policies}")]
    NoPolicy {
        /// Its index.
        policy: usize,
        /// How many there are.
        policies: usize,
    },
    /// A recording that names other actions than its object.
    #[error("the recording names the actions {}; its object has {}", recorded.join(", "), actions.join(", "))]
    Actions {
        /// In the recording.
        recorded: Vec<String>,
        /// Of the object.
        actions: Vec<String>,
    },
    /// A policy with the wrong number of actions.
    #[error("a policy chooses among {outputs} actions; this object has {actions}")]
    PolicyShape {
        /// Outputs of the policy.
        outputs: usize,
        /// Actions of the object.
        actions: usize,
    },
}

/// Runs to the last goal, or to a stop. `watch` is called a few times per second, from another
/// thread than the loops (in lockstep: at each policy step).
///
/// # Errors
/// [`RunError`] before anything moves; later trouble is in the report.
pub fn run(
    task: &Arc<Task>,
    arm: Box<dyn Arm>,
    model: Arc<dyn Model>,
    policies: Vec<Actor>,
    options: &RunOptions,
    watch: &mut dyn FnMut(&Status),
) -> Result<RunReport, RunError> {
    run_recorded(task, arm, model, policies, options, None, watch)
}

/// The same, and a recorder keeps what happens; trouble with it never stops the arm and is in the
/// report.
///
/// # Errors
/// [`RunError`] before anything moves; later trouble is in the report.
pub fn run_recorded(
    task: &Arc<Task>,
    arm: Box<dyn Arm>,
    model: Arc<dyn Model>,
    policies: Vec<Actor>,
    options: &RunOptions,
    recorder: Option<RunRecorder>,
    watch: &mut dyn FnMut(&Status),
) -> Result<RunReport, RunError> {
    let control = task
        .control
        .ok_or_else(|| RunError::Abstract(task.name.clone()))?;
    let channels = checked(task, model.as_ref(), &policies, &options.goals)?;
    let grip = GripWatch::new(task, &control, model.as_ref())?;
    let signals = Signals::new();
    let filter = Filter::new(task, model);
    let vector_unit = filter.vector_unit().to_string();
    let tape = recorder.as_ref().map(RunRecorder::tape);
    let follower = FilterLoop::new(
        Arc::clone(task),
        filter,
        channels,
        options.shield,
        tape.clone(),
    );
    let chooser = PolicyLoop::new(
        Arc::clone(task),
        policies,
        options.goals.clone(),
        options.max_steps,
        signals.clone(),
        stream(options.seed, "random entropy"),
        tape.clone(),
    );
    let rates = Rates {
        names: ["filter", "policy"],
        follower_hz: task.belief.rate_hz,
        chooser_hz: task.policy.rate_hz,
    };
    let drive = Drive::new(
        task,
        control,
        arm,
        follower,
        chooser,
        &rates,
        signals.clone(),
        tape.map(|tape| Box::new(move |period: &Period<'_>| tape.period(period)) as Tap),
        Arc::clone(&options.interrupt),
    )
    .watching(grip);
    let driven = drive.run(options.lockstep, watch);
    let end_ns = driven.end_ns;
    let report = sum_up(task, options, &signals, vector_unit, driven);
    Ok(match recorder {
        Some(recorder) => close(recorder, end_ns, report),
        None => report,
    })
}

/// Writes the last words of a recording; the report with what became of it.
fn close(recorder: RunRecorder, end_ns: u64, report: RunReport) -> RunReport {
    let file = recorder.file().map(|file| file.display().to_string());
    let finished = recorder.finish(end_ns, &report);
    if file.is_none() {
        return report;
    }
    RunReport {
        recording: file,
        recording_dropped: finished.dropped,
        recording_fault: finished.result.err().map(|error| error.to_string()),
        ..report
    }
}

/// The channels of the model, where goals, policies and model fit the task.
pub(crate) fn checked(
    task: &Task,
    model: &dyn Model,
    policies: &[Actor],
    goals: &[GoalPlan],
) -> Result<Vec<String>, RunError> {
    if goals.is_empty() {
        return Err(RunError::NoGoal);
    }
    if let Some(goal) = goals.iter().find(|goal| goal.policy >= policies.len()) {
        return Err(RunError::NoPolicy {
            policy: goal.policy,
            policies: policies.len(),
        });
    }
    let channels = model.channels().iter();
    let channels: Vec<String> = channels.map(|channel| channel.name.clone()).collect();
    if let Some(channel) = channels
        .iter()
        .find(|channel| !ARM_CHANNELS.contains(&channel.as_str()))
    {
        return Err(RunError::Channel {
            channel: channel.clone(),
        });
    }
    let misfit = |policy: &&Actor| policy.actions() != task.actions.len();
    match policies.iter().find(misfit) {
        None => Ok(channels),
        Some(policy) => Err(RunError::PolicyShape {
            outputs: policy.actions(),
            actions: task.actions.len(),
        }),
    }
}

fn sum_up(
    task: &Task,
    options: &RunOptions,
    signals: &Signals,
    vector_unit: String,
    mut driven: Driven<FilterLoop, PolicyLoop>,
) -> RunReport {
    let stopped = driven.trip.as_ref().map(|trip| match trip.is_fault() {
        true => Outcome::Fault,
        false => Outcome::SafetyStop,
    });
    // A goal that was under way when the arm was stopped ends with that stop.
    driven
        .chooser
        .judge(driven.end_ns, Some(stopped.unwrap_or(Outcome::Fault)));
    let (recoveries, notes) = driven
        .follower
        .as_ref()
        .map_or_else(Default::default, |filter| {
            (filter.filter().recoveries(), filter.notes().to_vec())
        });
    let goals = driven.chooser.into_reports();
    let last = goals[goals.len() - 1].clone();
    let violated = matches!(driven.trip, Some(Trip::Violation { .. }));
    RunReport {
        object: task.name.clone(),
        policy: options.policy.clone(),
        shield: options.shield.is_some(),
        outcome: stopped.unwrap_or(last.outcome),
        judged_by: last.judged_by,
        goal: last.goal,
        belief: last.belief,
        true_state: last.true_state,
        goal_error: last.goal_error,
        time_s: driven.time_s,
        policy_steps: goals.iter().map(|goal| goal.policy_steps).sum(),
        safety_violations: signals.truth().map(|_| u32::from(violated)),
        guard_stops: u32::from(driven.trip.is_some() && !violated),
        reason: driven.trip.map(|trip| trip.to_string()),
        lateness: driven.lateness,
        real_time: driven.real_time,
        recording: None,
        recording_dropped: 0,
        recording_fault: None,
        recoveries,
        notes,
        vector_unit,
        seed: options.seed,
        goals,
    }
}
