//! All that must hold before the arm may move, in the order in which to mend it.
//!
//! The same checks serve the opening, which acts where the parameters let it (servo on, program
//! started) and ends at the first fault, and the diagnosis, which changes nothing and goes on.

mod controller;
mod limits;
mod motion;
mod sensor;

use pubs_plugin::{DriverCheck, DriverSetup, PluginError};

use crate::address::Addresses;
use crate::monitor::MonitorLink;
use crate::mxt::{MxtLink, Snapshot};
use crate::params::Params;
use crate::r3::R3Client;
use crate::report::Report;
use crate::wrench::Wrench;

/// What a session needs.
#[derive(Debug)]
pub struct Ready {
    /// Where everything is.
    pub addresses: Addresses,
    /// Connected, the controller ready and its program running.
    pub r3: R3Client,
    /// Subscribed, where force comes from the monitor.
    pub monitor: Option<MonitorLink>,
    /// Mean wrench of the baseline, tool axes; zero without a sensor.
    pub resting: Wrench,
    /// After the handshake.
    pub mxt: MxtLink,
    /// Where the arm is.
    pub first: Snapshot,
}

/// Prepares a session.
///
/// # Errors
/// The first thing that is missing, with its cure.
pub fn prepare(params: &Params, setup: &DriverSetup) -> Result<Ready, PluginError> {
    let mut report = Report::default();
    acting(&mut report, params, setup).ok_or_else(|| report.refusal())
}

/// `None` where the report has a fault.
fn acting(report: &mut Report, params: &Params, setup: &DriverSetup) -> Option<Ready> {
    let sound = |report: &Report| (!report.has_fault()).then_some(());
    limits::check(report, params, setup);
    sound(report)?;
    let addresses = addresses(report, params)?;
    let (mut r3, state) = controller::reach(report, params, &addresses)?;
    let state = controller::readiness(report, params, &mut r3, state, true);
    sound(report)?;
    controller::servo(report, params, &mut r3, &state, true);
    sound(report)?;
    let (monitor, baseline) = sensor::check(report, params, &addresses, &mut r3);
    sound(report)?;
    controller::program(report, params, &mut r3, &state, &addresses, true);
    sound(report)?;
    let (mxt, first) = motion::handshake(report, params, &addresses)?;
    sound(report)?;
    Some(Ready {
        addresses,
        r3,
        monitor,
        resting: baseline.map_or_else(Wrench::default, |baseline| baseline.mean),
        mxt,
        first,
    })
}

/// Looks at everything, moves and changes nothing.
pub fn diagnose(params: &Params, setup: &DriverSetup) -> Vec<DriverCheck> {
    let mut report = Report::default();
    limits::check(&mut report, params, setup);
    limits::reaction(&mut report, params, setup);
    looking(&mut report, params);
    report.into_checks()
}

fn looking(report: &mut Report, params: &Params) -> Option<()> {
    let addresses = addresses(report, params)?;
    let Some((mut r3, state)) = controller::reach(report, params, &addresses) else {
        for name in ["mode", "alarm", "servo", "force", "program", "mxt"] {
            report.skip(name, "the controller is not reached");
        }
        return None;
    };
    let state = controller::readiness(report, params, &mut r3, state, false);
    controller::servo(report, params, &mut r3, &state, false);
    drop(sensor::check(report, params, &addresses, &mut r3));
    let running = controller::program(report, params, &mut r3, &state, &addresses, false);
    if running {
        motion::look(report, params, &addresses);
    } else {
        report.skip("mxt", "the program does not run, so nothing answers");
    }
    r3.end();
    Some(())
}

fn addresses(report: &mut Report, params: &Params) -> Option<Addresses> {
    match Addresses::find(params) {
        Ok(addresses) => Some(addresses),
        Err(found) => {
            let cure =
                "give the controller's address, such as --set driver.params.host=192.168.0.20";
            report.fault("address", found, cure);
            None
        }
    }
}
