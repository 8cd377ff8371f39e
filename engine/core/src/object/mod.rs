//! The object file: one object, measured or made up, that the engine can train for and run.
//!
//! [`load`] reads a file with the place of each key (`document`), lays it over the engine's
//! defaults and under the user's overrides (`layers`), checks each value against the table of
//! all keys ([`keys`], `check`) and then the values against each other (`rules`). It gives back
//! either an [`ObjectFile`] in the file's own units or every [`Fault`] at its line.
//! [`json_schema()`] makes the schema for editors from the same table.

mod check;
mod document;
mod fault;
mod json_schema;
pub mod keys;
mod layers;
mod load;
mod places;
pub mod raw;
mod render;
mod rules;
pub mod schema;
mod wording;

#[cfg(test)]
mod tests;

pub use fault::{Fault, Faults};
pub use json_schema::{json_schema, json_schema_text};
pub use layers::{DEFAULTS, ENVIRONMENT_PREFIX, Origin, Overrides};
pub use load::{LoadedObject, files, key_of_pointer, load, load_text};
pub use places::Location;
pub use raw::ObjectFile;
pub use render::render;
