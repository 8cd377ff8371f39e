//! A plugin whose table has been checked.

use std::fmt;
use std::path::PathBuf;

use pubs_plugin::table::{
    ABI, DriverTable, KIND_DRIVER, KIND_OBSERVATION_MODEL, ObservationModelTable, PluginTable,
    SHORTEST_DRIVER_TABLE, Text,
};
use serde_json::Value;

use crate::library::LibraryFault;
use crate::parameters::ParameterSchema;

/// Longest name, version or schema that is believed, bytes.
const LONGEST_TEXT: usize = 1 << 20;

/// What a plugin does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PluginKind {
    /// Z(o | s, a).
    ObservationModel,
    /// A robot.
    Driver,
}

impl fmt::Display for PluginKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::ObservationModel => "an observation model",
            Self::Driver => "a driver",
        })
    }
}

/// Where a plugin is from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// Linked into the program.
    BuiltIn,
    /// Loaded from this file.
    File(PathBuf),
}

impl fmt::Display for Origin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BuiltIn => formatter.write_str("built in"),
            Self::File(path) => write!(formatter, "{}", path.display()),
        }
    }
}

/// A plugin whose table keeps the ABI; its functions have not been called yet.
#[derive(Debug)]
pub struct Plugin {
    name: String,
    version: String,
    origin: Origin,
    schema: ParameterSchema,
    functions: Functions,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Functions {
    ObservationModel(&'static ObservationModelTable),
    Driver(DriverTable),
}

impl Plugin {
    /// Checks a table, first of all its ABI number.
    ///
    /// # Errors
    /// Where the table is not one of this ABI or lacks something that it must have.
    ///
    /// # Safety
    /// `table` is null or points to at least eight readable bytes, and to a table of this ABI, as
    /// long as its `size` says, if the second four of them hold that number. All it points to lives
    /// unchanged as long as the process.
    pub(crate) unsafe fn from_table(
        table: *const PluginTable,
        origin: Origin,
    ) -> Result<Self, LibraryFault> {
        // SAFETY: promised by the caller; size and abi are read before anything else.
        let table = unsafe {
            check_head(table)?;
            &*table
        };
        // SAFETY: a table of this ABI; its pointers are checked for null and size.
        let functions = unsafe { functions(table) }?;
        // SAFETY: as above.
        let (name, version, schema) = unsafe {
            (
                text("name", table.name)?,
                text("version", table.version)?,
                text("params_schema", table.params_schema)?,
            )
        };
        if name.is_empty()
            || !name
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
        {
            let rule = "letters, digits, `-`, `_` and `.`, at least one of them";
            return Err(LibraryFault::Field {
                field: "name",
                found: format!("{name:?}"),
                expected: rule.to_owned(),
            });
        }
        let schema = ParameterSchema::parse(&schema).map_err(|found| LibraryFault::Field {
            field: "params_schema",
            found,
            expected: "a valid JSON Schema".to_owned(),
        })?;
        Ok(Self {
            name,
            version,
            origin,
            schema,
            functions,
        })
    }

    /// The name that an object file uses.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The plugin's own version.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Where it is from.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// What it does.
    pub fn kind(&self) -> PluginKind {
        match self.functions {
            Functions::ObservationModel(_) => PluginKind::ObservationModel,
            Functions::Driver(_) => PluginKind::Driver,
        }
    }

    /// The JSON Schema of its parameters, as it gave it.
    pub fn params_schema(&self) -> &Value {
        self.schema.given()
    }

    pub(crate) fn schema(&self) -> &ParameterSchema {
        &self.schema
    }

    pub(crate) fn functions(&self) -> Functions {
        self.functions
    }
}

/// # Safety
/// As [`Plugin::from_table`].
unsafe fn check_head(table: *const PluginTable) -> Result<(), LibraryFault> {
    if table.is_null() || !table.is_aligned() {
        return Err(LibraryFault::NoTable);
    }
    // SAFETY: eight bytes are readable, promised by the caller.
    let (size, abi) = unsafe {
        (
            (&raw const (*table).size).read(),
            (&raw const (*table).abi).read(),
        )
    };
    if abi != ABI {
        return Err(LibraryFault::Abi { found: abi });
    }
    check_size("pubs_plugin_table", size, size_of::<PluginTable>())
}

fn check_size(table: &'static str, found: u32, expected: usize) -> Result<(), LibraryFault> {
    if found as usize >= expected {
        Ok(())
    } else {
        Err(LibraryFault::Size {
            table,
            found,
            expected,
        })
    }
}

/// # Safety
/// `table` is a table of this ABI.
unsafe fn functions(table: &PluginTable) -> Result<Functions, LibraryFault> {
    match table.kind {
        KIND_OBSERVATION_MODEL => {
            // SAFETY: null or a table that begins with its size.
            let functions =
                unsafe { sized(table.observation_model, "pubs_observation_model_table") }?;
            check_model(functions)?;
            Ok(Functions::ObservationModel(functions))
        }
        KIND_DRIVER => {
            // SAFETY: null or a table that begins with its size.
            let functions = unsafe { driver_table(table.driver) }?;
            check_driver(&functions)?;
            Ok(Functions::Driver(functions))
        }
        other => Err(LibraryFault::Field {
            field: "kind",
            found: other.to_string(),
            expected: format!(
                "{KIND_OBSERVATION_MODEL} (observation model) or {KIND_DRIVER} (driver)"
            ),
        }),
    }
}

/// # Safety
/// `table` is null or points to a table of functions that begins with its size and lives as long
/// as the process.
unsafe fn sized<T>(table: *const T, name: &'static str) -> Result<&'static T, LibraryFault> {
    // SAFETY: the caller's promise.
    unsafe { size_of_table(table, name, size_of::<T>()) }?;
    // SAFETY: as long as the type, as the size says.
    Ok(unsafe { &*table })
}

/// The size that a table begins with, at least `least`.
///
/// # Safety
/// As [`sized`].
unsafe fn size_of_table<T>(
    table: *const T,
    name: &'static str,
    least: usize,
) -> Result<u32, LibraryFault> {
    if table.is_null() || !table.is_aligned() {
        return Err(LibraryFault::Missing { part: name });
    }
    // SAFETY: a table of functions begins with a u32 size.
    let size = unsafe { table.cast::<u32>().read() };
    check_size(name, size, least)?;
    Ok(size)
}

/// A copy of a driver's table; what an older plugin does not have is absent in it.
///
/// # Safety
/// As [`sized`].
unsafe fn driver_table(table: *const DriverTable) -> Result<DriverTable, LibraryFault> {
    // SAFETY: the caller's promise.
    let size = unsafe { size_of_table(table, "pubs_driver_table", SHORTEST_DRIVER_TABLE) }?;
    let mut copy = DriverTable {
        size,
        reserved: 0,
        open: None,
        close: None,
        sensor: None,
        read: None,
        command: None,
        tare: None,
        stop: None,
        advance_to: None,
        truth: None,
        diagnose: None,
    };
    let known = (size as usize).min(size_of::<DriverTable>());
    // SAFETY: so many bytes are there, as the size says, and are not more than the copy has; the
    // fields are numbers and pointers to functions or null, each of which is a valid `Option`.
    unsafe {
        std::ptr::copy_nonoverlapping(table.cast::<u8>(), (&raw mut copy).cast::<u8>(), known);
    }
    Ok(copy)
}

fn check_model(table: &ObservationModelTable) -> Result<(), LibraryFault> {
    let functions = [
        ("create", table.create.is_some()),
        ("destroy", table.destroy.is_some()),
        ("channels", table.channels.is_some()),
        ("moments", table.moments.is_some()),
    ];
    check_present(&functions)
}

fn check_driver(table: &DriverTable) -> Result<(), LibraryFault> {
    let functions = [
        ("open", table.open.is_some()),
        ("close", table.close.is_some()),
        ("sensor", table.sensor.is_some()),
        ("read", table.read.is_some()),
        ("command", table.command.is_some()),
        ("tare", table.tare.is_some()),
        ("stop", table.stop.is_some()),
    ];
    check_present(&functions)
}

fn check_present(functions: &[(&'static str, bool)]) -> Result<(), LibraryFault> {
    match functions.iter().find(|(_, present)| !present) {
        Some((part, _)) => Err(LibraryFault::Missing { part }),
        None => Ok(()),
    }
}

/// # Safety
/// `text.data` is null or points to `text.length` readable bytes if that is a sane length.
unsafe fn text(field: &'static str, text: Text) -> Result<String, LibraryFault> {
    let fault = |found: String| LibraryFault::Field {
        field,
        found,
        expected: "UTF-8 text of at most 1 MiB".to_owned(),
    };
    if text.data.is_null() {
        return Err(fault("a null pointer".to_owned()));
    }
    if text.length > LONGEST_TEXT {
        return Err(fault(format!("a length of {} bytes", text.length)));
    }
    // SAFETY: not null, and of a sane length.
    let bytes = unsafe { std::slice::from_raw_parts(text.data.cast::<u8>(), text.length) };
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(_) => Err(fault(format!(
            "`{}`, which is not UTF-8",
            String::from_utf8_lossy(bytes)
        ))),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::ffi::{c_char, c_void};

    use pubs_plugin::table::TextSink;

    use super::*;

    unsafe extern "C" fn diagnose(
        _setup: *const u8,
        _setup_length: usize,
        _sink: Option<TextSink>,
        _context: *mut c_void,
        _error: *mut c_char,
        _capacity: usize,
    ) -> i32 {
        0
    }

    unsafe extern "C" fn close(_: *mut c_void, _: *mut c_char, _: usize) -> i32 {
        0
    }

    #[test]
    fn a_drivers_table_is_read_as_far_as_its_size() {
        let shortest = SHORTEST_DRIVER_TABLE;
        let whole = size_of::<DriverTable>();
        let cases = [
            (shortest - 8, None),
            (shortest, Some((true, false))),
            (whole, Some((true, true))),
            (whole + 64, Some((true, true))),
        ];
        for (size, expected) in cases {
            let table = DriverTable {
                size: size as u32,
                reserved: 0,
                open: None,
                close: Some(close),
                sensor: None,
                read: None,
                command: None,
                tare: None,
                stop: None,
                advance_to: None,
                truth: None,
                diagnose: Some(diagnose),
            };
            // SAFETY: no more than a whole table is read, and that is there.
            let copy = unsafe { driver_table(&raw const table) };
            let found = copy
                .ok()
                .map(|copy| (copy.close.is_some(), copy.diagnose.is_some()));
            assert_eq!(found, expected, "a table of {size} bytes");
        }
    }
}
