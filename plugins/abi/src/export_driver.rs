//! The table of a driver written in Rust.

use std::ffi::{c_char, c_void};
use std::marker::PhantomData;

use crate::boundary::{ErrorBuffer, guarded, hand_out, parse_setup, place, take_back, write_text};
use crate::table::{ABI, DriverTable, KIND_DRIVER, PluginTable, RawReading, Text, TextSink};
use crate::{Driver, DriverSetup, PluginError, Reading, Support, Twist};

/// The table of driver `D`: what a built-in plugin's `table()` returns and what
/// [`export_driver!`](crate::export_driver) exports.
pub const fn driver_table<D: Driver>() -> &'static PluginTable {
    Table::<D>::PLUGIN
}

struct Table<D>(PhantomData<D>);

impl<D: Driver> Table<D> {
    const FUNCTIONS: &'static DriverTable = &DriverTable {
        size: size_of::<DriverTable>() as u32,
        reserved: 0,
        open: Some(open::<D>),
        close: Some(close::<D>),
        sensor: Some(sensor::<D>),
        read: Some(read::<D>),
        command: Some(command::<D>),
        tare: Some(tare::<D>),
        stop: Some(stop::<D>),
        advance_to: if D::VIRTUAL_TIME {
            Some(advance_to::<D>)
        } else {
            None
        },
        truth: Some(truth::<D>),
        diagnose: Some(diagnose::<D>),
    };
    const PLUGIN: &'static PluginTable = &PluginTable {
        size: size_of::<PluginTable>() as u32,
        abi: ABI,
        kind: KIND_DRIVER,
        reserved: 0,
        name: Text::new(D::NAME),
        version: Text::new(D::VERSION),
        params_schema: Text::new(D::PARAMS_SCHEMA),
        observation_model: std::ptr::null(),
        driver: Self::FUNCTIONS,
    };
}

/// # Safety
/// `instance` is null or came from `open::<D>`, is not closed yet, and nobody else uses it meanwhile.
unsafe fn borrow<'a, D>(instance: *mut c_void) -> Result<&'a mut D, PluginError> {
    // SAFETY: promised by the caller.
    unsafe { place(instance.cast::<D>(), "instance") }
}

fn raw(reading: Reading) -> RawReading {
    RawReading {
        time_ns: reading.time_ns,
        position_m: reading.position_m,
        orientation_xyzw: reading.orientation_xyzw,
        force_n: reading.force_n,
        torque_nm: reading.torque_nm,
        status: reading.status as u32,
        reserved: 0,
    }
}

unsafe extern "C" fn open<D: Driver>(
    setup: *const u8,
    setup_length: usize,
    instance: *mut *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let setup = parse_setup::<DriverSetup>(setup, setup_length)?;
                hand_out(D::open(&setup)?, instance)
            },
        )
    }
}

unsafe extern "C" fn close<D: Driver>(
    instance: *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || take_back::<D>(instance),
        )
    }
}

unsafe extern "C" fn sensor<D: Driver>(
    instance: *mut c_void,
    text: *mut c_char,
    capacity: usize,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                write_text(borrow::<D>(instance)?.sensor(), text, capacity);
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn read<D: Driver>(
    instance: *mut c_void,
    reading: *mut RawReading,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let target = place(reading, "reading")?;
                *target = raw(borrow::<D>(instance)?.read()?);
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn command<D: Driver>(
    instance: *mut c_void,
    twist: *const Twist,
    expires_ns: u64,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let twist = *twist
                    .as_ref()
                    .ok_or_else(|| PluginError::new("`twist` is null"))?;
                borrow::<D>(instance)?.command(twist, expires_ns)?;
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn tare<D: Driver>(
    instance: *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                borrow::<D>(instance)?.tare()?;
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn stop<D: Driver>(
    instance: *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                borrow::<D>(instance)?.stop()?;
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn advance_to<D: Driver>(
    instance: *mut c_void,
    time_ns: u64,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                borrow::<D>(instance)?.advance_to(time_ns)?;
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn truth<D: Driver>(
    instance: *mut c_void,
    state: *mut f64,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let target = place(state, "state")?;
                let Some(value) = borrow::<D>(instance)?.truth() else {
                    return Ok(Support::Absent);
                };
                *target = value;
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn diagnose<D: Driver>(
    setup: *const u8,
    setup_length: usize,
    sink: Option<TextSink>,
    sink_context: *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let sink = sink.ok_or_else(|| PluginError::new("`sink` is null"))?;
                let setup = parse_setup::<DriverSetup>(setup, setup_length)?;
                let Some(checks) = D::diagnose(&setup)? else {
                    return Ok(Support::Absent);
                };
                let json = serde_json::to_string(&checks)
                    .map_err(|error| PluginError::new(error.to_string()))?;
                sink(sink_context, json.as_ptr(), json.len());
                Ok(Support::Given)
            },
        )
    }
}
