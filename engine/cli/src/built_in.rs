//! The plugins that are part of the program.

use std::path::PathBuf;

use pubs_host::{Registry, search_path};

/// Built-in plugins, and those in `plugin_dirs`, in `PUBS_PLUGIN_PATH` and beside the executable.
pub fn registry(plugin_dirs: &[PathBuf]) -> Registry {
    Registry::new(
        &[pubs_segments::table(), pubs_virtual_arm::table()],
        search_path(plugin_dirs),
    )
}
