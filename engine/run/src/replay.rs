//! Replay: the driver's data of a recorded run, through today's controller, filter and policy.
//!
//! Each loop is shown just what it saw in the run: the controller each reading with the order that
//! was in force, the filter today's sample of the tick it took in, the policy today's belief of the
//! step it took in. So a replay is exact in lockstep and in real time alike, and where something
//! differs, the first place is where the cause is. Where data is missing, what a loop remembers is
//! lost, and its replay ends there.

mod compare;
mod report;

use std::collections::HashMap;
use std::sync::Arc;

use pubs_core::Task;
use pubs_core::belief::{Filter, Model};
use pubs_core::controller::Control;
use pubs_core::seed::stream;
use pubs_core::shield::Shield;
use pubs_core::vector::VectorUnit;

pub use compare::Tolerances;
pub use report::{Compared, Difference, ReplayReport};

use crate::actor::Actor;
use crate::filter_loop::FilterLoop;
use crate::loops::{Chooser, Follower};
use crate::messages::{BeliefMessage, Order, Sample, Signals};
use crate::motion::Motion;
use crate::policy_loop::PolicyLoop;
use crate::recording::{ChoiceVerdict, RunRecording, Tick};
use crate::run::{GoalPlan, RunError, checked};
use compare::Comparison;

/// Replays a run; `task`, `model` and `policies` are made of what the recording holds.
///
/// # Errors
/// [`RunError`] where what the recording holds does not belong together.
pub fn replay(
    recording: &RunRecording,
    task: &Arc<Task>,
    model: Arc<dyn Model>,
    policies: Vec<Actor>,
    tolerances: &Tolerances,
) -> Result<ReplayReport, RunError> {
    let control = task
        .control
        .ok_or_else(|| RunError::Abstract(task.name.clone()))?;
    let goals = recording.run.goals.iter();
    let goals: Vec<_> = goals
        .map(|&(state, policy)| GoalPlan { state, policy })
        .collect();
    let channels = checked(task, model.as_ref(), &policies, &goals)?;
    same_actions(recording, task)?;
    let start_ns = recording.ticks.first().map_or(0, |tick| tick.time_ns);
    let mut comparison = Comparison::new(recording, *tolerances, start_ns);
    let unit = VectorUnit::by_name(&recording.run.vector_unit).unwrap_or_else(VectorUnit::best);
    let samples = samples(recording, task, control, &mut comparison);
    let filter = Filter::on(unit, task, model);
    let shield = recording.run.shield;
    let shield = shield.map(|(mass, flattening)| Shield { mass, flattening });
    let follower = FilterLoop::new(Arc::clone(task), filter, channels, shield, None);
    let beliefs = beliefs(recording, follower, &samples, &mut comparison);
    let signals = Signals::new();
    let chooser = PolicyLoop::new(
        Arc::clone(task),
        policies,
        goals,
        recording.run.max_steps,
        signals.clone(),
        stream(recording.header.seed, "random entropy"),
        None,
    );
    choices(recording, chooser, &signals, &beliefs, &mut comparison);
    Ok(comparison.report(unit.to_string()))
}

/// Numbers in a recording stand for the actions that its header names.
fn same_actions(recording: &RunRecording, task: &Task) -> Result<(), RunError> {
    let actions = task.actions.iter();
    let actions: Vec<_> = actions.map(|action| action.name.clone()).collect();
    if recording.header.actions == actions {
        return Ok(());
    }
    Err(RunError::Actions {
        recorded: recording.header.actions.clone(),
        actions,
    })
}

/// Today's sample of each tick that had a reading.
fn samples(
    recording: &RunRecording,
    task: &Arc<Task>,
    control: Control,
    comparison: &mut Comparison<'_>,
) -> HashMap<u64, Sample> {
    let mut motion = Motion::new(Arc::clone(task), control);
    let mut samples = HashMap::new();
    for (number, tick) in (1..).zip(&recording.ticks) {
        if tick.tick != number {
            comparison.gap(tick.time_ns, "/controller", number);
            break;
        }
        match sample_of(&mut motion, tick) {
            None => motion.brake(),
            Some(sample) => {
                comparison.sample(tick, &sample);
                samples.insert(number, sample);
            }
        }
    }
    samples
}

fn sample_of(motion: &mut Motion, tick: &Tick) -> Option<Sample> {
    let (frame, _) = tick.felt.as_ref()?;
    let order = Order {
        time_ns: tick.order_ns,
        action: frame.action,
        demonstration: frame.demonstration,
        valid: true,
    };
    motion.follow(
        tick.tick,
        &frame.reading,
        &order,
        tick.stopping,
        tick.time_ns,
    )
}

/// Today's belief of each step.
fn beliefs(
    recording: &RunRecording,
    mut follower: FilterLoop,
    samples: &HashMap<u64, Sample>,
    comparison: &mut Comparison<'_>,
) -> HashMap<u64, BeliefMessage> {
    let mut beliefs = HashMap::new();
    for (number, step) in (1..).zip(&recording.beliefs) {
        if step.message.step != number {
            comparison.gap(step.time_ns, "/belief", number);
            break;
        }
        let sample = match step.tick {
            0 => Sample::default(),
            tick => match samples.get(&tick) {
                Some(sample) => *sample,
                None => {
                    comparison.lacks(step.time_ns, "/controller", tick);
                    break;
                }
            },
        };
        let result = follower.step(step.time_ns, &sample);
        comparison.belief(step, &result);
        if let Ok(message) = result {
            beliefs.insert(number, message);
        }
    }
    beliefs
}

/// Today's choices.
fn choices(
    recording: &RunRecording,
    mut chooser: PolicyLoop,
    signals: &Signals,
    beliefs: &HashMap<u64, BeliefMessage>,
    comparison: &mut Comparison<'_>,
) {
    for (number, choice) in (1..).zip(&recording.choices) {
        if choice.step != number {
            comparison.gap(choice.time_ns, "/policy", number);
            break;
        }
        let belief = match choice.belief {
            0 => BeliefMessage::default(),
            step => match beliefs.get(&step) {
                Some(belief) => *belief,
                None => {
                    comparison.lacks(choice.time_ns, "/belief", step);
                    break;
                }
            },
        };
        signals.set_truth(choice.truth);
        let result = chooser
            .step(choice.time_ns, &belief)
            .map(|(order, verdict)| (order.action, ChoiceVerdict::from(&verdict)));
        comparison.choice(choice, &result);
    }
}
