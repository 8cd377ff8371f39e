//! What a viewer needs to know once: the joint, the goals, the actions, the calibrated forces.

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_core::joint::JointKind;
use pubs_plugin::{Support, Transitions};
use serde::Serialize;

use crate::LiveError;

/// States at which the calibrated forces are told, evenly over the range.
const STATES: usize = 201;

/// What is known before the run. States are in SI, as in the recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// Name of the object.
    pub object: String,
    /// The joint.
    pub joint: JointScene,
    /// Goals in turn.
    pub goals: Vec<GoalScene>,
    /// In index order.
    pub actions: Vec<ActionScene>,
    /// Ticks per second of each loop.
    pub rates_hz: RatesScene,
    /// What the observation model expects of each action that moves; empty where it has no moments.
    pub bands: Vec<BandScene>,
    /// States of the bands.
    pub states: Vec<f64>,
}

/// The joint as it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointScene {
    /// `revolute` or `prismatic`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Unit in which people read states: `deg` or `cm`.
    pub shown_unit: &'static str,
    /// By which a state is multiplied to be in that unit.
    pub shown_per_si: f64,
    /// Closed (rad or m).
    pub lower: f64,
    /// Open (rad or m).
    pub upper: f64,
    /// Hinge axis to handle, m; 0 for a slide.
    pub radius_m: f64,
}

/// A goal and its region (rad or m).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GoalScene {
    /// s_g.
    pub state: f64,
    /// Where the region begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

/// An action.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ActionScene {
    /// Its name.
    pub name: String,
    /// Whether it moves in high-force mode.
    pub high_force: bool,
    /// +1 towards open, −1 towards closed, 0 for stop.
    pub sign: f64,
}

/// Ticks per second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RatesScene {
    /// Of the controller.
    pub controller: f64,
    /// Of the filter.
    pub filter: f64,
    /// Of the policy.
    pub policy: f64,
}

/// What is expected of one action.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BandScene {
    /// Name of the action.
    pub action: String,
    /// Each channel of the model.
    pub channels: Vec<ChannelBand>,
}

/// Mean and standard deviation at each of the states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelBand {
    /// Name of the channel: `f_d`, `f_z`, `f_n` or `m_p`.
    pub name: String,
    /// N; for `m_p` a probability.
    pub mean: Vec<f32>,
    /// N.
    pub sigma: Vec<f32>,
}

impl Scene {
    /// Of a run of a task to these goals (rad or m).
    ///
    /// # Errors
    /// Where the model fails.
    pub fn of(task: &Task, model: &dyn Model, goals: &[f64]) -> Result<Self, LiveError> {
        let joint = &task.joint;
        let tolerance = task.reward.goal_tolerance;
        let goal = |&state: &f64| GoalScene {
            state,
            from: (state - tolerance).max(joint.lower),
            to: (state + tolerance).min(joint.upper),
        };
        let action = |action: &pubs_core::action::Action| ActionScene {
            name: action.name.clone(),
            high_force: action.is_high_force(),
            sign: action.sign(),
        };
        let last = (STATES - 1) as f64;
        let states: Vec<f64> = (0..STATES)
            .map(|index| joint.at_fraction(index as f64 / last))
            .collect();
        Ok(Self {
            object: task.name.clone(),
            joint: JointScene::of(&joint.kind, (joint.lower, joint.upper)),
            goals: goals.iter().map(goal).collect(),
            actions: task.actions.iter().map(action).collect(),
            rates_hz: RatesScene {
                controller: task.control.map_or(0.0, |control| control.rate_hz),
                filter: task.belief.rate_hz,
                policy: task.policy.rate_hz,
            },
            bands: bands(task, model, &states)?,
            states,
        })
    }
}

impl JointScene {
    fn of(kind: &JointKind, (lower, upper): (f64, f64)) -> Self {
        let (shown_unit, shown_per_si) = kind.shown_unit();
        let (kind, radius_m) = match *kind {
            JointKind::Revolute { radius_m, .. } => ("revolute", radius_m),
            JointKind::Prismatic { .. } => ("prismatic", 0.0),
            JointKind::Abstract { .. } => ("abstract", 0.0),
        };
        Self {
            kind,
            shown_unit,
            shown_per_si,
            lower,
            upper,
            radius_m,
        }
    }
}

fn bands(task: &Task, model: &dyn Model, states: &[f64]) -> Result<Vec<BandScene>, LiveError> {
    let states: Vec<f32> = states.iter().map(|&state| state as f32).collect();
    let mut bands = Vec::new();
    for (index, action) in task.actions.iter().enumerate() {
        if action.is_stop() {
            continue;
        }
        if let Some(channels) = channels(model, index, &states)? {
            bands.push(BandScene {
                action: action.name.clone(),
                channels,
            });
        }
    }
    Ok(bands)
}

/// `None` where the model has no moments.
fn channels(
    model: &dyn Model,
    action: usize,
    states: &[f32],
) -> Result<Option<Vec<ChannelBand>>, LiveError> {
    let names = model.channels();
    let mut mean = vec![0.0; names.len() * states.len()];
    let mut sigma = mean.clone();
    let transitions = Transitions {
        action,
        before: states,
        after: states,
    };
    if model.moments(transitions, &mut mean, &mut sigma)? == Support::Absent {
        return Ok(None);
    }
    let rows = mean.chunks(states.len()).zip(sigma.chunks(states.len()));
    let band = |(channel, (mean, sigma)): (&pubs_plugin::Channel, (&[f32], &[f32]))| ChannelBand {
        name: channel.name.clone(),
        mean: mean.to_vec(),
        sigma: sigma.to_vec(),
    };
    Ok(Some(names.iter().zip(rows).map(band).collect()))
}
