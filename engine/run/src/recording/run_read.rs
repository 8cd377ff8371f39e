//! Reading the recording of a run back, whole or what is left of it.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::error::BadMessage;
use super::read::{bytes_of, frames, header_of, loss};
use super::records::{Contents, RawMessage, contents};
use super::run_header::RunHeader;
use super::run_message::{BeliefJson, ControllerMessage, DroppedMessage, GuardIn, PolicyMessage};
use super::run_write::{REPORT_ATTACHMENT, RESOLVED_ATTACHMENT, policy_attachment};
use super::steps::{BeliefStep, Choice, GuardStop, Tick};
use super::topic::Topic;
use super::write::OBJECT_ATTACHMENT;
use super::{FORMAT_VERSION, Frame, Header, Observation, RUN_FORMAT_VERSION, RecordingError};
use crate::report::RunReport;

/// The recording of a run, read back.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRecording {
    /// What every recording says of itself.
    pub header: Header,
    /// How the run was set up.
    pub run: RunHeader,
    /// The object file as it was; `None` where it is damaged.
    pub object_toml: Option<String>,
    /// The object file with defaults and overrides in it.
    pub resolved_toml: String,
    /// Bytes of the policies, in the order of [`RunHeader::policies`].
    pub policies: Vec<Vec<u8>>,
    /// Ticks of the controller, in order.
    pub ticks: Vec<Tick>,
    /// Steps of the filter, in order.
    pub beliefs: Vec<BeliefStep>,
    /// Steps of the policy, in order.
    pub choices: Vec<Choice>,
    /// When the guard stopped the arm, and why.
    pub guard_stops: Vec<GuardStop>,
    /// What the run gave back; `None` where the file ends before it, or another version wrote it.
    pub report: Option<RunReport>,
    /// Entries that were dropped because the disk was too slow.
    pub dropped: u64,
    /// What was lost, in words for the user, where the file is cut off or damaged.
    pub loss: Option<String>,
}

/// Reads the recording of a run. Of a file that is cut off or damaged everything readable is
/// returned, and [`RunRecording::loss`] says what is missing.
///
/// # Errors
/// Where the file is no recording, or not of a run, or one of another version of the format, or
/// ends before what a replay cannot do without; the first message that cannot be used.
pub fn read_run(file: &Path) -> Result<RunRecording, RecordingError> {
    let bytes = bytes_of(file)?;
    let contents = contents(&bytes);
    let header = header_of(file, &contents, &[FORMAT_VERSION, RUN_FORMAT_VERSION])?;
    if header.format != RUN_FORMAT_VERSION {
        return Err(RecordingError::NoRun {
            file: file.to_owned(),
            format: header.format,
        });
    }
    let lacks = |part: String| RecordingError::Lacks {
        file: file.to_owned(),
        part,
    };
    let fields = contents.run_metadata.as_ref();
    let fields = fields.ok_or_else(|| lacks("the metadata of the run".to_owned()))?;
    let run = RunHeader::from_fields(fields)
        .map_err(|fault| lacks(format!("the metadata of the run ({fault})")))?;
    let attached = |name: &str| {
        let found = contents.attachments.get(name).map(|bytes| bytes.to_vec());
        found.ok_or_else(|| lacks(format!("the attachment {name}")))
    };
    let readable = |name: &str| attached(name).ok();
    let resolved_toml = String::from_utf8(attached(RESOLVED_ATTACHMENT)?)
        .map_err(|_| lacks(format!("the attachment {RESOLVED_ATTACHMENT}")))?;
    let policies = (0..run.policies.len())
        .map(|index| attached(&policy_attachment(index)))
        .collect::<Result<_, _>>()?;
    let joined = frames(file, &header, &contents)?;
    let reader = Reader {
        file,
        contents: &contents,
        start_ns: joined.start_ns.unwrap_or(0),
    };
    let controller = reader.all(Topic::Controller, |message: ControllerMessage| Ok(message))?;
    let observations = reader.all(Topic::Observation, |message: ObservationIn| {
        Ok(message.observation())
    })?;
    let dropped = reader.all(
        Topic::Dropped,
        |message: DroppedMessage| Ok(message.entries),
    )?;
    Ok(RunRecording {
        ticks: ticks(controller, &joined.frames, observations),
        beliefs: reader.all(Topic::Belief, |message: BeliefJson| {
            message.step(&header.actions)
        })?,
        choices: reader.all(Topic::Policy, |message: PolicyMessage| {
            message.choice(&header.actions)
        })?,
        guard_stops: reader.all(Topic::Guard, |message: GuardIn| Ok(message.stop()))?,
        object_toml: readable(OBJECT_ATTACHMENT).and_then(|bytes| String::from_utf8(bytes).ok()),
        report: readable(REPORT_ATTACHMENT).and_then(|bytes| serde_json::from_slice(&bytes).ok()),
        dropped: dropped.into_iter().max().unwrap_or(0),
        loss: loss(&contents, &joined),
        header,
        run,
        resolved_toml,
        policies,
    })
}

/// Ticks with a reading take the frames in turn; the last may have lost its own at a cut.
fn ticks(
    controller: Vec<ControllerMessage>,
    frames: &[Frame],
    observations: Vec<Observation>,
) -> Vec<Tick> {
    let mut felt = frames.iter().copied().zip(observations);
    let with_frame = |message: ControllerMessage| {
        if message.reading {
            felt.next().map(|felt| message.tick(Some(felt)))
        } else {
            Some(message.tick(None))
        }
    };
    controller.into_iter().map_while(with_frame).collect()
}

#[derive(serde::Deserialize)]
struct ObservationIn {
    displacement: f64,
    f_d: f64,
    f_z: f64,
    f_n: f64,
}

impl ObservationIn {
    fn observation(&self) -> Observation {
        Observation {
            displacement: self.displacement,
            forces_n: [self.f_d, self.f_z, self.f_n],
        }
    }
}

struct Reader<'a> {
    file: &'a Path,
    contents: &'a Contents<'a>,
    start_ns: u64,
}

impl Reader<'_> {
    /// All messages on a topic.
    fn all<M: DeserializeOwned, T>(
        &self,
        topic: Topic,
        make: impl Fn(M) -> Result<T, String>,
    ) -> Result<Vec<T>, RecordingError> {
        let on_topic = |message: &&RawMessage<'_>| {
            let name = self.contents.topics.get(&message.channel);
            name.is_some_and(|name| name == topic.name())
        };
        let mut all = Vec::new();
        for message in self.contents.messages.iter().filter(on_topic) {
            let made = serde_json::from_slice(message.data)
                .map_err(|error| error.to_string())
                .and_then(&make);
            match made {
                Ok(made) => all.push(made),
                // The cut may have gone through what looks like a whole message.
                Err(_) if message.doubtful => break,
                Err(found) => return Err(self.bad(topic, all.len() + 1, message, found)),
            }
        }
        Ok(all)
    }

    fn bad(
        &self,
        topic: Topic,
        number: usize,
        message: &RawMessage<'_>,
        found: String,
    ) -> RecordingError {
        RecordingError::Message(Box::new(BadMessage {
            file: self.file.to_owned(),
            topic: topic.name(),
            number,
            time_s: (message.time_ns as f64 - self.start_ns as f64) * 1e-9,
            field: "the message".to_owned(),
            found,
            rule: topic.schema_name().to_owned(),
        }))
    }
}
