//! An open session: the three threads, and how they are ended.

use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use pubs_plugin::{DriverSetup, PluginError};

use crate::board::{Patience, Shared};
use crate::motion::{MotionSettings, MotionThread};
use crate::params::{ForceSource, Params, ms_ns};
use crate::prepare::Ready;
use crate::r3::R3Client;
use crate::system::monotonic_ns;
use crate::{log, monitor, supervision};

/// The motion thread has so long to come to rest and end, and so many times the filter's time on top.
const END_TIME: Duration = Duration::from_secs(2);
const END_FILTERS: f64 = 10.0;

/// Between two looks whether it has.
const LOOK: Duration = Duration::from_millis(2);

/// Threads that end with it.
#[derive(Debug)]
pub struct Session {
    board: Shared,
    params: Params,
    motion: Option<MotionThread>,
    force: Option<JoinHandle<()>>,
    supervision: Option<JoinHandle<Option<R3Client>>>,
}

impl Session {
    /// Starts the threads. Nothing moves until the board has an order.
    ///
    /// # Errors
    /// Where the system gives no threads.
    pub fn start(
        ready: Ready,
        params: &Params,
        setup: &DriverSetup,
        board: Shared,
    ) -> Result<Self, PluginError> {
        // The writer is there before anybody is in a hurry.
        log::flush();
        let failed = |error: std::io::Error| PluginError::new(format!("no thread: {error}"));
        {
            let mut board = board.lock();
            board.permitted_ns = monotonic_ns();
            board.patience = Patience {
                force_ns: match params.force_source {
                    ForceSource::None => None,
                    _ => Some(ms_ns(params.force_stale_ms)),
                },
                permit_ns: ms_ns(params.r3_lost_ms),
            };
        }
        let mut session = Self {
            board: board.clone(),
            params: params.clone(),
            motion: None,
            force: None,
            supervision: None,
        };
        let closing = |board: Shared| move || board.lock().closing;
        let settings = MotionSettings::new(params, setup);
        session.motion = Some(
            MotionThread::spawn(settings, ready.mxt, ready.first, board.clone()).map_err(failed)?,
        );
        let supervised = supervision::spawn(
            ready.r3,
            ready.addresses.r3,
            params,
            board.clone(),
            closing(board.clone()),
        );
        session.supervision = Some(supervised.map_err(failed)?);
        if let Some(link) = ready.monitor {
            let thread = monitor::spawn(link, params, board.clone(), closing(board));
            session.force = Some(thread.map_err(failed)?);
        }
        Ok(session)
    }

    fn end_motion(&mut self) {
        let filter = Duration::from_secs_f64(END_FILTERS * self.params.filter_ms * 1e-3);
        let deadline = Instant::now() + END_TIME + filter;
        let Some(motion) = self.motion.take() else {
            return;
        };
        while !motion.is_finished() && Instant::now() < deadline {
            thread::sleep(LOOK);
        }
        if !motion.is_finished() {
            log::say(
                "close",
                "the motion thread hangs; the controller holds the last target",
            );
        }
    }

    /// Stops the program and switches the servo off, as the parameters say.
    fn end_controller(&mut self) {
        let client = self
            .supervision
            .take()
            .and_then(|thread| thread.join().ok());
        let Some(mut client) = client.flatten() else {
            return;
        };
        let stopped = if self.params.stop_program {
            client.stop()
        } else {
            Ok(())
        };
        let off = if self.params.servo_off {
            client
                .operation_right(true)
                .and_then(|()| client.servo(false))
                .and_then(|()| client.operation_right(false))
        } else {
            Ok(())
        };
        for error in [stopped, off].into_iter().filter_map(Result::err) {
            log::say("close", &format!("at the close: {error}"));
        }
        client.end();
    }
}

impl Drop for Session {
    /// Ramps to rest, ends MXT, then the rest.
    fn drop(&mut self) {
        {
            let mut board = self.board.lock();
            board.closing = true;
            board.order = None;
        }
        self.end_motion();
        if let Some(force) = self.force.take() {
            // It catches nothing and holds nothing; how it ended changes nothing.
            let _ = force.join();
        }
        self.end_controller();
        if self.params.log {
            log::say("figures", &self.board.lock().stats.to_string());
        }
        log::flush();
    }
}
