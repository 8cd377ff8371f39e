//! What the threads tell each other: the engine's calls, motion, force and supervision.
//!
//! One lock, held for a few assignments at a time, and not by a thread that waits for anything.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nalgebra::Isometry3;
use pubs_melfa_protocol::Pose;

use crate::fault::Fault;
use crate::motion::Phase;
use crate::stats::Stats;
use crate::twist::Motion;
use crate::wrench::Wrench;

/// A value and when it arrived, monotonic clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed<T> {
    /// ns.
    pub time_ns: u64,
    /// The value.
    pub value: T,
}

/// A velocity and when it runs out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// Of the tool, engine's base.
    pub velocity: Motion,
    /// ns.
    pub expires_ns: u64,
}

/// The command that the controller has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Commanded {
    /// As it tells it.
    pub pose: Pose,
    /// When it told it last, ns.
    pub time_ns: u64,
    /// Since when it has been the same, ns.
    pub since_ns: u64,
}

/// How old things may be while the arm moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Patience {
    /// The wrench, ns; `None` where no force is read.
    pub force_ns: Option<u64>,
    /// The controller's word that it may move, ns.
    pub permit_ns: u64,
}

/// The present state of everything.
#[derive(Debug, Default)]
pub struct Board {
    /// What the engine wants; `None` after a stop.
    pub order: Option<Order>,
    /// The driver is being closed.
    pub closing: bool,
    /// Where the motion thread is.
    pub phase: Phase,
    /// Why the arm was brought to rest for good; the first reason stays.
    pub fault: Option<Fault>,
    /// How old what keeps the arm permitted to move may be.
    pub patience: Patience,
    /// The newest pose of the tool, engine's base.
    pub pose: Option<Timed<Isometry3<f64>>>,
    /// The newest wrench, tool axes, not tared.
    pub wrench: Option<Timed<Wrench>>,
    /// The command that the controller has, as the monitor tells it.
    pub commanded: Option<Commanded>,
    /// When the motion thread last came round, ns.
    pub alive_ns: u64,
    /// When the controller last said that it may move, ns.
    pub permitted_ns: u64,
    /// Somebody wants to know the controller's state soon.
    pub state_wanted: bool,
    /// Figures.
    pub stats: Stats,
}

impl Board {
    /// Why the arm must be kept at rest for now.
    pub fn hold(&self, now_ns: u64) -> Option<&'static str> {
        let age_ns = |time_ns: u64| now_ns.saturating_sub(time_ns);
        let force_ns = age_ns(self.wrench.map_or(0, |wrench| wrench.time_ns));
        if self
            .patience
            .force_ns
            .is_some_and(|most_ns| force_ns > most_ns)
        {
            return Some("no force reading for too long: is the monitor stream alive?");
        }
        if age_ns(self.permitted_ns) > self.patience.permit_ns {
            return Some("the controller's state is not known: R3 does not answer");
        }
        None
    }

    /// Takes in what the monitor tells of the command.
    pub fn hear_command(&mut self, heard: Timed<Pose>) {
        let same = self.commanded.filter(|before| before.pose == heard.value);
        self.commanded = Some(Commanded {
            pose: heard.value,
            time_ns: heard.time_ns,
            since_ns: same.map_or(heard.time_ns, |before| before.since_ns),
        });
    }

    /// Sets the fault, unless there is one.
    pub fn fail(&mut self, fault: Fault) {
        if self.fault.is_none() {
            crate::log::say("fault", &fault.reason);
            self.fault = Some(fault);
            self.order = None;
        }
    }
}

/// The board, shared.
#[derive(Debug, Clone, Default)]
pub struct Shared(Arc<Mutex<Board>>);

impl Shared {
    /// Takes the lock. A thread that broke down while it had it left whole values behind.
    pub fn lock(&self) -> MutexGuard<'_, Board> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
