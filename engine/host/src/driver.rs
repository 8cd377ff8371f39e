//! A driver behind its table.

use std::ffi::{c_char, c_void};
use std::fmt;
use std::sync::Arc;

use pubs_plugin::table::{DriverTable, PlainFunction, RawReading};
use pubs_plugin::{DriverCheck, DriverSetup, Reading, Support, Twist};

use crate::call::{Failure, call, demand, filled_text};
use crate::plugin::{Functions, Plugin};
use crate::reading::checked;
use crate::registry::wrong_kind;
use crate::{HostError, ParameterFault, PluginKind};

/// Longest sensor name, bytes with its NUL.
const SENSOR_BYTES: usize = 256;

/// A driver plugin, ready to open a robot.
#[derive(Debug, Clone)]
pub struct DriverPlugin {
    pub(crate) plugin: Arc<Plugin>,
    pub(crate) table: DriverTable,
}

impl DriverPlugin {
    /// The plugin as a driver.
    ///
    /// # Errors
    /// Where it is an observation model.
    pub fn new(plugin: Arc<Plugin>) -> Result<Self, HostError> {
        match plugin.functions() {
            Functions::Driver(table) => Ok(Self { plugin, table }),
            Functions::ObservationModel(_) => Err(wrong_kind(&plugin, PluginKind::Driver)),
        }
    }

    /// Name, version, origin, schema.
    pub fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    /// All that is wrong with a `[driver]` table; pointers are from that table.
    pub fn check_parameters(&self, driver: &serde_json::Value) -> Vec<ParameterFault> {
        self.plugin.schema().check_driver(driver)
    }

    /// Connects; nothing moves yet.
    ///
    /// # Errors
    /// Where the parameters do not fit the schema, the plugin refuses, or it does not name its
    /// sensor.
    pub fn open(&self, setup: &DriverSetup) -> Result<DriverInstance, HostError> {
        let json = self.setup_text(setup)?;
        let failed = |failure| self.failed("open", failure);
        let open = self.table.open.ok_or_else(|| failed(Failure::Absent))?;
        let mut handle = std::ptr::null_mut();
        // SAFETY: `open` of a checked table; the arguments are as the header says.
        demand(|error, capacity| unsafe {
            open(json.as_ptr(), json.len(), &mut handle, error, capacity)
        })
        .map_err(failed)?;
        let mut instance = DriverInstance {
            plugin: Arc::clone(&self.plugin),
            table: self.table,
            handle,
            sensor: String::new(),
            open: true,
        };
        instance.sensor = instance
            .ask_sensor()
            .map_err(|failure| instance.failed("sensor", failure))?;
        Ok(instance)
    }

    /// What stands in the way of moving, without moving; `None` where the driver does not look.
    ///
    /// # Errors
    /// Where the parameters do not fit the schema, the plugin refuses, or gives what are no checks.
    pub fn diagnose(&self, setup: &DriverSetup) -> Result<Option<Vec<DriverCheck>>, HostError> {
        let json = self.setup_text(setup)?;
        let failed = |failure| self.failed("diagnose", failure);
        let Some(diagnose) = self.table.diagnose else {
            return Ok(None);
        };
        let mut text: Vec<u8> = Vec::new();
        // SAFETY: a function of a checked table; the sink gets the text it is made for.
        let support = call(|error, capacity| unsafe {
            let context = (&raw mut text).cast::<c_void>();
            diagnose(
                json.as_ptr(),
                json.len(),
                Some(keep_text),
                context,
                error,
                capacity,
            )
        });
        match support.map_err(failed)? {
            Support::Absent => Ok(None),
            Support::Given => serde_json::from_slice(&text).map(Some).map_err(|error| {
                failed(Failure::Value(format!(
                    "the checks are not as they should be: {error}"
                )))
            }),
        }
    }

    /// The setup as JSON, if its parameters fit the schema.
    fn setup_text(&self, setup: &DriverSetup) -> Result<Vec<u8>, HostError> {
        let faults = self.check_parameters(&setup.driver);
        if !faults.is_empty() {
            return Err(HostError::Parameters {
                plugin: self.plugin.name().to_owned(),
                faults,
            });
        }
        serde_json::to_vec(setup).map_err(|error| HostError::Setup {
            plugin: self.plugin.name().to_owned(),
            message: error.to_string(),
        })
    }

    fn failed(&self, function: &'static str, failure: Failure) -> HostError {
        HostError::Call {
            plugin: self.plugin.name().to_owned(),
            function,
            context: String::new(),
            failure,
        }
    }
}

/// Longest text that is kept of a plugin's, bytes.
const LONGEST_TEXT: usize = 1 << 20;

/// Appends to the `Vec<u8>` that `context` points to.
unsafe extern "C" fn keep_text(context: *mut c_void, text: *const u8, length: usize) {
    if context.is_null() || text.is_null() || length > LONGEST_TEXT {
        return;
    }
    // SAFETY: `diagnose` above passes its own vector, and the plugin hands `context` back; the text
    // has `length` bytes, as the header asks.
    unsafe {
        let kept = &mut *context.cast::<Vec<u8>>();
        kept.extend_from_slice(std::slice::from_raw_parts(text, length));
    }
}

/// An open driver, for one thread at a time. It closes when dropped, and keeps its plugin until then.
pub struct DriverInstance {
    plugin: Arc<Plugin>,
    table: DriverTable,
    handle: *mut c_void,
    sensor: String,
    open: bool,
}

// SAFETY: the contract of the ABI: a driver is called from one thread at a time, whichever it is.
// It is not Sync.
unsafe impl Send for DriverInstance {}

impl fmt::Debug for DriverInstance {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.plugin.name();
        formatter
            .debug_struct("DriverInstance")
            .field("plugin", &name)
            .field("sensor", &self.sensor)
            .finish()
    }
}

impl DriverInstance {
    /// The plugin it is from.
    pub fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    /// Names the force sensor, as `[source] sensor` of an object file does.
    pub fn sensor(&self) -> &str {
        &self.sensor
    }

    /// The newest measurement, checked: every number finite, the orientation a unit quaternion.
    ///
    /// # Errors
    /// Where the link is lost or a value is not so; names the field.
    pub fn read(&mut self) -> Result<Reading, HostError> {
        let mut raw = RawReading {
            time_ns: 0,
            position_m: [f64::NAN; 3],
            ..RawReading::default()
        };
        let Some(read) = self.table.read else {
            return Err(self.failed("read", Failure::Absent));
        };
        // SAFETY: the handle is open and `raw` is ours.
        let result =
            demand(|error, capacity| unsafe { read(self.handle, &mut raw, error, capacity) });
        let result = result.and_then(|()| checked(&raw).map_err(Failure::Value));
        result.map_err(|failure| self.failed("read", failure))
    }

    /// Moves the tool with `twist` (m/s, rad/s) until `expires_ns` on the clock of
    /// [`Reading::time_ns`].
    ///
    /// # Errors
    /// Where the twist is not finite (the plugin is not asked then), the link is lost or the robot
    /// refuses.
    pub fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), HostError> {
        if !twist
            .linear_m_s
            .iter()
            .chain(&twist.angular_rad_s)
            .all(|value| value.is_finite())
        {
            return Err(self.failed(
                "command",
                Failure::Value(format!("the engine's {twist:?} is not finite")),
            ));
        }
        let Some(command) = self.table.command else {
            return Err(self.failed("command", Failure::Absent));
        };
        // SAFETY: the handle is open and `twist` is ours.
        let result = demand(|error, capacity| unsafe {
            command(self.handle, &twist, expires_ns, error, capacity)
        });
        result.map_err(|failure| self.failed("command", failure))
    }

    /// Takes the present wrench for zero. Only at rest and out of contact.
    ///
    /// # Errors
    /// Where the baseline is not quiet.
    pub fn tare(&mut self) -> Result<(), HostError> {
        self.plain("tare", self.table.tare)
    }

    /// Ramps to rest and stays there until the next command.
    ///
    /// # Errors
    /// Where the robot cannot be told.
    pub fn stop(&mut self) -> Result<(), HostError> {
        self.plain("stop", self.table.stop)
    }

    /// Disconnects, as dropping does, and tells what went wrong with it.
    ///
    /// # Errors
    /// Where the plugin says so.
    pub fn close(mut self) -> Result<(), HostError> {
        self.open = false;
        self.plain("close", self.table.close)
    }

    /// Whether [`advance_to`](Self::advance_to) works.
    pub fn has_virtual_time(&self) -> bool {
        self.table.advance_to.is_some()
    }

    /// From the first call on, time stands still but for these calls.
    ///
    /// # Errors
    /// Where the driver lives in real time or the time lies in the past.
    pub fn advance_to(&mut self, time_ns: u64) -> Result<(), HostError> {
        let Some(advance_to) = self.table.advance_to else {
            let text = "this driver has no virtual time".to_owned();
            return Err(self.failed("advance_to", Failure::Value(text)));
        };
        // SAFETY: the handle is open.
        let result =
            demand(|error, capacity| unsafe { advance_to(self.handle, time_ns, error, capacity) });
        result.map_err(|failure| self.failed("advance_to", failure))
    }

    /// The true joint state (rad or m), for scoring alone; `None` where nobody knows it.
    ///
    /// # Errors
    /// Where the plugin fails or the state is not finite.
    pub fn truth(&mut self) -> Result<Option<f64>, HostError> {
        let Some(truth) = self.table.truth else {
            return Ok(None);
        };
        let mut state = f64::NAN;
        // SAFETY: the handle is open and `state` is ours.
        match call(|error, capacity| unsafe { truth(self.handle, &mut state, error, capacity) }) {
            Ok(Support::Absent) => Ok(None),
            Ok(Support::Given) if state.is_finite() => Ok(Some(state)),
            Ok(Support::Given) => {
                let text = format!("the true state is {state}; expected a finite number");
                Err(self.failed("truth", Failure::Value(text)))
            }
            Err(failure) => Err(self.failed("truth", failure)),
        }
    }

    fn plain(
        &mut self,
        name: &'static str,
        function: Option<PlainFunction>,
    ) -> Result<(), HostError> {
        let Some(function) = function else {
            return Err(self.failed(name, Failure::Absent));
        };
        // SAFETY: the handle is open; after `close` it is not used again.
        let result = demand(|error: *mut c_char, capacity| unsafe {
            function(self.handle, error, capacity)
        });
        result.map_err(|failure| self.failed(name, failure))
    }

    fn ask_sensor(&self) -> Result<String, Failure> {
        let sensor = self.table.sensor.ok_or(Failure::Absent)?;
        let mut text = [0_u8; SENSOR_BYTES];
        // SAFETY: the handle is open and the text has SENSOR_BYTES bytes.
        demand(|error, capacity| unsafe {
            sensor(
                self.handle,
                text.as_mut_ptr().cast(),
                SENSOR_BYTES,
                error,
                capacity,
            )
        })?;
        match filled_text(&text).map_err(Failure::Value)? {
            name if name.is_empty() => Err(Failure::Value("the sensor has no name".to_owned())),
            name => Ok(name),
        }
    }

    #[cold]
    fn failed(&self, function: &'static str, failure: Failure) -> HostError {
        HostError::Call {
            plugin: self.plugin.name().to_owned(),
            function,
            context: String::new(),
            failure,
        }
    }
}

impl Drop for DriverInstance {
    fn drop(&mut self) {
        if self.open {
            // A failure has nobody left to be told.
            let _ = self.plain("close", self.table.close);
        }
    }
}
