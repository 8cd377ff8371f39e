//! The plugins that are part of the program, and those that are built beside it.

use std::path::PathBuf;

use pubs_host::{Registry, search_path};

/// Plugins of this repository that are libraries to be loaded.
pub const LOADED: [&str; 3] = ["light-dark", "limit-sensor", "melfa"];

/// Builds them beside the program, in the program's own profile.
pub const BUILD_COMMAND: &str = if cfg!(debug_assertions) {
    "cargo build --workspace"
} else {
    "cargo build --release --workspace"
};

/// Built-in plugins, and those in `plugin_dirs`, in `PUBS_PLUGIN_PATH` and beside the executable.
pub fn registry(plugin_dirs: &[PathBuf]) -> Registry {
    Registry::new(
        &[pubs_segments::table(), pubs_virtual_arm::table()],
        search_path(plugin_dirs),
    )
}
