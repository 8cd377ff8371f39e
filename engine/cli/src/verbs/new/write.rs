//! The new file, and beside it the JSON Schema that editors complete and underline by.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::Path;

use pubs_core::object::json_schema_text;

use crate::failure::Failure;
use crate::options::make_folder;
use crate::show;

/// What the line `#:schema` in the file names.
const SCHEMA_FILE: &str = "object.schema.json";

/// Refuses a path at which nothing new can be written, before anybody is asked anything.
///
/// # Errors
/// Where the name is no object file's, or is taken.
pub fn check_free(file: &Path) -> Result<(), Failure> {
    if file.extension().is_none_or(|ending| ending != "toml") {
        return Err(Failure::invalid(format!(
            "{} would not be found as an object file; let its name end in .toml",
            file.display()
        )));
    }
    if file.symlink_metadata().is_ok() {
        return Err(taken(file));
    }
    Ok(())
}

/// Writes the object file, and the schema where the folder has none; whether it had none.
///
/// # Errors
/// Where the file is there by now, or the folder cannot be written.
pub fn write(file: &Path, text: &str) -> Result<bool, Failure> {
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder {
        make_folder(folder)?;
    }
    create(file, text).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => taken(file),
        _ => Failure::invalid(format!("cannot write {}: {error}", file.display())),
    })?;
    let schema = file.with_file_name(SCHEMA_FILE);
    match create(&schema, &json_schema_text()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            if fs::read_to_string(&schema).is_ok_and(|found| found != json_schema_text()) {
                show::note(&format!(
                    "note: {} is not that of this engine; `pubs-engine config --schema` prints it",
                    schema.display()
                ));
            }
            Ok(false)
        }
        Err(error) => {
            show::say(&format!(
                "warning: cannot write {}, by which editors complete the file: {error}",
                schema.display()
            ));
            Ok(false)
        }
    }
}

/// Writes a file that is not there yet, or nothing.
fn create(path: &Path, text: &str) -> std::io::Result<()> {
    let mut file = File::create_new(path)?;
    let written = file
        .write_all(text.as_bytes())
        .and_then(|()| file.sync_all());
    if written.is_err() {
        let _ = fs::remove_file(path);
    }
    written
}

fn taken(file: &Path) -> Failure {
    Failure::invalid(format!(
        "{} is there already, and `new` overwrites nothing; give another name, or edit it",
        file.display()
    ))
}
