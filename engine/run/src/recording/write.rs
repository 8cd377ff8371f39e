//! Writing a recording: an MCAP file that can be read up to a second before whatever ends it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, WriteOptions};
use serde::Serialize;

use super::listen::{Listener, Message};
use super::message::{
    ActionMessage, DemonstrationMessage, GuardMessage, ObservationMessage, PoseMessage,
    TimingMessage, TruthMessage, WrenchMessage,
};
use super::topic::Topic;
use super::{Done, Frame, Header, METADATA, Observation, RecordingError};
use crate::clock::SECOND_NS;
use crate::report::{LatenessReport, RunReport};

/// Name under which the object file's text is attached.
pub(super) const OBJECT_ATTACHMENT: &str = "object.toml";
/// Media type of that.
pub(super) const TOML: &str = "application/toml";
/// Media type of reports.
const JSON: &str = "application/json";

/// Writes a recording. A chunk is closed and handed to the operating system with every second of
/// frames (of a run: every half), and after what comes seldom: a demonstration's end, the guard's
/// reason, the timing. A program that is killed loses no more than that.
///
/// Whoever listens ([`listen`](Self::listen)) is given the very bytes, whether or not a file keeps
/// them.
pub struct RecordingWriter {
    /// What the file is called; errors name it.
    file: PathBuf,
    kept: Option<Kept>,
    pub(super) actions: Vec<Arc<str>>,
    frames: u32,
    buffer: Vec<u8>,
    listeners: Vec<Box<dyn Listener>>,
}

/// The file.
struct Kept {
    mcap: mcap::Writer<BufWriter<File>>,
    /// In the order of [`Topic::ALL`]; `None` for topics that such a recording does not have.
    channels: Vec<Option<u16>>,
    chunk_ns: u64,
    chunk_start_ns: Option<u64>,
}

/// What stands at the start of a file.
pub(super) struct Preface<'a> {
    pub header: &'a Header,
    /// Further metadata.
    pub metadata: Vec<Metadata>,
    /// Name, media type and content of what is attached.
    pub attachments: Vec<(&'a str, &'a str, &'a [u8])>,
    pub topics: &'a [Topic],
    /// A chunk spans no more than this.
    pub chunk_ns: u64,
}

impl RecordingWriter {
    /// Creates `file` and writes what the recording says of itself: `header`, and the text of the
    /// object file as it was.
    ///
    /// # Errors
    /// Where the file exists already or cannot be created.
    pub fn create(file: &Path, header: &Header, object_toml: &str) -> Result<Self, RecordingError> {
        let preface = Preface {
            header,
            metadata: Vec::new(),
            attachments: vec![(OBJECT_ATTACHMENT, TOML, object_toml.as_bytes())],
            topics: &Topic::OF_CALIBRATION,
            chunk_ns: SECOND_NS,
        };
        Self::create_with(file, &preface)
    }

    pub(super) fn create_with(file: &Path, preface: &Preface<'_>) -> Result<Self, RecordingError> {
        let opened = File::options().write(true).create_new(true).open(file);
        let opened = opened.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => RecordingError::Exists {
                file: file.to_owned(),
            },
            _ => RecordingError::write(file, &error),
        })?;
        Self::begin(file, opened, preface)
    }

    fn begin(file: &Path, opened: File, preface: &Preface<'_>) -> Result<Self, RecordingError> {
        let failed = |error: mcap::McapError| RecordingError::mcap(file, &error);
        // Without seeking, a chunk reaches the file whole, its lengths and checksum right.
        let mut mcap = WriteOptions::new()
            .compression(None)
            .chunk_size(None)
            .disable_seeking(true)
            .create(BufWriter::new(opened))
            .map_err(failed)?;
        let header = preface.header;
        let fields = header.to_fields().map(|(key, text)| (key.to_owned(), text));
        let metadata = Metadata {
            name: METADATA.to_owned(),
            metadata: BTreeMap::from(fields),
        };
        for metadata in std::iter::once(&metadata).chain(&preface.metadata) {
            mcap.write_metadata(metadata).map_err(failed)?;
        }
        for &(name, media_type, data) in &preface.attachments {
            mcap.attach(&attachment(name, media_type, data))
                .map_err(failed)?;
        }
        mcap.flush().map_err(failed)?;
        let channels = Topic::ALL
            .iter()
            .map(|&topic| {
                let used = preface.topics.contains(&topic);
                used.then(|| add_channel(&mut mcap, topic)).transpose()
            })
            .collect::<Result<_, _>>()
            .map_err(failed)?;
        let kept = Kept {
            mcap,
            channels,
            chunk_ns: preface.chunk_ns,
            chunk_start_ns: None,
        };
        Ok(Self::new(file, header, Some(kept)))
    }

    /// Keeps nothing; for those who listen alone.
    pub fn unkept(header: &Header) -> Self {
        Self::new(Path::new("the run that is not recorded"), header, None)
    }

    fn new(file: &Path, header: &Header, kept: Option<Kept>) -> Self {
        let actions = header.actions.iter();
        Self {
            file: file.to_owned(),
            kept,
            actions: actions.map(|name| name.as_str().into()).collect(),
            frames: 0,
            buffer: Vec::with_capacity(512),
            listeners: Vec::new(),
        }
    }

    /// Gives every message from now on to a listener as well.
    pub fn listen(&mut self, listener: Box<dyn Listener>) {
        self.listeners.push(listener);
    }

    /// Goes on for those who listen, without the file; whether anybody does.
    pub(super) fn forsake_file(&mut self) -> bool {
        self.kept = None;
        !self.listeners.is_empty()
    }

    /// What the file is called.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Whether there is a file.
    pub(super) fn is_kept(&self) -> bool {
        self.kept.is_some()
    }

    /// Writes one control period; `observation` where the path of the handle is known.
    ///
    /// # Errors
    /// Where the disk is full or gone.
    pub fn frame(
        &mut self,
        frame: &Frame,
        observation: Option<&Observation>,
    ) -> Result<(), RecordingError> {
        let time_ns = frame.reading.time_ns;
        self.turn(time_ns)?;
        self.felt(frame, observation)?;
        self.acted(frame)
    }

    /// Closes the chunk where it spans enough by now.
    pub(super) fn turn(&mut self, time_ns: u64) -> Result<(), RecordingError> {
        let Some(kept) = &mut self.kept else {
            return Ok(());
        };
        let started_ns = *kept.chunk_start_ns.get_or_insert(time_ns);
        if time_ns.saturating_sub(started_ns) < kept.chunk_ns {
            return Ok(());
        }
        kept.chunk_start_ns = Some(time_ns);
        self.flush()
    }

    /// Name of an action.
    pub(super) fn action(&self, index: usize) -> Result<Arc<str>, RecordingError> {
        let name = self.actions.get(index).cloned();
        name.ok_or_else(|| RecordingError::Write {
            file: self.file.clone(),
            reason: format!("the header names no action {index}"),
        })
    }

    /// All of a frame but its action.
    pub(super) fn felt(
        &mut self,
        frame: &Frame,
        observation: Option<&Observation>,
    ) -> Result<(), RecordingError> {
        let time_ns = frame.reading.time_ns;
        self.action(frame.action)?;
        self.message(Topic::Pose, time_ns, &PoseMessage::from(&frame.reading))?;
        self.message(Topic::Wrench, time_ns, &WrenchMessage::from(&frame.reading))?;
        if let Some(observation) = observation {
            let message = ObservationMessage::new(time_ns, observation);
            self.message(Topic::Observation, time_ns, &message)?;
        }
        if let Some(joint_state) = frame.truth {
            let message = TruthMessage {
                timestamp: time_ns.into(),
                joint_state,
            };
            self.message(Topic::Truth, time_ns, &message)?;
        }
        Ok(())
    }

    /// A frame's action: last, because a frame that is cut off before it must not pass for a whole
    /// one.
    pub(super) fn acted(&mut self, frame: &Frame) -> Result<(), RecordingError> {
        let time_ns = frame.reading.time_ns;
        let action = self.action(frame.action)?;
        self.message(Topic::Action, time_ns, &ActionMessage::new(frame, &action))?;
        self.frames = self.frames.wrapping_add(1);
        Ok(())
    }

    /// Notes that a demonstration was carried out to its end.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub fn done(&mut self, time_ns: u64, done: &Done) -> Result<(), RecordingError> {
        let message = DemonstrationMessage::new(time_ns, done);
        self.message(Topic::Demonstration, time_ns, &message)?;
        self.flush()
    }

    /// Notes why the guard stopped the arm.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub fn guard(&mut self, time_ns: u64, reason: &str) -> Result<(), RecordingError> {
        let message = GuardMessage {
            timestamp: time_ns.into(),
            reason,
        };
        self.message(Topic::Guard, time_ns, &message)?;
        self.flush()
    }

    /// Notes how late the loops were.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub fn timing(
        &mut self,
        time_ns: u64,
        lateness: &LatenessReport,
    ) -> Result<(), RecordingError> {
        let message = TimingMessage {
            timestamp: time_ns.into(),
            lateness,
        };
        self.message(Topic::Timing, time_ns, &message)?;
        self.flush()
    }

    /// Writes the end of the file, by which readers know that nothing is missing.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub fn finish(mut self) -> Result<(), RecordingError> {
        let Some(mut kept) = self.kept.take() else {
            return Ok(());
        };
        kept.mcap
            .finish()
            .map_err(|error| RecordingError::mcap(&self.file, &error))?;
        kept.mcap
            .into_inner()
            .into_inner()
            .map_err(std::io::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .map_err(|error| RecordingError::write(&self.file, &error))
    }

    /// Attaches a text.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub(super) fn attach(&mut self, name: &str, data: &[u8]) -> Result<(), RecordingError> {
        let Some(kept) = &mut self.kept else {
            return Ok(());
        };
        kept.mcap
            .attach(&attachment(name, JSON, data))
            .map_err(|error| RecordingError::mcap(&self.file, &error))
    }

    /// Tells those who listen how the run ended.
    pub(super) fn tell_end(&mut self, report: &RunReport) {
        for listener in &mut self.listeners {
            listener.end(report);
        }
    }

    pub(super) fn flush(&mut self) -> Result<(), RecordingError> {
        let Some(kept) = &mut self.kept else {
            return Ok(());
        };
        kept.mcap
            .flush()
            .map_err(|error| RecordingError::mcap(&self.file, &error))
    }

    pub(super) fn message(
        &mut self,
        topic: Topic,
        time_ns: u64,
        message: &impl Serialize,
    ) -> Result<(), RecordingError> {
        self.buffer.clear();
        serde_json::to_writer(&mut self.buffer, message)
            .map_err(|error| RecordingError::write(&self.file, &error.into()))?;
        let heard = Message {
            topic: topic.name(),
            time_ns,
            json: &self.buffer,
        };
        for listener in &mut self.listeners {
            listener.hear(&heard);
        }
        let Some(kept) = &mut self.kept else {
            return Ok(());
        };
        let Some(channel_id) = kept.channels[topic as usize] else {
            return Err(RecordingError::Write {
                file: self.file.clone(),
                reason: format!("such a recording has no {}", topic.name()),
            });
        };
        let header = MessageHeader {
            channel_id,
            sequence: self.frames,
            log_time: time_ns,
            publish_time: time_ns,
        };
        kept.mcap
            .write_to_known_channel(&header, &self.buffer)
            .map_err(|error| RecordingError::mcap(&self.file, &error))
    }
}

fn attachment<'a>(name: &str, media_type: &str, data: &'a [u8]) -> Attachment<'a> {
    Attachment {
        log_time: 0,
        create_time: 0,
        name: name.to_owned(),
        media_type: media_type.to_owned(),
        data: data.into(),
    }
}

fn add_channel(mcap: &mut mcap::Writer<BufWriter<File>>, topic: Topic) -> mcap::McapResult<u16> {
    let schema = topic.schema().to_string();
    let schema = mcap.add_schema(topic.schema_name(), "jsonschema", schema.as_bytes())?;
    mcap.add_channel(schema, topic.name(), "json", &BTreeMap::new())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::recording::{FORMAT_VERSION, testing};

    #[test]
    fn a_full_disk_is_named_with_its_file() {
        let full = Path::new("/dev/full");
        let Ok(opened) = File::options().write(true).open(full) else {
            println!("skipped: no /dev/full");
            return;
        };
        let header = testing::header();
        assert_eq!(header.format, FORMAT_VERSION);
        let preface = Preface {
            header: &header,
            metadata: Vec::new(),
            attachments: Vec::new(),
            topics: &Topic::OF_CALIBRATION,
            chunk_ns: SECOND_NS,
        };
        let error = RecordingWriter::begin(full, opened, &preface)
            .err()
            .unwrap();
        let text = error.to_string();
        assert!(text.starts_with("/dev/full: "), "{text}");
        assert!(text.contains("No space left on device"), "{text}");
    }
}
