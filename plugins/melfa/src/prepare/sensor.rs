//! The force sensor at rest, and the control cycle by its stream.

use std::time::Duration;

use crate::address::Addresses;
use crate::baseline::{Baseline, BaselineFault, BaselineLimits};
use crate::board::Timed;
use crate::monitor::MonitorLink;
use crate::params::{ForceSource, Params, ms_ns, s_ns};
use crate::r3::R3Client;
use crate::report::Report;
use crate::system::monotonic_ns;
use crate::wrench::{Mounting, Wrench};

const NAME: &str = "force";

/// Between two starts of the stream while nothing comes, ns.
const KNOCK_NS: u64 = 200_000_000;

/// The measured cycle may differ from the one set by this share.
const CYCLE_SHARE: f64 = 0.1;

/// Watches the sensor for a while.
pub(super) fn check(
    report: &mut Report,
    params: &Params,
    addresses: &Addresses,
    r3: &mut R3Client,
) -> (Option<MonitorLink>, Option<Baseline>) {
    match params.force_source {
        ForceSource::None => {
            report.skip(NAME, "force_source is none: the wrench is zero");
            (None, None)
        }
        ForceSource::R3 => (None, over_r3(report, params, r3)),
        ForceSource::Monitor => over_monitor(report, params, addresses),
    }
}

fn over_r3(report: &mut Report, params: &Params, r3: &mut R3Client) -> Option<Baseline> {
    let until_ns = monotonic_ns() + s_ns(params.baseline_s);
    let mut samples = Vec::new();
    while monotonic_ns() < until_ns {
        match r3.force() {
            Ok([fx, fy, fz, tx, ty, tz]) => samples.push(Wrench {
                force: [fx, fy, fz].into(),
                torque: [tx, ty, tz].into(),
            }),
            Err(error) => {
                let cure = "the controller must know a force sensor, or take another force_source";
                report.fault(NAME, error.to_string(), cure);
                return None;
            }
        }
        std::thread::sleep(Duration::from_nanos(ms_ns(params.force_poll_ms)));
    }
    judge(report, params, &samples)
}

fn over_monitor(
    report: &mut Report,
    params: &Params,
    addresses: &Addresses,
) -> (Option<MonitorLink>, Option<Baseline>) {
    let opened = MonitorLink::open(
        params,
        addresses.bind(params.monitor_bind_port),
        addresses.monitor,
    );
    let mut link = match opened {
        Ok(link) => link,
        Err(error) => {
            let cure = "is local_address this computer's, and monitor_bind_port free?";
            report.fault(NAME, format!("no socket for the monitor: {error}"), cure);
            return (None, None);
        }
    };
    if let Err(found) = first_reading(&mut link, params) {
        report.fault(
            NAME,
            format!("{found} from the monitor at {} (UDP)", addresses.monitor),
            "enable the real-time monitor (MONMODE, MONPORT [unverified]), check monitor_port, force_id and this computer's \
             firewall; force_source=r3 or none goes without",
        );
        return (None, None);
    }
    let samples = collect(&mut link, s_ns(params.baseline_s));
    cycle(report, params, &samples);
    let mounting = Mounting::new(params);
    let wrenches: Vec<Wrench> = samples
        .iter()
        .map(|sample| mounting.at_tool(&sample.value))
        .collect();
    (Some(link), judge(report, params, &wrenches))
}

fn first_reading(link: &mut MonitorLink, params: &Params) -> Result<(), String> {
    let until_ns = monotonic_ns() + s_ns(params.handshake_s);
    let (mut refused, mut without) = (false, 0);
    while monotonic_ns() < until_ns {
        link.subscribe();
        let knock_ns = monotonic_ns() + KNOCK_NS;
        while monotonic_ns() < knock_ns {
            let found = link.receive(knock_ns);
            if !found.wrenches.is_empty() {
                return Ok(());
            }
            refused |= found.refused;
            without += found.without_force;
        }
    }
    Err(match (without, refused) {
        (1.., _) => format!(
            "{without} packets, none with a force (force_id = {})",
            params.force_id
        ),
        (0, true) => "the port is closed: nothing".to_owned(),
        (0, false) => "no packet".to_owned(),
    })
}

fn collect(link: &mut MonitorLink, for_ns: u64) -> Vec<Timed<Wrench>> {
    let until_ns = monotonic_ns() + for_ns;
    let mut samples = Vec::new();
    while monotonic_ns() < until_ns {
        samples.extend(link.receive(until_ns).wrenches);
    }
    samples
}

/// The stream has one packet per control cycle.
fn cycle(report: &mut Report, params: &Params, samples: &[Timed<Wrench>]) {
    const NAME: &str = "cycle";
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    let intervals = samples.len().saturating_sub(1).max(1) as f64;
    let measured_ms = (last.time_ns - first.time_ns) as f64 * 1e-6 / intervals;
    let found = format!(
        "{measured_ms:.2} ms measured, cycle_ms = {}",
        params.cycle_ms
    );
    if (measured_ms - params.cycle_ms).abs() <= CYCLE_SHARE * params.cycle_ms {
        report.ok(NAME, found);
    } else {
        report.warn(
            NAME,
            found,
            "set cycle_ms to the controller's: 3.5 (CR800-R, -D) or 7.11 (CR800-Q, CR750, CR751); else packets are lost",
        );
    }
}

fn judge(report: &mut Report, params: &Params, samples: &[Wrench]) -> Option<Baseline> {
    let limits = BaselineLimits::new(params);
    let result = Baseline::of(samples, params.baseline_s)
        .and_then(|baseline| baseline.check(&limits).map(|()| baseline));
    match result {
        Ok(baseline) => {
            let (force, torque) = (&baseline.mean.force, &baseline.mean.torque);
            report.ok(
                NAME,
                format!(
                    "{baseline}; if nothing is held, zero = given with force_offset_n = [{:.2}, {:.2}, {:.2}], \
                     torque_offset_nm = [{:.3}, {:.3}, {:.3}] takes it off for later sessions",
                    force.x, force.y, force.z, torque.x, torque.y, torque.z
                ),
            );
            Some(baseline)
        }
        Err(fault) => {
            report.fault(NAME, fault.to_string(), cure(&fault));
            None
        }
    }
}

fn cure(fault: &BaselineFault) -> &'static str {
    match fault {
        BaselineFault::Few { .. } => "see that the stream has one packet per cycle",
        BaselineFault::Loaded { .. } => {
            "or take off what the sensor shows of nothing (zero = given, force_offset_n)"
        }
        BaselineFault::Saturated { .. } => "nothing moves with a saturated sensor",
        BaselineFault::Noisy { .. } | BaselineFault::Drifting { .. } => {
            "wait and begin again; if it stays, see the guide's section on the force sensor"
        }
    }
}
