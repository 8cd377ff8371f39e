//! What can be wrong with a world.

/// Why a world was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum WorldError {
    /// No such name is built in, and it is no path of a file.
    #[error("world \"{name}\" is not known; built in: {known}; or give the path of a .toml file")]
    Unknown {
        /// As asked for.
        name: String,
        /// Names, comma-separated.
        known: String,
    },
    /// The file cannot be read.
    #[error(
        "world file {path} cannot be read: {reason} (relative paths begin at {folder}); give the path of a .toml file, or the name of a world that is built in"
    )]
    Unreadable {
        /// As asked for.
        path: String,
        /// Where the program was started: what a relative path begins at.
        folder: String,
        /// The system's account.
        reason: String,
    },
    /// Not TOML, or keys that are missing, unknown or of the wrong type.
    #[error("world \"{name}\": {text}")]
    Format {
        /// Name or path.
        name: String,
        /// Line, column and account, and the nearest valid key.
        text: String,
    },
    /// A value out of its range.
    #[error("world \"{name}\": {key} = {found}, but it must be {rule}")]
    Value {
        /// Name or path.
        name: String,
        /// Dotted key.
        key: String,
        /// As given.
        found: String,
        /// What would be valid.
        rule: String,
    },
}
