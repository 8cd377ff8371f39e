//! Writing the recording of a run: frames, and what each loop saw.

use std::path::Path;

use mcap::records::Metadata;

use super::run_header::{RUN_METADATA, RunHeader};
use super::run_message::{
    BeliefJson, ControllerMessage, DroppedMessage, LimitsMessage, PolicyMessage,
};
use super::steps::{BeliefStep, Choice, Limits, Tick};
use super::topic::Topic;
use super::write::{OBJECT_ATTACHMENT, Preface, RecordingWriter, TOML};
use super::{Header, RecordingError};
use crate::clock::SECOND_NS;
use crate::report::RunReport;

/// Name under which the object file is attached with defaults and overrides in it.
pub(super) const RESOLVED_ATTACHMENT: &str = "object.resolved.toml";
/// Name under which the report of the whole run is attached, at the end.
pub(super) const REPORT_ATTACHMENT: &str = "report.json";

/// Name under which policy `index` is attached.
pub(super) fn policy_attachment(index: usize) -> String {
    format!("policy-{index}.onnx")
}

/// All that a run's recording begins with.
#[derive(Debug, Clone)]
pub struct RunPreface<'a> {
    /// As in every recording.
    pub header: &'a Header,
    /// How the run was set up.
    pub run: &'a RunHeader,
    /// The object file as it was read.
    pub object_toml: &'a str,
    /// The same with defaults and overrides in it: what a replay reads.
    pub resolved_toml: &'a str,
    /// Bytes of the policies, in the order of [`RunHeader::policies`].
    pub policies: Vec<&'a [u8]>,
}

impl RecordingWriter {
    /// Creates the recording of a run.
    ///
    /// # Errors
    /// Where the file exists already or cannot be created.
    pub fn create_run(file: &Path, preface: &RunPreface<'_>) -> Result<Self, RecordingError> {
        let names: Vec<String> = (0..preface.policies.len()).map(policy_attachment).collect();
        let mut attachments = vec![
            (OBJECT_ATTACHMENT, TOML, preface.object_toml.as_bytes()),
            (RESOLVED_ATTACHMENT, TOML, preface.resolved_toml.as_bytes()),
        ];
        for (name, bytes) in names.iter().zip(&preface.policies) {
            attachments.push((name, "application/octet-stream", bytes));
        }
        Self::create_with(
            file,
            &Preface {
                header: preface.header,
                metadata: vec![Metadata {
                    name: RUN_METADATA.to_owned(),
                    metadata: preface.run.to_fields(),
                }],
                attachments,
                topics: &Topic::OF_RUN,
                chunk_ns: SECOND_NS / 2,
            },
        )
    }

    pub(super) fn tick(&mut self, tick: &Tick) -> Result<(), RecordingError> {
        self.turn(tick.time_ns)?;
        if let Some((frame, observation)) = &tick.felt {
            self.felt(frame, Some(observation))?;
        }
        let message = ControllerMessage::from(tick);
        self.message(Topic::Controller, tick.time_ns, &message)?;
        match &tick.felt {
            Some((frame, _)) => self.acted(frame),
            None => Ok(()),
        }
    }

    pub(super) fn belief(
        &mut self,
        step: &BeliefStep,
        range: (f64, f64),
    ) -> Result<(), RecordingError> {
        self.turn(step.time_ns)?;
        let message = BeliefJson::new(step, &self.actions, range);
        self.message(Topic::Belief, step.time_ns, &message)
    }

    pub(super) fn choice(&mut self, choice: &Choice) -> Result<(), RecordingError> {
        self.turn(choice.time_ns)?;
        let message = PolicyMessage::new(choice, &self.action(choice.action)?);
        self.message(Topic::Policy, choice.time_ns, &message)
    }

    pub(super) fn limits(&mut self, time_ns: u64, limits: &Limits) -> Result<(), RecordingError> {
        let message = LimitsMessage::new(time_ns, limits);
        self.message(Topic::Limits, time_ns, &message)?;
        self.flush()
    }

    pub(super) fn dropped(&mut self, time_ns: u64, entries: u64) -> Result<(), RecordingError> {
        let message = DroppedMessage {
            timestamp: time_ns.into(),
            entries,
        };
        self.message(Topic::Dropped, time_ns, &message)
    }

    pub(super) fn report(&mut self, report: &RunReport) -> Result<(), RecordingError> {
        let text = serde_json::to_vec_pretty(report)
            .map_err(|error| RecordingError::write(self.file(), &error.into()))?;
        self.attach(REPORT_ATTACHMENT, &text)
    }
}
