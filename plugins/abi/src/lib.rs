//! Everything a plugin author needs.
//!
//! A plugin is a shared library that exports one function, `pubs_plugin_v1`, which returns a
//! static table of C functions (`pubs_plugin.h`). In Rust, implement [`ObservationModel`] or
//! [`Driver`] and name the type in [`export_observation_model!`] or [`export_driver!`]; in C or
//! C++, fill the table by hand. The engine knows nothing else of a plugin, and its built-in
//! plugins cross the same line.
//!
//! States are in SI (rad, m) or an abstract object's own numbers, actions are indices in the
//! order of the object file, arrays are channel-major `[C][N]` in `f32`, time is nanoseconds of
//! the host's monotonic clock.

mod boundary;
pub mod diagnosis;
pub mod driver;
pub mod error;
mod export;
mod export_driver;
mod export_model;
pub mod observation_model;
mod params;
pub mod setup;
pub mod table;

pub use diagnosis::{CheckState, DriverCheck};
pub use driver::{Driver, DriverStatus, Reading, SAFETY_STOP, Twist};
pub use error::PluginError;
pub use export_driver::driver_table;
pub use export_model::observation_model_table;
pub use observation_model::{
    Channel, ChannelKind, GridTransitions, ObservationModel, Support, Transitions,
};
pub use params::number_or;
pub use setup::{
    ActionSetup, BeliefSetup, ControlSetup, DriverSetup, JointSetup, JointType, Mode, ModelSetup,
};
