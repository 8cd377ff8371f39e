//! Where plugins are looked for.

use std::path::{Path, PathBuf};

/// Directories in order: `plugin_dirs` (`--plugin-dir`), `PUBS_PLUGIN_PATH`, beside the executable.
pub fn search_path(plugin_dirs: &[PathBuf]) -> Vec<PathBuf> {
    let from_environment = std::env::var_os("PUBS_PLUGIN_PATH").unwrap_or_default();
    let mut directories = plugin_dirs.to_vec();
    directories.extend(
        std::env::split_paths(&from_environment).filter(|path| !path.as_os_str().is_empty()),
    );
    directories.extend(beside_the_executable());
    directories
}

pub(crate) fn beside_the_executable() -> Option<PathBuf> {
    let executable = std::env::current_exe().ok()?.canonicalize().ok()?;
    executable.parent().map(Path::to_owned)
}

/// The library files of a directory, sorted by name.
pub(crate) fn libraries(directory: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(directory)? {
        let path = entry?.path();
        let is_library = path
            .extension()
            .is_some_and(|suffix| suffix == std::env::consts::DLL_EXTENSION);
        if is_library && path.is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
