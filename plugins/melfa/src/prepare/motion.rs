//! The handshake of MXT, and the posture that the arm is in.

use pubs_melfa_protocol::mxt::Command;

use crate::address::Addresses;
use crate::mxt::{MxtLink, Snapshot};
use crate::params::{Params, s_ns};
use crate::report::Report;
use crate::system::monotonic_ns;

const NAME: &str = "mxt";

/// Command 0 until a reply comes.
pub(super) fn handshake(
    report: &mut Report,
    params: &Params,
    addresses: &Addresses,
) -> Option<(MxtLink, Snapshot)> {
    let opened = MxtLink::open(addresses.bind(params.mxt_bind_port), addresses.mxt);
    let mut link = match opened {
        Ok(link) => link,
        Err(error) => {
            let cure = "is local_address this computer's, and mxt_bind_port free?";
            report.fault(NAME, format!("no socket for MXT: {error}"), cure);
            return None;
        }
    };
    match link.handshake(monotonic_ns() + s_ns(params.handshake_s)) {
        Ok(first) => {
            let [x, y, z] = first.pose.position_mm;
            report.ok(
                NAME,
                format!("answers; the pose is ({x:.1}, {y:.1}, {z:.1}) mm"),
            );
            posture(report, params, &first);
            Some((link, first))
        }
        Err(found) => {
            report.fault(
                NAME,
                format!("{found} from {} (UDP)", addresses.mxt),
                "the program must be at its Mxt line, and its ENET line must name this computer (local_address); check \
                 mxt_port and this computer's firewall",
            );
            None
        }
    }
}

/// The same for a diagnosis. Where the driver may start the program itself, the session is ended
/// properly; else it is left as it was found.
pub(super) fn look(report: &mut Report, params: &Params, addresses: &Addresses) {
    if let Some((mut link, _)) = handshake(report, params, addresses)
        && params.start_program
    {
        link.send(Command::End, None);
    }
}

fn posture(report: &mut Report, params: &Params, first: &Snapshot) {
    const NAME: &str = "posture";
    let Some(joints) = first.joints else {
        report.warn(
            NAME,
            "the controller tells no joints",
            "joint speeds cannot be kept below their limits; keep speed_limit_m_s low",
        );
        return;
    };
    let degrees = joints.map(f64::to_degrees);
    let found = format!("J1 to J6 = {degrees:.1?}°");
    if degrees[4].abs() < params.singularity_deg {
        let cure = "J5 is near zero: begin from a posture with a bent wrist";
        report.fault(NAME, found, cure);
    } else {
        report.ok(NAME, found);
    }
}
