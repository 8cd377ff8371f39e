//! The messages that runs alone have, written and read; `run_schema` describes them.

use serde::{Deserialize, Serialize};

use super::message::Time;
use super::steps::{BINS, BeliefStep, Choice, ChoiceVerdict, GuardStop, Limits, Tick};
use crate::messages::BeliefMessage;

#[derive(Serialize, Deserialize)]
pub(super) struct ControllerMessage {
    timestamp: Time,
    pub tick: u64,
    order_time: Time,
    pub stopping: bool,
    pub reading: bool,
}

impl From<&Tick> for ControllerMessage {
    fn from(tick: &Tick) -> Self {
        Self {
            timestamp: tick.time_ns.into(),
            tick: tick.tick,
            order_time: tick.order_ns.into(),
            stopping: tick.stopping,
            reading: tick.felt.is_some(),
        }
    }
}

impl ControllerMessage {
    /// The tick, for which a frame may already be there.
    pub fn tick(&self, felt: Option<(super::Frame, super::Observation)>) -> Tick {
        Tick {
            tick: self.tick,
            time_ns: self.timestamp.ns(),
            order_ns: self.order_time.ns(),
            stopping: self.stopping,
            felt,
        }
    }
}

#[derive(Serialize, Deserialize)]
struct Histogram {
    lower: f64,
    upper: f64,
    mass: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct BeliefJson {
    timestamp: Time,
    step: u64,
    tick: u64,
    valid: bool,
    mean: f64,
    entropy: f64,
    allowed: Vec<String>,
    readings: Vec<f64>,
    displacement: f64,
    speed_m_s: f64,
    recoveries: u32,
    error: Option<String>,
    histogram: Histogram,
}

impl BeliefJson {
    /// `range` is that of the histogram.
    pub fn new(step: &BeliefStep, actions: &[impl AsRef<str>], range: (f64, f64)) -> Self {
        let message = &step.message;
        let allowed = actions
            .iter()
            .enumerate()
            .filter(|(index, _)| message.allowed >> index & 1 == 1)
            .map(|(_, name)| name.as_ref().to_owned())
            .collect();
        Self {
            timestamp: step.time_ns.into(),
            step: message.step,
            tick: step.tick,
            valid: message.valid,
            mean: message.summary.mean,
            entropy: message.summary.entropy,
            allowed,
            readings: message.readings.map(f64::from).to_vec(),
            displacement: message.displacement,
            speed_m_s: message.speed_m_s,
            recoveries: step.recoveries,
            error: step.error.clone(),
            histogram: Histogram {
                lower: range.0,
                upper: range.1,
                mass: step.histogram.map(f64::from).to_vec(),
            },
        }
    }

    /// The step, or what is wrong with the message.
    pub fn step(self, actions: &[String]) -> Result<BeliefStep, String> {
        let mut message = BeliefMessage {
            step: self.step,
            allowed: allowed(&self.allowed, actions)?,
            displacement: self.displacement,
            speed_m_s: self.speed_m_s,
            valid: self.valid,
            ..BeliefMessage::default()
        };
        message.summary.mean = self.mean;
        message.summary.entropy = self.entropy;
        if self.readings.len() != message.readings.len() {
            return Err(format!("{} readings", self.readings.len()));
        }
        for (reading, value) in message.readings.iter_mut().zip(&self.readings) {
            *reading = *value as f32;
        }
        if self.histogram.mass.len() != BINS {
            return Err(format!("{} bins", self.histogram.mass.len()));
        }
        let mut histogram = [0.0; BINS];
        for (bin, value) in histogram.iter_mut().zip(&self.histogram.mass) {
            *bin = *value as f32;
        }
        Ok(BeliefStep {
            time_ns: self.timestamp.ns(),
            tick: self.tick,
            message,
            histogram,
            recoveries: self.recoveries,
            error: self.error,
        })
    }
}

fn allowed(names: &[String], actions: &[String]) -> Result<u64, String> {
    names.iter().try_fold(0, |bits, name| {
        let index = index_of(name, actions)?;
        Ok(bits | 1 << index)
    })
}

fn index_of(name: &str, actions: &[String]) -> Result<usize, String> {
    let found = actions.iter().position(|action| action == name);
    found.ok_or_else(|| {
        format!(
            "the action {name:?}; the header names {}",
            actions.join(", ")
        )
    })
}

#[derive(Serialize, Deserialize)]
pub(super) struct PolicyMessage {
    timestamp: Time,
    step: u64,
    belief: u64,
    truth: Option<f64>,
    goal: usize,
    action: String,
    verdict: ChoiceVerdict,
    error: Option<String>,
}

impl PolicyMessage {
    pub fn new(choice: &Choice, action: &str) -> Self {
        Self {
            timestamp: choice.time_ns.into(),
            step: choice.step,
            belief: choice.belief,
            truth: choice.truth,
            goal: choice.goal,
            action: action.to_owned(),
            verdict: choice.verdict,
            error: choice.error.clone(),
        }
    }

    /// The choice, or what is wrong with the message.
    pub fn choice(self, actions: &[String]) -> Result<Choice, String> {
        Ok(Choice {
            step: self.step,
            time_ns: self.timestamp.ns(),
            belief: self.belief,
            truth: self.truth,
            goal: self.goal,
            action: index_of(&self.action, actions)?,
            verdict: self.verdict,
            error: self.error,
        })
    }
}

#[derive(Serialize)]
struct GoalRegion {
    state: f64,
    from: f64,
    to: f64,
}

#[derive(Serialize)]
pub(super) struct LimitsMessage {
    timestamp: Time,
    unit: &'static str,
    lower: f64,
    upper: f64,
    goals: Vec<GoalRegion>,
}

impl LimitsMessage {
    pub fn new(time_ns: u64, limits: &Limits) -> Self {
        let region = |&state: &f64| GoalRegion {
            state,
            from: (state - limits.tolerance).max(limits.lower),
            to: (state + limits.tolerance).min(limits.upper),
        };
        Self {
            timestamp: time_ns.into(),
            unit: limits.unit,
            lower: limits.lower,
            upper: limits.upper,
            goals: limits.goals.iter().map(region).collect(),
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct DroppedMessage {
    pub timestamp: Time,
    pub entries: u64,
}

#[derive(Deserialize)]
pub(super) struct GuardIn {
    timestamp: Time,
    reason: String,
}

impl GuardIn {
    pub fn stop(self) -> GuardStop {
        GuardStop {
            time_ns: self.timestamp.ns(),
            reason: self.reason,
        }
    }
}
