//! The filter loop: follows the handle with the belief, eq. (6)–(10).

use std::sync::Arc;

use pubs_core::Task;
use pubs_core::belief::{BeliefError, Filter, Recovery, Update};
use pubs_core::observation::ArmObservation;
use pubs_core::shield::{self, Shield};

use crate::loops::Follower;
use crate::messages::{BeliefMessage, Sample};
use crate::recording::{BeliefStep, Tape, histogram};

/// So many recoveries are told in words; the rest are counted.
const NOTES: usize = 20;

/// State of the loop between two ticks.
pub struct FilterLoop {
    task: Arc<Task>,
    filter: Filter,
    channels: Vec<String>,
    shield: Option<Shield>,
    previous: Option<Sample>,
    steps: u64,
    observation: Vec<f32>,
    allowed: Vec<bool>,
    notes: Vec<String>,
    tape: Option<Tape>,
}

impl FilterLoop {
    /// A loop around a filter; `channels` are its model's, `tape` records every step.
    pub fn new(
        task: Arc<Task>,
        filter: Filter,
        channels: Vec<String>,
        shield: Option<Shield>,
        tape: Option<Tape>,
    ) -> Self {
        Self {
            observation: vec![0.0; channels.len()],
            allowed: vec![true; task.actions.len()],
            task,
            filter,
            channels,
            shield,
            previous: None,
            steps: 0,
            notes: Vec::new(),
            tape,
        }
    }

    /// The belief.
    pub fn filter(&self) -> &Filter {
        &self.filter
    }

    /// What the recovery rule did, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn belief(&mut self, sample: &Sample) -> Result<BeliefMessage, BeliefError> {
        if sample.valid {
            self.follow(sample)?;
        }
        shield::allowed(
            self.shield.as_ref(),
            &self.task,
            &self.filter,
            &mut self.allowed,
        );
        let bits = self
            .allowed
            .iter()
            .enumerate()
            .fold(0, |bits, (index, &allowed)| {
                bits | (u64::from(allowed) << index)
            });
        Ok(self.message(sample, bits))
    }

    fn message(&self, sample: &Sample, allowed: u64) -> BeliefMessage {
        let mut readings = BeliefMessage::default().readings;
        for (reading, observed) in readings.iter_mut().zip(&self.observation) {
            *reading = *observed;
        }
        BeliefMessage {
            step: self.steps,
            summary: self.filter.summary(),
            readings,
            allowed,
            displacement: sample.displacement,
            speed_m_s: sample.speed_m_s,
            valid: sample.valid,
        }
    }

    fn record(&self, now_ns: u64, sample: &Sample, result: &Result<BeliefMessage, String>) {
        let Some(tape) = &self.tape else {
            return;
        };
        let joint = &self.task.joint;
        tape.belief(BeliefStep {
            time_ns: now_ns,
            tick: sample.tick,
            message: result
                .as_ref()
                .map_or_else(|_| self.message(sample, 0), Clone::clone),
            histogram: histogram(
                self.filter.states(),
                self.filter.log_weights(),
                joint.lower,
                joint.upper,
            ),
            recoveries: self.filter.recoveries(),
            error: result.as_ref().err().cloned(),
        });
    }

    fn follow(&mut self, sample: &Sample) -> Result<(), BeliefError> {
        let Some(previous) = self.previous.replace(*sample) else {
            return Ok(());
        };
        let displacement = sample.displacement - previous.displacement;
        // Between two actions, and while the arm speeds up or turns round, the forces are not
        // those that the model describes; the motion counts all the same.
        if !(sample.settled && previous.settled && sample.action == previous.action) {
            self.filter.follow(displacement);
            return Ok(());
        }
        let threshold = self
            .task
            .joint
            .geometry()
            .map_or(0.0, |geometry| geometry.motion_threshold_m);
        let moved = displacement.abs() / self.task.joint.per_metre() > threshold;
        let [f_d, f_z, f_n] = sample.forces_n;
        let observation = ArmObservation {
            f_d,
            f_z,
            f_n,
            moved,
        };
        for (value, name) in self.observation.iter_mut().zip(&self.channels) {
            // Names were checked when the run was set up; a channel no arm has reads NaN, which
            // the filter refuses.
            *value = observation.channel(name).unwrap_or(f32::NAN);
        }
        if let Update::Recovered(recovery) =
            self.filter
                .update(sample.action, displacement, &self.observation)?
        {
            self.note(sample.action, &recovery);
        }
        Ok(())
    }

    fn note(&mut self, action: usize, recovery: &Recovery) {
        if self.notes.len() >= NOTES {
            return;
        }
        let readings = self.channels.iter().zip(&self.observation);
        let readings: Vec<String> = readings
            .map(|(name, value)| format!("{name} = {value:.2}"))
            .collect();
        self.notes.push(format!(
            "no particle fits {} during `{}` (log density {:.0}); the belief starts afresh",
            readings.join(", "),
            self.task.actions[action].name,
            recovery.log_density,
        ));
    }
}

impl Follower for FilterLoop {
    type Message = BeliefMessage;

    /// One tick with the newest sample. It fails where the belief cannot explain what is felt.
    fn step(&mut self, now_ns: u64, sample: &Sample) -> Result<BeliefMessage, String> {
        self.steps += 1;
        let result = self.belief(sample).map_err(|error| error.to_string());
        self.record(now_ns, sample, &result);
        result
    }
}
