//! The C ABI: the same layout as `include/pubs_plugin.h`, which explains each call.
//!
//! Only the engine's host and the export macros need this module. Every function returns a
//! status ([`STATUS_OK`], [`STATUS_ABSENT`], [`STATUS_ERROR`], [`STATUS_PANIC`]) and ends with
//! `error, error_capacity`: a buffer of the caller's, which it fills with a NUL-terminated UTF-8
//! account where the status is an error or a panic.

use std::ffi::{c_char, c_void};

use crate::Twist;

/// Number of this ABI. A table with another number is not read any further than that number.
pub const ABI: u32 = 1;

/// Name of the one function that a loaded plugin exports, of type [`EntryFunction`].
pub const ENTRY_SYMBOL: &str = "pubs_plugin_v1";

/// Type of the exported function: returns a table that lives as long as the process.
pub type EntryFunction = unsafe extern "C" fn() -> *const PluginTable;

/// [`PluginTable::kind`] of an observation model.
pub const KIND_OBSERVATION_MODEL: u32 = 1;
/// [`PluginTable::kind`] of a driver.
pub const KIND_DRIVER: u32 = 2;

/// Done; the outputs are filled.
pub const STATUS_OK: i32 = 0;
/// Not provided, or not known; the outputs are untouched.
pub const STATUS_ABSENT: i32 = 1;
/// Failed; the error buffer says why.
pub const STATUS_ERROR: i32 = 2;
/// The plugin's own code broke down; the error buffer says where. The instance may still be destroyed.
pub const STATUS_PANIC: i32 = 3;

/// [`ChannelEntry::kind`] of a normally distributed channel.
pub const CHANNEL_GAUSSIAN: u32 = 0;
/// [`ChannelEntry::kind`] of a channel that is 0 or 1.
pub const CHANNEL_BERNOULLI: u32 = 1;

/// Bytes of a channel's name, the closing NUL included.
pub const CHANNEL_NAME_BYTES: usize = 32;

/// UTF-8 text with its length, alive as long as the process; no closing NUL needed.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Text {
    /// First byte.
    pub data: *const c_char,
    /// Bytes.
    pub length: usize,
}

impl Text {
    /// The text as C sees it.
    pub const fn new(text: &'static str) -> Self {
        Self {
            data: text.as_ptr().cast(),
            length: text.len(),
        }
    }
}

/// What a plugin is: returned by the exported function, and by `table()` of a built-in plugin.
#[derive(Debug)]
#[repr(C)]
pub struct PluginTable {
    /// `sizeof` of this struct where the plugin was compiled. Later engines of the same ABI may
    /// append fields, so a larger table is read as far as it is known.
    pub size: u32,
    /// [`ABI`].
    pub abi: u32,
    /// [`KIND_OBSERVATION_MODEL`] or [`KIND_DRIVER`].
    pub kind: u32,
    /// 0.
    pub reserved: u32,
    /// The name that an object file uses.
    pub name: Text,
    /// The plugin's own version.
    pub version: Text,
    /// JSON Schema of its parameters.
    pub params_schema: Text,
    /// Its functions if it is an observation model, else null.
    pub observation_model: *const ObservationModelTable,
    /// Its functions if it is a driver, else null.
    pub driver: *const DriverTable,
}

// SAFETY: a table is read-only and what it points to lives, unchanged, as long as the process.
unsafe impl Sync for PluginTable {}
// SAFETY: as above.
unsafe impl Send for PluginTable {}

/// One component of an observation.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct ChannelEntry {
    /// UTF-8, closed and filled up with NUL.
    pub name: [c_char; CHANNEL_NAME_BYTES],
    /// [`CHANNEL_GAUSSIAN`] or [`CHANNEL_BERNOULLI`].
    pub kind: u32,
}

/// `create` of a model, `open` of a driver: JSON text in, instance out.
pub type CreateFunction = unsafe extern "C" fn(
    setup: *const u8,
    setup_length: usize,
    instance: *mut *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// A call with nothing but the instance.
pub type PlainFunction =
    unsafe extern "C" fn(instance: *mut c_void, error: *mut c_char, error_capacity: usize) -> i32;

/// Fills up to `capacity` entries and tells the number of all.
pub type ChannelsFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    channels: *mut ChannelEntry,
    capacity: usize,
    count: *mut usize,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// `before` and `after` are `[count]`; `mean` and `sigma` are `[C][count]`.
pub type MomentsFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    action: usize,
    before: *const f32,
    after: *const f32,
    count: usize,
    mean: *mut f32,
    sigma: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// As [`MomentsFunction`], hypothesis i at `before + i·spacing` and `after + i·spacing`.
pub type MomentsGridFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    action: usize,
    before: f32,
    after: f32,
    spacing: f32,
    count: usize,
    mean: *mut f32,
    sigma: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// `observation` is `[C]`, `log_likelihood` is `[count]`.
pub type LogLikelihoodFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    action: usize,
    before: *const f32,
    after: *const f32,
    count: usize,
    observation: *const f32,
    log_likelihood: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// `normals` and `observations` are `[C][count]`.
pub type SampleFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    action: usize,
    before: *const f32,
    after: *const f32,
    count: usize,
    normals: *const f32,
    observations: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// The functions of an observation model. After `create` they may be called from several threads
/// at once on one instance, `destroy` last and once.
#[derive(Debug)]
#[repr(C)]
pub struct ObservationModelTable {
    /// `sizeof` of this struct where the plugin was compiled.
    pub size: u32,
    /// 0.
    pub reserved: u32,
    /// Builds the model of one object from [`ModelSetup`](crate::ModelSetup) as JSON.
    pub create: Option<CreateFunction>,
    /// Ends the instance.
    pub destroy: Option<PlainFunction>,
    /// The components of an observation.
    pub channels: Option<ChannelsFunction>,
    /// Mean and sigma; absent where the model is not Gaussian.
    pub moments: Option<MomentsFunction>,
    /// Mean and sigma on a regular grid; may be null.
    pub moments_grid: Option<MomentsGridFunction>,
    /// Log-likelihood of one observation; may be null where `moments` answers.
    pub log_likelihood: Option<LogLikelihoodFunction>,
    /// One observation per hypothesis; may be null where `moments` answers.
    pub sample: Option<SampleFunction>,
}

/// A [`Reading`](crate::Reading) as it crosses the line: the status is a plain number, since a
/// foreign plugin may put anything there.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct RawReading {
    /// When it was taken, ns.
    pub time_ns: u64,
    /// Tool origin in the base frame, m.
    pub position_m: [f64; 3],
    /// Tool orientation in the base frame (x, y, z, w).
    pub orientation_xyzw: [f64; 4],
    /// Force by the tool on the object, tool axes, N.
    pub force_n: [f64; 3],
    /// Torque about the tool origin, tool axes, N m.
    pub torque_nm: [f64; 3],
    /// A [`DriverStatus`](crate::DriverStatus) by number.
    pub status: u32,
    /// 0.
    pub reserved: u32,
}

/// Fills up to `capacity` bytes with NUL-terminated UTF-8.
pub type TextFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    text: *mut c_char,
    capacity: usize,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// The newest measurement.
pub type ReadFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    reading: *mut RawReading,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// Moves the tool until a time.
pub type CommandFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    twist: *const Twist,
    expires_ns: u64,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// Moves virtual time.
pub type AdvanceFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    time_ns: u64,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// The true joint state, or absent.
pub type TruthFunction = unsafe extern "C" fn(
    instance: *mut c_void,
    state: *mut f64,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// Takes a text of `length` bytes of UTF-8, without a closing NUL, valid during the call only.
pub type TextSink = unsafe extern "C" fn(context: *mut c_void, text: *const u8, length: usize);

/// Looks at the robot from [`DriverSetup`](crate::DriverSetup) as JSON and hands the checks, a JSON
/// array of [`DriverCheck`](crate::DriverCheck), to `sink`, once.
pub type DiagnoseFunction = unsafe extern "C" fn(
    setup: *const u8,
    setup_length: usize,
    sink: Option<TextSink>,
    sink_context: *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32;

/// The functions of a driver; called from one thread at a time, `close` last and once.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct DriverTable {
    /// `sizeof` of this struct where the plugin was compiled.
    pub size: u32,
    /// 0.
    pub reserved: u32,
    /// Connects, from [`DriverSetup`](crate::DriverSetup) as JSON.
    pub open: Option<CreateFunction>,
    /// Disconnects and ends the instance.
    pub close: Option<PlainFunction>,
    /// Names the force sensor.
    pub sensor: Option<TextFunction>,
    /// The newest measurement.
    pub read: Option<ReadFunction>,
    /// Moves the tool.
    pub command: Option<CommandFunction>,
    /// Takes the present wrench for zero.
    pub tare: Option<PlainFunction>,
    /// Ramps to rest.
    pub stop: Option<PlainFunction>,
    /// Virtual time; null where the driver lives in real time.
    pub advance_to: Option<AdvanceFunction>,
    /// The true joint state, for scoring; may be null.
    pub truth: Option<TruthFunction>,
    /// What stands in the way of moving, and its cure, without moving; may be null. A table of a
    /// plugin that was compiled before this function was added ends here, as its `size` says.
    pub diagnose: Option<DiagnoseFunction>,
}

/// Bytes of the shortest [`DriverTable`] of this ABI: all up to and with `truth`.
pub const SHORTEST_DRIVER_TABLE: usize = std::mem::offset_of!(DriverTable, diagnose);
