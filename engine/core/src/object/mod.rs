//! The object file.

pub mod raw;

pub use raw::ObjectFile;
