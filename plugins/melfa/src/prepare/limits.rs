//! Whether the driver's limits and the object's controller agree.

use pubs_plugin::{DriverSetup, JointType};

use crate::params::Params;
use crate::report::Report;

/// A stop that overshoots by more than this share of the force limit is worth a warning.
const WORTH_SAYING: f64 = 0.1;

/// The stop that the engine counts on must be possible, also for the turn about a hinge.
pub(super) fn check(report: &mut Report, params: &Params, setup: &DriverSetup) {
    const NAME: &str = "stop";
    let stop = setup.control.stop_deceleration_m_s2;
    if !(stop > 0.0 && stop <= params.acceleration_m_s2) {
        report.fault(
            NAME,
            format!(
                "the object stops at {stop} m/s² (control.stop_deceleration_m_s2), the driver allows {} m/s²",
                params.acceleration_m_s2
            ),
            "lower the one or raise the other (driver.params.acceleration_m_s2)",
        );
        return;
    }
    let radius_m = match setup.joint.r#type {
        JointType::Revolute => setup.joint.radius_m.filter(|radius| *radius > 0.0),
        _ => None,
    };
    let turning = radius_m.map_or(0.0, |radius| stop / radius);
    if turning > params.angular_acceleration_rad_s2 {
        report.fault(
            NAME,
            format!(
                "a stop at {stop} m/s² about this hinge turns at {turning:.1} rad/s², the driver allows {} rad/s²",
                params.angular_acceleration_rad_s2
            ),
            "lower control.stop_deceleration_m_s2 or raise driver.params.angular_acceleration_rad_s2",
        );
        return;
    }
    report.ok(NAME, format!("{stop} m/s² is within the driver's limits"));
}

/// What filter and jerk add to the force of the worst stop, which the engine does not count.
pub(super) fn reaction(report: &mut Report, params: &Params, setup: &DriverSetup) {
    const NAME: &str = "reaction";
    let control = &setup.control;
    let delay_s = params.filter_ms * 1e-3
        + params.cycle_s()
        + 0.5 * control.stop_deceleration_m_s2 / params.jerk_m_s3;
    let further_n = control.contact_stiffness_n_per_m * control.high_speed_m_s * delay_s;
    let found = format!(
        "filter, cycle and jerk delay a stop by {:.0} ms: at the high speed up to {further_n:.0} N more than `check` works out",
        delay_s * 1e3
    );
    if further_n > WORTH_SAYING * control.force_limit_n {
        report.warn(
            NAME,
            found,
            "leave that room in control.force_limit_n, or lower control.high_speed_m_s or driver.params.filter_ms",
        );
    } else {
        report.ok(NAME, found);
    }
}
