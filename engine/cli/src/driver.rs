//! Opening the driver of an object.

use clap::Args;
use pubs_core::Task;
use pubs_core::object::Overrides;
use pubs_core::seed::stream;
use pubs_host::{DriverInstance, Registry};

use crate::failure::Failure;
use crate::options::LayerOptions;
use crate::show;

/// Which driver moves the arm, and on which clock.
#[derive(Args)]
pub struct DriverOptions {
    /// Use this driver plugin instead of the object's
    #[arg(long, value_name = "PLUGIN")]
    pub driver: Option<String>,
    /// Run on a virtual clock: the same byte for byte each time (drivers with virtual time only)
    #[arg(long)]
    pub lockstep: bool,
    /// Use the object although its numbers were taken with another force sensor
    #[arg(long)]
    pub accept_sensor: bool,
}

impl DriverOptions {
    /// The overrides of `layers`, and the driver over them.
    pub fn overrides(&self, layers: &LayerOptions) -> Overrides {
        let driver = self
            .driver
            .iter()
            .map(|name| format!("driver.plugin={name}"));
        Overrides::from_process(layers.set.iter().cloned().chain(driver))
    }
}

/// Connects to the robot; nothing moves yet.
///
/// # Errors
/// Where the object names no driver, or it cannot do what is asked.
pub fn open(
    task: &Task,
    registry: &Registry,
    options: &DriverOptions,
    seed: u64,
) -> Result<DriverInstance, Failure> {
    let (Some(driver), Some(setup)) = (&task.driver, task.driver_setup(stream(seed, "driver")))
    else {
        return Err(Failure::invalid(format!(
            "object `{}` has no [driver]: add one, or name a driver with --driver",
            task.name
        )));
    };
    let arm = registry.driver(&driver.plugin)?.open(&setup)?;
    if options.lockstep && !arm.has_virtual_time() {
        return Err(Failure::invalid(format!(
            "driver `{}` lives in real time and cannot run in lockstep; leave out --lockstep",
            driver.plugin
        )));
    }
    show::detail(|| {
        let plugin = arm.plugin();
        format!(
            "driver: {} {}, {}; force sensor {}",
            plugin.name(),
            plugin.version(),
            plugin.origin(),
            arm.sensor()
        )
    });
    Ok(arm)
}

/// Refuses an object whose numbers were taken with another sensor.
///
/// # Errors
/// Where they were, unless that is accepted.
pub fn check_sensor(task: &Task, arm: &DriverInstance, accept: bool) -> Result<(), Failure> {
    let Some(sensor) = task
        .sensor
        .as_deref()
        .filter(|sensor| *sensor != arm.sensor())
    else {
        return Ok(());
    };
    if !accept {
        return Err(Failure::incompatible(format!(
            "the object's numbers were taken with the force sensor `{sensor}`, driver `{}` has `{}`: forces may differ \
             by scale and offset; calibrate with this sensor, or go on with --accept-sensor",
            arm.plugin().name(),
            arm.sensor()
        )));
    }
    show::say(&format!(
        "warning: sensor `{}` accepted in place of `{sensor}`",
        arm.sensor()
    ));
    Ok(())
}
