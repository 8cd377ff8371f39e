//! The supervision thread: asks for the controller's state a few times a second, and stops
//! everything where the controller says that it must not move.
//!
//! Motion without supervision is not allowed: where the state is not known for `r3_lost_ms` the
//! motion thread ramps to rest and takes no commands until it is known again. A connection that
//! cannot be made again within `r3_reconnect_s` is a fault.

use std::io;
use std::net::SocketAddr;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::board::{Shared, Timed};
use crate::fault::Fault;
use crate::params::{ForceSource, Params, ms_ns, s_ns};
use crate::r3::{R3Client, explained};
use crate::system::monotonic_ns;
use crate::wrench::{Mounting, Wrench};

/// How often the thread looks whether there is something to do.
const LOOK: Duration = Duration::from_millis(5);

/// Between two attempts to connect, ns.
const RECONNECT_NS: u64 = 100_000_000;

/// A state that is wanted soon is not asked for more often than this, ns.
const SOON_NS: u64 = 20_000_000;

/// What the thread has.
struct Supervisor {
    controller: SocketAddr,
    params: Params,
    mounting: Mounting,
    board: Shared,
    client: Option<R3Client>,
    /// When the last question for the state was asked, and the next for force is due.
    asked_ns: u64,
    force_due_ns: u64,
    /// When the connection was lost, and when it was tried last.
    lost_ns: u64,
    tried_ns: u64,
}

/// Starts the thread; it hands the connection back when it is over.
///
/// # Errors
/// Where the system gives no thread.
pub fn spawn(
    client: R3Client,
    controller: SocketAddr,
    params: &Params,
    board: Shared,
    is_over: impl Fn() -> bool + Send + 'static,
) -> io::Result<JoinHandle<Option<R3Client>>> {
    let mut supervisor = Supervisor {
        controller,
        params: params.clone(),
        mounting: Mounting::new(params),
        board,
        client: Some(client),
        asked_ns: monotonic_ns(),
        force_due_ns: 0,
        lost_ns: 0,
        tried_ns: 0,
    };
    let thread = thread::Builder::new().name("melfa supervision".to_owned());
    thread.spawn(move || {
        while !is_over() {
            supervisor.look();
            thread::sleep(LOOK);
        }
        supervisor.client
    })
}

impl Supervisor {
    fn look(&mut self) {
        let now_ns = monotonic_ns();
        if self.client.is_none() {
            self.reconnect(now_ns);
            return;
        }
        let wanted = self.board.lock().state_wanted;
        let pause_ns = if wanted {
            SOON_NS
        } else {
            ms_ns(self.params.r3_poll_ms)
        };
        if now_ns - self.asked_ns >= pause_ns {
            self.asked_ns = now_ns;
            self.ask_state();
        }
        if self.params.force_source == ForceSource::R3 && now_ns >= self.force_due_ns {
            self.force_due_ns = now_ns + ms_ns(self.params.force_poll_ms);
            self.ask_force();
        }
    }

    fn ask_state(&mut self) {
        let Some(client) = &mut self.client else {
            return;
        };
        let asked_ns = monotonic_ns();
        match client.state() {
            Ok(state) => {
                let reason = explained(&state, |number| client.alarm_text(number));
                let mut board = self.board.lock();
                board.state_wanted = false;
                match reason {
                    None => board.permitted_ns = asked_ns,
                    Some(reason) => board.fail(Fault::safety(reason)),
                }
            }
            Err(error) => {
                crate::log::say("r3", &error.to_string());
                if error.is_fatal() {
                    self.client = None;
                    self.lost_ns = asked_ns;
                }
            }
        }
    }

    fn ask_force(&mut self) {
        let Some(client) = &mut self.client else {
            return;
        };
        match client.force() {
            Ok([fx, fy, fz, tx, ty, tz]) => {
                let raw = Wrench {
                    force: [fx, fy, fz].into(),
                    torque: [tx, ty, tz].into(),
                };
                self.board.lock().wrench = Some(Timed {
                    time_ns: monotonic_ns(),
                    value: self.mounting.at_tool(&raw),
                });
            }
            Err(error) => crate::log::say("r3 force", &error.to_string()),
        }
    }

    fn reconnect(&mut self, now_ns: u64) {
        if now_ns - self.lost_ns > s_ns(self.params.r3_reconnect_s) {
            let seconds = self.params.r3_reconnect_s;
            self.board.lock().fail(Fault::link(format!(
                "R3 could not be connected again within {seconds} s: the arm is not moved without supervision"
            )));
        }
        if now_ns - self.tried_ns < RECONNECT_NS {
            return;
        }
        self.tried_ns = now_ns;
        let timeout = Duration::from_secs_f64(self.params.r3_timeout_s);
        let Ok(mut client) = R3Client::connect(self.controller, self.params.r3_terminator, timeout)
        else {
            return;
        };
        if client.begin().is_ok() {
            crate::log::say("r3 again", "R3 is connected again");
            self.client = Some(client);
            self.asked_ns = 0;
        }
    }
}
