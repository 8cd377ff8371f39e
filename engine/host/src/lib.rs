//! Loads plugins, finds them on the search path and checks that they keep the contract.
//!
//! [`Registry`] knows the built-in plugins and the libraries of the search path, and hands out a
//! [`ModelPlugin`] or a [`DriverPlugin`] by the name in an object file. Both check the object's
//! parameters against the plugin's schema ([`ParameterFault`]) and make instances:
//! [`ModelInstance`] for any number of threads, [`DriverInstance`] for one at a time. Built-in and
//! loaded plugins cross the same table of C functions (`pubs_plugin.h`), and nothing that comes
//! back is believed before it is checked. [`library`] refuses a file that is no plugin of this
//! engine before running any of its code where it can; a loaded library is never unloaded.
//! [`conformance`] is the kit behind `pubs-engine plugins check`.

mod belief_model;
mod call;
mod channels;
pub mod conformance;
mod driver;
mod elf;
mod error;
pub mod library;
mod model;
mod model_plugin;
mod nearest;
mod parameters;
mod plugin;
mod reading;
mod registry;
mod search_path;
mod sweep;

pub use call::Failure;
pub use driver::{DriverInstance, DriverPlugin};
pub use error::HostError;
pub use library::LibraryFault;
pub use model::ModelInstance;
pub use model_plugin::ModelPlugin;
pub use parameters::ParameterFault;
pub use plugin::{Origin, Plugin, PluginKind};
pub use registry::{Listed, Registry};
pub use search_path::search_path;
