//! What an arm did and felt, kept: one [`Frame`] per control period, in an MCAP file.
//!
//! The raw pose and wrench are the recording; whatever else is written beside them can be worked
//! out again. All messages are JSON with JSON Schemas; the log time is the frame's time.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/pose` | `foxglove.PoseInFrame` | tool in base |
//! | `/wrench` | `pubs.Wrench` | force and torque, tool axes |
//! | `/action` | `pubs.Action` | action, demonstration, commanded speed, status |
//! | `/observation` | `pubs.Observation` | joint displacement, f_d, f_z, f_n |
//! | `/truth` | `pubs.Truth` | the true joint state, from virtual worlds alone |
//! | `/demonstration` | `pubs.Demonstration` | one was carried out to its end |
//! | `/guard` | `pubs.Guard` | why the guard stopped the arm |
//! | `/timing` | `pubs.Timing` | how late the loops were |
//!
//! A run has these beside them (`steps`); with them it can be replayed exactly:
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/limits` | `pubs.Limits` | range, goals and goal regions, once |
//! | `/controller` | `pubs.Controller` | each tick of the controller: number, order in force |
//! | `/belief` | `pubs.Belief` | each step of the filter: the tick it took in; mean, entropy, histogram |
//! | `/policy` | `pubs.Policy` | each step of the policy: the belief it took in; the action chosen |
//! | `/dropped` | `pubs.Dropped` | how many entries were lost so far, where any were |
//!
//! The metadata record `pubs-engine` holds the [`Header`], the attachment `object.toml` the object
//! file as it was; both stand at the start, so that a file that is cut off still has them. A run
//! adds the metadata record `pubs-engine run` ([`RunHeader`]), `object.resolved.toml` with defaults
//! and overrides in it, its policies, and at the end `report.json`.
//! [`RecordingWriter`] writes, [`Recorder`] does so beside a control loop and [`RunRecorder`]
//! beside the three of a run; a [`Listener`] is given every message as it is written. [`read`] and
//! [`read_run`] read whatever is left of a file.

mod error;
mod header;
mod join;
mod listen;
mod message;
mod queue;
mod read;
mod recorder;
mod records;
mod run_header;
mod run_message;
mod run_read;
mod run_schema;
mod run_write;
mod steps;
mod tape;
#[cfg(test)]
mod testing;
mod topic;
mod write;

pub use error::{BadMessage, RecordingError};
pub use header::{HeaderFault, joint_name};
pub use listen::{Listener, Message, TopicNote, run_topics};
pub use message::{status_name, status_named};
pub use read::{object_toml, read};
pub use recorder::{Finished, Recorder};
pub use run_header::{PolicyNote, RunHeader};
pub use run_read::{RunRecording, read_run};
pub use run_write::RunPreface;
pub use steps::{BINS, BeliefStep, Choice, ChoiceVerdict, GuardStop, Limits, Tick, histogram};
pub use tape::RunRecorder;
pub(crate) use tape::Tape;
pub use write::RecordingWriter;

use pubs_plugin::{JointType, Reading};
use serde::{Deserialize, Serialize};

/// Version of the layout of topics and metadata that calibrations have.
pub const FORMAT_VERSION: u32 = 1;

/// Version of the layout that runs have: the same frames, and what each loop saw. Whoever needs
/// frames alone reads both, a replay this one alone.
pub const RUN_FORMAT_VERSION: u32 = 2;

/// Name of the metadata record that holds the header.
const METADATA: &str = "pubs-engine";

/// What a recording says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`FORMAT_VERSION`] or [`RUN_FORMAT_VERSION`] of the writer.
    pub format: u32,
    /// Version of the engine that wrote it.
    pub engine: String,
    /// Name of the object.
    pub object: String,
    /// Kind of its joint.
    pub joint: JointType,
    /// The driver's force sensor.
    pub sensor: String,
    /// Names of the actions, in index order.
    pub actions: Vec<String>,
    /// Frames per second.
    pub rate_hz: f64,
    /// Seed of driver and model.
    pub seed: u64,
}

/// One control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Time, pose, wrench and status, as the driver gave them.
    pub reading: Reading,
    /// Index of the action in force, into [`Header::actions`].
    pub action: usize,
    /// Which demonstration it belongs to, from 1; 0: none.
    pub demonstration: u32,
    /// Speed along the path that was commanded, positive towards open, m/s.
    pub speed_m_s: f64,
    /// Whether the arm moved as the action asks, neither speeding up nor turning round.
    pub settled: bool,
    /// The true joint state (rad or m), where a virtual world tells it.
    pub truth: Option<f64>,
}

/// What follows from a frame's pose and wrench where the path of the handle is known; written for
/// viewers, not read back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Of the joint since the grasp (rad or m).
    pub displacement: f64,
    /// (f_d, f_z, f_n) along the action's direction, N.
    pub forces_n: [f64; 3],
}

/// A demonstration that was carried out to its end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Done {
    /// Name of the action.
    pub action: String,
    /// Which demonstration, from 1.
    pub demonstration: u32,
}

/// A recording, read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What it says of itself.
    pub header: Header,
    /// In the order in which they were recorded.
    pub frames: Vec<Frame>,
    /// Demonstrations carried out to their end.
    pub done: Vec<Done>,
    /// What was lost, in words for the user, where the file is cut off or damaged.
    pub loss: Option<String>,
}
