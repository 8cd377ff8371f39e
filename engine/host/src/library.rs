//! Loading a library, and refusing one.
//!
//! The order matters: first the file is looked at (is it whole, for this machine, does it name the
//! entry function at all?), only then is it given to the system's loader, which runs its
//! constructors. A library that was loaded stays loaded, whether it is taken or refused: unloading
//! one that has started threads or registered destructors crashes later.

use std::path::Path;

use pubs_plugin::table::{ABI, ENTRY_SYMBOL, EntryFunction};

use crate::plugin::{Origin, Plugin};
use crate::{HostError, elf};

/// Why a library is refused: both sides of what differs, and what would mend it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LibraryFault {
    /// The file cannot be read.
    #[error("it cannot be read: {0}")]
    Unreadable(String),
    /// The file is no whole shared library of this machine.
    #[error("{0}")]
    File(String),
    /// The system's loader refuses it.
    #[error("the system cannot load it: {0}")]
    System(String),
    /// It is a library, but exports no plugin.
    #[error(
        "it is a shared library but not a plugin: it exports no function `{ENTRY_SYMBOL}`; \
         use export_observation_model!/export_driver! (Rust) or define it as PUBS_PLUGIN_EXPORT (C)"
    )]
    NotAPlugin,
    /// The entry function gave no table.
    #[error(
        "`{ENTRY_SYMBOL}` returned no valid pointer to a table; it must return the address of a static pubs_plugin_table"
    )]
    NoTable,
    /// Another ABI.
    #[error("the ABI differs: engine {engine} speaks ABI {ABI}, the plugin ABI {found}; {cure}", engine = env!("CARGO_PKG_VERSION"), cure = abi_cure(*.found))]
    Abi {
        /// The plugin's ABI number.
        found: u32,
    },
    /// A table is too short.
    #[error(
        "`{table}` is too short: engine {expected} bytes, plugin {found} bytes; {}",
        rebuild()
    )]
    Size {
        /// The C name of the table.
        table: &'static str,
        /// What the plugin says.
        found: u32,
        /// What this engine reads.
        expected: usize,
    },
    /// A table or a function that must be there is null.
    #[error(
        "`{part}` is null, but every plugin of this kind must provide it; {}",
        rebuild()
    )]
    Missing {
        /// The table or function.
        part: &'static str,
    },
    /// A field has a value that it must not have.
    #[error("`{field}` of its table is {found}; expected {expected}")]
    Field {
        /// The field.
        field: &'static str,
        /// Its value.
        found: String,
        /// The rule.
        expected: String,
    },
}

fn abi_cure(found: u32) -> String {
    if found > ABI {
        format!(
            "the plugin is newer: take an engine that speaks ABI {found}, or {}",
            rebuild()
        )
    } else {
        format!("the plugin is older or damaged: {}", rebuild())
    }
}

fn rebuild() -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "rebuild it for engine {version}: `cc -shared -fPIC -I plugins/abi/include -o libNAME.so NAME.c` (C), \
         or `cargo build --release` with pubs-plugin {version} (Rust)"
    )
}

/// Loads one library.
///
/// # Errors
/// [`HostError::Refused`] where the file is no plugin of this engine.
pub fn load(path: &Path) -> Result<Plugin, HostError> {
    let refused = |fault| HostError::Refused {
        path: path.to_owned(),
        fault,
    };
    // An absolute path: the loader looks a bare name up in the system's directories.
    let path = path
        .canonicalize()
        .map_err(|error| refused(LibraryFault::Unreadable(error.to_string())))?;
    check_file(&path)
        .and_then(|()| open(&path))
        .map_err(refused)
}

/// What can be seen without running any of the library's code.
fn check_file(path: &Path) -> Result<(), LibraryFault> {
    let file = std::fs::read(path).map_err(|error| LibraryFault::Unreadable(error.to_string()))?;
    if cfg!(all(unix, not(target_vendor = "apple"))) {
        elf::check(&file).map_err(LibraryFault::File)?;
    }
    match memchr::memmem::find(&file, ENTRY_SYMBOL.as_bytes()) {
        Some(_) => Ok(()),
        None => Err(LibraryFault::NotAPlugin),
    }
}

fn open(path: &Path) -> Result<Plugin, LibraryFault> {
    let library = system_open(path)?;
    // SAFETY: the header gives the symbol this type, and promises that the table lives as long as
    // the library, which stays for as long as the process.
    unsafe {
        let entry = library
            .get::<EntryFunction>(ENTRY_SYMBOL)
            .map(|symbol| *symbol);
        std::mem::forget(library);
        let entry = entry.map_err(|_| LibraryFault::NotAPlugin)?;
        Plugin::from_table(entry(), Origin::File(path.to_owned()))
    }
}

#[cfg(unix)]
fn system_open(path: &Path) -> Result<libloading::Library, LibraryFault> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    // NOW: an undefined symbol is refused here; bound lazily it would end the process in mid-motion.
    // SAFETY: its constructors run; whoever puts a library on the search path trusts it.
    let library = unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) };
    library.map(Into::into).map_err(system_fault)
}

#[cfg(not(unix))]
fn system_open(path: &Path) -> Result<libloading::Library, LibraryFault> {
    // SAFETY: its constructors run; whoever puts a library on the search path trusts it.
    unsafe { libloading::Library::new(path) }.map_err(system_fault)
}

/// libloading says only "dlopen failed"; the loader's own words are in the source.
fn system_fault(error: libloading::Error) -> LibraryFault {
    let source = std::error::Error::source(&error).map(ToString::to_string);
    LibraryFault::System(source.unwrap_or_else(|| error.to_string()))
}
