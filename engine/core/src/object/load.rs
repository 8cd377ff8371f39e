//! From a path to a checked object.

use std::fs;
use std::path::{Path, PathBuf};

use figment::value::{Dict, Value};

use super::document::{self, Document};
use super::fault::{Fault, Faults};
use super::layers::{self, Merged, Overrides};
use super::places::{Location, Part, Places};
use super::raw::Filter;
use super::rules::FORCE_BIAS;
use super::{ObjectFile, check, rules};

/// An object file that has passed every check of its own keys, with all layers merged.
///
/// What plugins and the compiler find later is shown at its line with [`fault`](Self::fault).
#[derive(Debug, Clone)]
pub struct LoadedObject {
    /// The values, in the file's units.
    pub file: ObjectFile,
    places: Places,
    merged: Dict,
}

impl LoadedObject {
    /// Path of the object file, as it was given.
    pub fn path(&self) -> &Path {
        Path::new(&self.places.file)
    }

    /// The text of the file.
    pub fn text(&self) -> &str {
        &self.places.text
    }

    /// The object with defaults and overrides in it, as one TOML text that needs neither: loaded
    /// again without overrides it gives the same values.
    ///
    /// # Errors
    /// In words, where a value has no form in TOML.
    pub fn resolved_text(&self) -> Result<String, String> {
        let mut values = self.merged.clone();
        // A filter that an override has put in place of the file's own may not use all its keys.
        if let (Filter::Sis, Some(Value::Dict(_, belief))) =
            (self.file.belief.filter, values.get_mut("belief"))
        {
            belief.retain(|name, _| !FORCE_BIAS.contains(&format!("belief.{name}").as_str()));
        }
        toml::to_string(&values).map_err(|error| error.to_string())
    }

    /// Where the value of a key was written (`joint.limits_deg`, `observation.segment.3.to_deg`);
    /// `None` where the key has no value.
    pub fn location(&self, key: &str) -> Option<Location> {
        self.places.location(key)
    }

    /// A fault at a key, shown at the nearest table around it where the file does not have it.
    pub fn fault(&self, key: &str, message: impl Into<String>, help: impl Into<String>) -> Fault {
        self.places.fault(key, Part::Value, message, help)
    }
}

/// The key that a JSON pointer inside a table means: `/segment/3/to_deg` in `observation` is
/// `observation.segment.3.to_deg`.
pub fn key_of_pointer(table: &str, pointer: &str) -> String {
    pointer
        .split('/')
        .filter(|part| !part.is_empty())
        .map(|part| part.replace("~1", "/").replace("~0", "~"))
        .fold(table.to_owned(), |path, part| document::join(&path, &part))
}

/// Reads, merges and checks one object file.
///
/// # Errors
/// Everything that is wrong with it.
pub fn load(path: &Path, overrides: &Overrides) -> Result<LoadedObject, Faults> {
    let file = path.display().to_string();
    let text = read(path).map_err(|(message, help)| Fault::of_file(file.clone(), message, help))?;
    load_text(&file, text, overrides)
}

/// The object files at a path: the file itself, or every `.toml` in the folder, sorted.
///
/// # Errors
/// One fault where there is nothing there, or a folder without any.
pub fn files(path: &Path) -> Result<Vec<PathBuf>, Faults> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let shown = path.display().to_string();
    let entries = fs::read_dir(path).map_err(|error| {
        let message = format!("the folder cannot be read: {error}");
        Fault::of_file(shown.clone(), message, "check its permissions")
    })?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .collect();
    files.sort();
    if files.is_empty() {
        let help = "name an object file or a folder with .toml files";
        return Err(Fault::of_file(shown, "no object file (.toml) in this folder", help).into());
    }
    Ok(files)
}

/// The text of a file, or message and help.
fn read(path: &Path) -> Result<String, (String, String)> {
    let fault = |message: String, help: &str| (message, help.to_owned());
    let metadata = fs::metadata(path).map_err(|error| {
        fault(
            format!("the object file cannot be read: {error}"),
            "give the path of an object file",
        )
    })?;
    if metadata.is_dir() {
        return Err(fault(
            "this is a folder, not an object file".to_owned(),
            "name one .toml file in it",
        ));
    }
    if !metadata.is_file() {
        return Err(fault(
            "this is not a regular file".to_owned(),
            "name a .toml file",
        ));
    }
    let bytes = fs::read(path).map_err(|error| {
        fault(
            format!("the object file cannot be read: {error}"),
            "check its permissions",
        )
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..at]
            .iter()
            .filter(|byte| **byte == b'\n')
            .count()
            + 1;
        fault(
            format!("the file is not UTF-8 text (line {line})"),
            "save it as UTF-8",
        )
    })
}

/// Checks a text as if it were the file `file`.
///
/// # Errors
/// Everything that is wrong with it.
pub fn load_text(file: &str, text: String, overrides: &Overrides) -> Result<LoadedObject, Faults> {
    if text.trim().is_empty() {
        let help = "start from one of the files in objects/";
        return Err(Fault::of_file(file, "the file is empty", help).into());
    }
    let parsed = document::parse(&text);
    let mut places = Places {
        file: file.to_owned(),
        text,
        spans: Default::default(),
        origins: Default::default(),
    };
    let document = parsed.map_err(|errors| syntax_faults(&places, errors))?;
    let (merged, mut faults) = merge(&mut places, document, overrides);
    refuse_other_schema(&merged, &places)?;
    faults.extend(check::check(&merged, &places));
    faults.extend(rules::check(&merged, &places, &faults));
    if faults.is_empty() {
        return extract(&merged, places);
    }
    faults.sort_by_key(|fault| (fault.line.is_none(), fault.line, fault.column));
    Err(Faults(faults))
}

/// Merges the layers; the faults are those of overrides that cannot be applied.
fn merge(places: &mut Places, document: Document, overrides: &Overrides) -> (Merged, Vec<Fault>) {
    let (merged, errors) = layers::merge(&document.values, overrides);
    places.spans = document.spans;
    places.origins.clone_from(&merged.origins);
    let fault = |error: layers::OverrideError| {
        places.fault_of_override(&error.origin, error.message, error.help)
    };
    let faults = errors.into_iter().map(fault).collect();
    (merged, faults)
}

/// A file of another format cannot be judged by the rules of this one.
fn refuse_other_schema(merged: &Merged, places: &Places) -> Result<(), Faults> {
    match merged.values.get("schema").and_then(check::number) {
        Some(version) if version != 1.0 => {
            let message = format!("the file has schema = {version}; this engine reads schema = 1");
            let help = "write schema = 1 and follow objects/object.schema.json, or take an engine that reads this schema";
            Err(places.fault("schema", Part::Value, message, help).into())
        }
        _ => Ok(()),
    }
}

fn syntax_faults(places: &Places, mut errors: Vec<document::SyntaxError>) -> Faults {
    errors.sort_by_key(|error| error.span.as_ref().map(|span| span.start));
    let help = "the file is TOML (https://toml.io); the rest is checked once it can be read";
    let fault = |error: document::SyntaxError| {
        let message = format!("this is not TOML: {}", error.message);
        match error.span {
            Some(span) => places.fault_at(span, message, help),
            None => Fault::of_file(&places.file, message, help),
        }
    };
    Faults(errors.into_iter().map(fault).collect())
}

/// Reads the checked values into structs; a failure here means that the key table and the
/// structs disagree, and is shown rather than hidden.
fn extract(merged: &Merged, places: Places) -> Result<LoadedObject, Faults> {
    match merged.figment.extract::<ObjectFile>() {
        Ok(file) => Ok(LoadedObject {
            file,
            places,
            merged: merged.values.clone(),
        }),
        Err(error) => {
            let help = "this is a fault of the engine: its key table allows what it cannot read";
            let fault = |error: figment::Error| {
                places.fault(
                    &error.path.join("."),
                    Part::Value,
                    error.kind.to_string(),
                    help,
                )
            };
            Err(Faults(error.into_iter().map(fault).collect()))
        }
    }
}
