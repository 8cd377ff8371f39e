//! The checks of a driver.
//!
//! Only virtual time is safe to move in: a driver without it may have a robot at its other end, so
//! it is opened and read, and nothing more.

use pubs_plugin::{CheckState, DriverCheck, DriverSetup, DriverStatus, Reading, Twist};

use crate::conformance::{ConformanceReport, asks_for_parameters, bad_input, setup};
use crate::{DriverInstance, DriverPlugin, HostError};

const MS: u64 = 1_000_000;

/// One step of virtual time, as of a controller at 100 Hz.
const STEP_NS: u64 = 10 * MS;

/// How long a command lasts here, and how long the arm has to come to rest after it.
const COMMAND_STEPS: u64 = 20;
const SETTLE_STEPS: u64 = 100;

/// At rest means to move less than this in [`REST_STEPS`].
const REST_M: f64 = 1e-4;
const REST_STEPS: u64 = 10;

pub(super) fn check(
    report: &mut ConformanceReport,
    plugin: &DriverPlugin,
    own: Option<&DriverSetup>,
) {
    let general = setup::door_driver(plugin.plugin().name());
    let setup = own.unwrap_or(&general);
    if let (Some(open), Some(close)) = (plugin.table.open, plugin.table.close) {
        report.record("bad setup", bad_input::garbage_setups(open, close));
    }
    diagnosis(report, plugin, setup, own.is_none());
    let Some(mut driver) = report.made("open", plugin.open(setup), own.is_none()) else {
        return;
    };
    report.record("sensor", Ok(format!("`{}`", driver.sensor())));
    report.record("read", read(&mut driver));
    report.record("truth", truth(&mut driver));
    if driver.has_virtual_time() {
        report.record("virtual time", virtual_time(&mut driver));
        report.record("expiry", comes_to_rest(&mut driver, setup, false));
        report.record("stop", comes_to_rest(&mut driver, setup, true));
        report.record("determinism", determinism(plugin, setup));
    } else {
        for name in ["virtual time", "expiry", "stop", "determinism"] {
            report.skip(
                name,
                "a driver in real time may move a robot, so it is not moved here".to_owned(),
            );
        }
    }
    report.record(
        "close",
        driver
            .close()
            .map(|()| "closed".to_owned())
            .map_err(in_words),
    );
}

/// A diagnosis moves nothing, so it is made whatever is at the other end.
fn diagnosis(
    report: &mut ConformanceReport,
    plugin: &DriverPlugin,
    setup: &DriverSetup,
    generic: bool,
) {
    const NAME: &str = "diagnose";
    match plugin.diagnose(setup) {
        Ok(None) => {
            report.record(NAME, Ok("the driver looks at nothing".to_owned()));
        }
        Ok(Some(checks)) => {
            report.record(NAME, explained(&checks));
        }
        Err(error) if generic && asks_for_parameters(&error) => {
            report.skip(
                NAME,
                format!("needs parameters: pass --object FILE ({error})"),
            );
        }
        Err(error) => {
            report.record(NAME, Err(in_words(error)));
        }
    }
}

/// Every check must say what was found, and every fault how to mend it.
fn explained(checks: &[DriverCheck]) -> Result<String, String> {
    let silent = checks.iter().find(|check| {
        let needs_cure = check.state == CheckState::Fault;
        check.name.is_empty() || check.found.is_empty() || (needs_cure && check.cure.is_empty())
    });
    match silent {
        Some(check) => Err(format!(
            "{check:?} should have a name, what was found, and for a fault its cure"
        )),
        None => Ok(format!("{} checks, each with what was found", checks.len())),
    }
}

fn read(driver: &mut DriverInstance) -> Result<String, String> {
    let first = driver.read().map_err(in_words)?;
    let second = driver.read().map_err(in_words)?;
    if second.time_ns < first.time_ns {
        return Err(format!(
            "time runs backwards: {} ns, then {} ns",
            first.time_ns, second.time_ns
        ));
    }
    Ok(format!(
        "finite, unit orientation, status {:?}",
        second.status
    ))
}

fn truth(driver: &mut DriverInstance) -> Result<String, String> {
    match driver.truth().map_err(in_words)? {
        Some(state) => Ok(format!("known: {state:.4}")),
        None => Ok("nobody knows it".to_owned()),
    }
}

/// Time stands still between calls, moves with them, and not backwards.
fn virtual_time(driver: &mut DriverInstance) -> Result<String, String> {
    let start = driver.read().map_err(in_words)?.time_ns;
    let later = start + STEP_NS;
    driver.advance_to(later).map_err(in_words)?;
    let first = driver.read().map_err(in_words)?;
    std::thread::sleep(std::time::Duration::from_millis(2));
    if driver.read().map_err(in_words)? != first {
        return Err("two readings differ though virtual time stood still".to_owned());
    }
    if first.time_ns > later || first.time_ns < start {
        return Err(format!(
            "after advance_to({later}) from {start} the reading is of {} ns",
            first.time_ns
        ));
    }
    if driver.advance_to(later - 1).is_ok() {
        return Err("advance_to accepted a time in the past; expected an error".to_owned());
    }
    Ok("stands still between calls, refuses the past".to_owned())
}

/// Commands a motion for a while, then lets it expire or stops it, and waits for rest.
fn comes_to_rest(
    driver: &mut DriverInstance,
    setup: &DriverSetup,
    stop: bool,
) -> Result<String, String> {
    let mut run = || -> Result<(Reading, Reading), HostError> {
        let start = driver.read()?;
        let twist = opening(setup, &start);
        let expires_ns = start.time_ns + COMMAND_STEPS * STEP_NS;
        // Stopped in mid-command: the expiry must not be what ends the motion.
        let until = if stop {
            COMMAND_STEPS / 2
        } else {
            COMMAND_STEPS
        };
        let mut now = start.time_ns;
        for _ in 0..until {
            driver.command(twist, expires_ns)?;
            now += STEP_NS;
            driver.advance_to(now)?;
        }
        if stop {
            driver.stop()?;
        }
        driver.advance_to(now + SETTLE_STEPS * STEP_NS)?;
        let settled = driver.read()?;
        driver.advance_to(now + (SETTLE_STEPS + REST_STEPS) * STEP_NS)?;
        Ok((settled, driver.read()?))
    };
    let (settled, last) = run().map_err(in_words)?;
    let cause = if stop { "stop" } else { "the command's expiry" };
    let moved = distance(settled.position_m, last.position_m);
    if moved > REST_M {
        return Err(format!(
            "one second after {cause} the tool still moves: {:.2} mm in {} ms",
            1e3 * moved,
            REST_STEPS * STEP_NS / MS
        ));
    }
    if last.status == DriverStatus::Ready {
        return Err(format!(
            "one second after {cause} the status is still Ready; expected Stopped"
        ));
    }
    Ok(format!(
        "at rest one second after {cause}, status {:?}",
        last.status
    ))
}

/// The same commands to two instances of one setup must give the same readings.
fn determinism(plugin: &DriverPlugin, setup: &DriverSetup) -> Result<String, String> {
    let run = || -> Result<Vec<Reading>, HostError> {
        let mut driver = plugin.open(setup)?;
        let start = driver.read()?;
        let mut now = start.time_ns;
        // The clock may start where the wall clock stands; set both to a round second.
        let origin = now.next_multiple_of(1_000 * MS);
        driver.advance_to(origin)?;
        now = now.max(origin);
        let twist = opening(setup, &start);
        let mut readings = Vec::new();
        for _ in 0..COMMAND_STEPS {
            driver.command(twist, now + 3 * STEP_NS)?;
            now += STEP_NS;
            driver.advance_to(now)?;
            let reading = driver.read()?;
            readings.push(Reading {
                time_ns: reading.time_ns - origin,
                ..reading
            });
        }
        driver.stop()?;
        Ok(readings)
    };
    let (first, second) = (run().map_err(in_words)?, run().map_err(in_words)?);
    match first.iter().zip(&second).position(|(a, b)| a != b) {
        None => {
            Ok("two instances with the same seed and commands give the same readings".to_owned())
        }
        Some(step) => Err(format!(
            "two instances with the same seed and commands differ at step {step}: {:?} and {:?}",
            first[step], second[step]
        )),
    }
}

/// The safe speed along the opening direction, in base axes.
fn opening(setup: &DriverSetup, reading: &Reading) -> Twist {
    let direction = setup.joint.opening_direction.unwrap_or([1.0, 0.0, 0.0]);
    let base = rotated(reading.orientation_xyzw, direction);
    Twist {
        linear_m_s: base.map(|part| part * setup.control.safe_speed_m_s),
        angular_rad_s: [0.0; 3],
    }
}

/// v + 2 w (q × v) + 2 q × (q × v), the rotation of v by the unit quaternion (q, w).
fn rotated([x, y, z, w]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let once = cross([x, y, z], v);
    let twice = cross([x, y, z], once);
    std::array::from_fn(|i| v[i] + 2.0 * (w * once[i] + twice[i]))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

fn in_words(error: HostError) -> String {
    error.to_string()
}

#[cfg(test)]
mod tests {
    use super::rotated;

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let turned = rotated([0.0, 0.0, half, half], [1.0, 0.0, 0.0]);
        for (found, expected) in turned.iter().zip([0.0, 1.0, 0.0]) {
            assert!((found - expected).abs() < 1e-12, "{turned:?}");
        }
    }
}
