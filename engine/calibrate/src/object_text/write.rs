//! A file is either the old one or the new one, whatever happens in between.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// Writes `text` to `path` by way of a temporary file beside it, which is on the disk before it
/// takes the name. Permissions stay as they were; a symbolic link stays one, and what it points to
/// is written.
///
/// # Errors
/// Where the folder cannot be written or the disk is full; the file is then as it was.
pub fn write_atomically(path: &Path, text: &str) -> io::Result<()> {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new()
        .prefix(".pubs-")
        .make_in(folder, |path| {
            File::options().write(true).create_new(true).open(path)
        })?;
    if let Ok(old) = fs::metadata(&path) {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist(&path)?;
    // The new name, too, must be on the disk; not every system can open a folder to say so.
    File::open(folder)
        .and_then(|folder| folder.sync_all())
        .or(Ok(()))
}
