//! What R3 tells: reachable, mode, alarm, servo, program.

use std::time::Duration;

use pubs_melfa_protocol::r3::{NETWORK_ERROR, State};

use crate::address::Addresses;
use crate::params::{Params, Upload};
use crate::r3::{R3Client, R3Error};
use crate::report::Report;

/// A servo needs its time.
const SERVO_TIME: Duration = Duration::from_secs(10);

/// A program starts at once, or fails soon.
const START_TIME: Duration = Duration::from_secs(3);

/// An alarm is gone at once, or stays.
const RESET_TIME: Duration = Duration::from_secs(2);

/// Connects and asks for the state.
pub(super) fn reach(
    report: &mut Report,
    params: &Params,
    addresses: &Addresses,
) -> Option<(R3Client, State)> {
    const NAME: &str = "controller";
    let timeout = Duration::from_secs_f64(params.r3_timeout_s);
    let connected = R3Client::connect(addresses.r3, params.r3_terminator, timeout);
    let result = connected.and_then(|mut client| {
        client.begin()?;
        let state = client.state()?;
        Ok((client, state))
    });
    match result {
        Ok(reached) => {
            report.ok(NAME, format!("R3 answers at {}", addresses.r3));
            Some(reached)
        }
        Err(error) => {
            report.fault(
                NAME,
                format!("R3 at {} (TCP): {error}", addresses.r3),
                "check power, cable, host and r3_port, that this computer is in the controller's subnet, and that no other \
                 client (RT ToolBox) holds the connection",
            );
            None
        }
    }
}

/// Mode, emergency stop, alarm. The state after a reset, where one was made.
pub(super) fn readiness(
    report: &mut Report,
    params: &Params,
    client: &mut R3Client,
    state: State,
    act: bool,
) -> State {
    if state.run.teach {
        report.fault(
            "mode",
            "the controller is not in AUTOMATIC",
            "turn the mode switch to AUTOMATIC and disable the teach pendant (its enable switch off)",
        );
    } else {
        report.ok("mode", "AUTOMATIC");
    }
    if state.stop.emergency_stop {
        report.fault(
            "emergency stop",
            "pressed",
            "see why it was pressed; release it, then reset the alarm at the pendant",
        );
    } else {
        report.ok("emergency stop", "released");
    }
    alarm(report, params, client, state, act)
}

fn alarm(
    report: &mut Report,
    params: &Params,
    client: &mut R3Client,
    state: State,
    act: bool,
) -> State {
    const NAME: &str = "alarm";
    if state.error == 0 {
        report.ok(NAME, "none");
        return state;
    }
    let text = client.alarm_text(state.error);
    if act && params.reset_alarm && !state.stop.emergency_stop {
        let reset = client
            .reset_alarm()
            .and_then(|()| client.await_state(|state| state.error == 0, RESET_TIME));
        if let Ok(after) = reset
            && after.error == 0
        {
            report.ok(NAME, format!("{text}, reset"));
            return after;
        }
        let cure = "clear its cause; the controller does not let it be reset";
        report.fault(NAME, text, cure);
        return state;
    }
    report.fault(
        NAME,
        text,
        "clear its cause and reset it at the pendant, or let the opening reset it (driver.params.reset_alarm=true)",
    );
    state
}

/// The servo, switched on where that is allowed.
pub(super) fn servo(
    report: &mut Report,
    params: &Params,
    client: &mut R3Client,
    state: &State,
    act: bool,
) {
    const NAME: &str = "servo";
    if state.run.servo_on {
        report.ok(NAME, "on");
        return;
    }
    if !params.servo_on {
        let cure = "switch it on at the pendant, or allow it (driver.params.servo_on=true)";
        report.fault(NAME, "off", cure);
        return;
    }
    if !act {
        report.warn(NAME, "off", "nothing to do: the opening switches it on");
        return;
    }
    let result = with_right(params, client, |client| {
        client.servo(true)?;
        client.await_state(|state| state.run.servo_on || state.error != 0, SERVO_TIME)
    });
    match result {
        Ok(state) if state.run.servo_on => report.ok(NAME, "switched on"),
        Ok(state) => {
            let reason = match state.error {
                0 => "it does not come on".to_owned(),
                number => client.alarm_text(number),
            };
            let cure = "check emergency stop, door switch and enabling device, then switch it on at the pendant";
            report.fault(NAME, reason, cure);
        }
        Err(error) => report.fault(NAME, error.to_string(), RIGHT_CURE),
    }
}

const RIGHT_CURE: &str = "give the operation right to the network: AUTOMATIC, teach pendant disabled, no other client in control";

/// Does something that needs the operation right, and gives the right back.
fn with_right<T>(
    params: &Params,
    client: &mut R3Client,
    action: impl FnOnce(&mut R3Client) -> Result<T, R3Error>,
) -> Result<T, R3Error> {
    if params.take_right {
        client.operation_right(true)?;
    }
    let result = action(client);
    if params.take_right {
        client.operation_right(false)?;
    }
    result
}

/// The program that opens MXT, started where that is allowed. Whether it runs.
pub(super) fn program(
    report: &mut Report,
    params: &Params,
    client: &mut R3Client,
    state: &State,
    addresses: &Addresses,
    act: bool,
) -> bool {
    const NAME: &str = "program";
    if state.run.running {
        named(report, params, client);
        return true;
    }
    if !params.start_program {
        report.fault(
            NAME,
            "no program runs",
            format!(
                "start `{}` at the pendant, or allow it (driver.params.start_program=true)",
                params.program
            ),
        );
        return false;
    }
    if !act {
        report.warn(
            NAME,
            "no program runs",
            "nothing to do: the opening starts it",
        );
        return false;
    }
    let result = with_right(params, client, |client| start(params, client, addresses));
    match result {
        Ok(state) if state.run.running => {
            report.ok(NAME, format!("`{}` started", params.program));
            true
        }
        Ok(state) => {
            not_running(report, params, client, &state);
            false
        }
        Err(error) => {
            report.fault(
                NAME,
                format!("`{}` cannot be started: {error}", params.program),
                RIGHT_CURE,
            );
            false
        }
    }
}

fn named(report: &mut Report, params: &Params, client: &mut R3Client) {
    let found = client.program_state().map(|state| state.program);
    match found {
        Ok(name) if name.is_empty() || name.eq_ignore_ascii_case(&params.program) => {
            report.ok("program", format!("`{}` runs", params.program));
        }
        Ok(name) => report.warn(
            "program",
            format!("`{name}` runs, not `{}`", params.program),
            "nothing to do if it opens MXT for position data; else stop it at the pendant",
        ),
        Err(error) => report.warn("program", format!("one runs; {error}"), "nothing to do"),
    }
}

fn start(params: &Params, client: &mut R3Client, addresses: &Addresses) -> Result<State, R3Error> {
    let local = match addresses.local {
        Some(local) => local,
        None => client.local_address()?,
    };
    if params.upload_program == Upload::Always {
        client.upload(params, local)?;
    }
    match client.start(&params.program) {
        Err(R3Error::Refused { .. }) if params.upload_program == Upload::Missing => {
            client.upload(params, local)?;
            client.start(&params.program)?;
        }
        other => other?,
    }
    client.await_state(|state| state.run.running || state.error != 0, START_TIME)
}

fn not_running(report: &mut Report, params: &Params, client: &mut R3Client, state: &State) {
    let found = match state.error {
        0 => "it was started, but does not run".to_owned(),
        number => client.alarm_text(number),
    };
    let cure = if state.error == NETWORK_ERROR {
        "the controller cannot open its line to this computer: does local_address name it as the controller sees it, and is \
         the link up?"
            .to_owned()
    } else {
        format!(
            "look at the program `{}` at the pendant: it must open \"ENET:<this computer>\" and run Mxt 1,0",
            params.program
        )
    };
    report.fault("program", found, cure);
}
