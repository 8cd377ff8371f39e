//! What the driver wants of a controller, in requests.

use std::net::IpAddr;
use std::time::{Duration, Instant};

use pubs_melfa_protocol::r3::{ProgramState, State, known_error, parse_list};

use super::{R3Client, R3Error};
use crate::params::Params;

/// Task slot of the program, and the slot for editing.
const TASK: u8 = 1;
const EDIT: u8 = 9;

/// Between lines of a program in one request.
const LINE_BREAK: &str = "\u{b}";

/// Most bytes of program lines in one request.
const LONGEST_LINES: usize = 240;

/// Between two questions for a state that is awaited.
const POLL: Duration = Duration::from_millis(50);

impl R3Client {
    /// Begins a session. Some clients never do, so a refusal is no fault.
    ///
    /// # Errors
    /// Where there is no reply.
    pub fn begin(&mut self) -> Result<(), R3Error> {
        match self.ask(TASK, "OPEN=PUBS") {
            Err(error) if error.is_fatal() => Err(error),
            _ => Ok(()),
        }
    }

    /// The controller's state. Where only the prefix of the reply tells of an alarm, its number is
    /// asked for.
    ///
    /// # Errors
    /// Where there is no usable reply.
    pub fn state(&mut self) -> Result<State, R3Error> {
        let reply = self.ask_whole(TASK, "DSTATE")?;
        let mut state: State = reply.text.parse()?;
        if state.error == 0 && reply.status.is_in_alarm() {
            let text = self.ask(TASK, "ERROR")?;
            let digits: String = text
                .chars()
                .take_while(|c| *c != ';')
                .filter(char::is_ascii_digit)
                .collect();
            state.error = digits.parse().unwrap_or(0);
        }
        Ok(state)
    }

    /// The longer account of the state.
    ///
    /// # Errors
    /// Where there is no usable reply.
    pub fn program_state(&mut self) -> Result<ProgramState, R3Error> {
        Ok(self.ask(TASK, "STATE")?.parse()?)
    }

    /// An alarm in words: its number, and the controller's own text or what else is known.
    pub fn alarm_text(&mut self, number: u32) -> String {
        let own = self
            .ask(TASK, &format!("ERRORMES{number}"))
            .ok()
            .map(|text| text.trim().to_owned())
            .filter(|text| !text.is_empty());
        let known = own.or_else(|| known_error(number).map(str::to_owned));
        match known {
            Some(text) => format!("alarm {number} ({text})"),
            None => format!("alarm {number}"),
        }
    }

    /// Resets an alarm.
    ///
    /// # Errors
    /// Where the controller refuses.
    pub fn reset_alarm(&mut self) -> Result<(), R3Error> {
        self.ask(TASK, "RSTALRM").map(drop)
    }

    /// Takes the operation right, or gives it back.
    ///
    /// # Errors
    /// Where the controller refuses.
    pub fn operation_right(&mut self, take: bool) -> Result<(), R3Error> {
        let command = if take { "CNTLON" } else { "CNTLOFF" };
        self.ask(TASK, command).map(drop)
    }

    /// Switches the servo on or off; does not wait for it.
    ///
    /// # Errors
    /// Where the controller refuses.
    pub fn servo(&mut self, on: bool) -> Result<(), R3Error> {
        let command = if on { "SRVON" } else { "SRVOFF" };
        self.ask(TASK, command).map(drop)
    }

    /// Asks for the state until it is as wanted or the time is over; the last state.
    ///
    /// # Errors
    /// Where there is no usable reply.
    pub fn await_state(
        &mut self,
        wanted: impl Fn(&State) -> bool,
        within: Duration,
    ) -> Result<State, R3Error> {
        let deadline = Instant::now() + within;
        loop {
            let state = self.state()?;
            if wanted(&state) || Instant::now() >= deadline {
                return Ok(state);
            }
            std::thread::sleep(POLL);
        }
    }

    /// Writes the program that opens MXT.
    ///
    /// # Errors
    /// Where the controller refuses a step.
    pub fn upload(&mut self, params: &Params, local: IpAddr) -> Result<(), R3Error> {
        self.ask(TASK, "NEW")?;
        self.ask(TASK, &format!("LOAD={}", params.program))?;
        self.ask(EDIT, "ECLR")?;
        for lines in in_requests(&upload_lines(params, local)) {
            self.ask(EDIT, &format!("EMDAT{lines}"))?;
        }
        self.ask(TASK, "SAVE").map(drop)
    }

    /// Starts the program from its beginning, once.
    ///
    /// # Errors
    /// Where the controller refuses.
    pub fn start(&mut self, program: &str) -> Result<(), R3Error> {
        self.ask(TASK, "SLOTINIT")?;
        self.ask(TASK, &format!("RUN{program};1")).map(drop)
    }

    /// Stops the program.
    ///
    /// # Errors
    /// Where the controller refuses.
    pub fn stop(&mut self) -> Result<(), R3Error> {
        self.ask(TASK, "STOP").map(drop)
    }

    /// The force sensor by its variable: N and N m.
    ///
    /// # Errors
    /// Where there is no such variable.
    pub fn force(&mut self) -> Result<[f64; 6], R3Error> {
        let text = self.ask(TASK, "VALP_FsCurD;P")?;
        let list = parse_list(&text)?;
        let six = list.get(..6).and_then(|six| six.try_into().ok());
        six.ok_or(R3Error::Few { text })
    }

    /// Ends a session.
    pub fn end(&mut self) {
        // The connection is dropped next; a controller that does not take this loses nothing.
        let _ = self.ask(TASK, "CLOSE");
    }
}

/// The program, line by line: MXT for position data over Ethernet to this computer.
pub fn upload_lines(params: &Params, local: IpAddr) -> Vec<String> {
    vec![
        format!("1 Open \"ENET:{local}\" As #1"),
        format!("2 Mxt 1,0,{}", params.filter_ms.round()),
        "3 Hlt".to_owned(),
        "4 End".to_owned(),
    ]
}

/// Lines joined as long as they fit into one request.
fn in_requests(lines: &[String]) -> Vec<String> {
    let mut requests: Vec<String> = Vec::new();
    for line in lines {
        match requests.last_mut() {
            Some(last) if last.len() + LINE_BREAK.len() + line.len() <= LONGEST_LINES => {
                last.push_str(LINE_BREAK);
                last.push_str(line);
            }
            _ => requests.push(line.clone()),
        }
    }
    requests
}

/// Why a controller in this state must not be asked to move; `None` where it may.
pub fn explained(state: &State, alarm_text: impl FnOnce(u32) -> String) -> Option<String> {
    if state.stop.emergency_stop {
        return Some("emergency stop".to_owned());
    }
    if state.error != 0 {
        return Some(alarm_text(state.error));
    }
    if state.run.teach {
        return Some("the controller is not in AUTOMATIC any more".to_owned());
    }
    if !state.run.servo_on {
        return Some("the servo is off".to_owned());
    }
    if !state.run.running {
        return Some("the program does not run any more".to_owned());
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_program_names_this_computer_and_fits_into_requests() {
        let params = Params {
            filter_ms: 10.0,
            ..Params::default()
        };
        let lines = upload_lines(&params, "192.168.0.9".parse().unwrap());
        assert_eq!(lines[0], "1 Open \"ENET:192.168.0.9\" As #1");
        assert_eq!(lines[1], "2 Mxt 1,0,10");
        let requests = in_requests(&lines);
        assert_eq!(requests.len(), 1);
        assert_eq!(requests[0].split('\u{b}').count(), 4);
        let long: Vec<String> = (0..10).map(|_| "x".repeat(100)).collect();
        let requests = in_requests(&long);
        assert_eq!(requests.len(), 5);
        assert!(
            requests
                .iter()
                .all(|request| request.len() <= LONGEST_LINES)
        );
    }

    #[test]
    fn states_that_forbid_to_move() {
        // Run status: servo 0x20, running 0x40, teach 0x08; stop status: emergency 0x01.
        let cases = [
            ("E0000;1;0", None),
            ("E0010;1;0", Some("emergency stop")),
            ("E0006130;1;0", Some("alarm 6130")),
            ("E8000;1;0", Some("AUTOMATIC")),
            ("C0000;1;0", Some("servo is off")),
            ("A0000;1;0", Some("does not run")),
        ];
        for (text, expected) in cases {
            let state: State = text.parse().unwrap();
            let found = explained(&state, |number| format!("alarm {number}"));
            match expected {
                None => assert_eq!(found, None, "{text}"),
                Some(words) => assert!(found.clone().unwrap().contains(words), "{text}: {found:?}"),
            }
        }
    }
}
