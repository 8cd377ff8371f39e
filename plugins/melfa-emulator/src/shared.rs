//! What the threads share.

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::machine::Machine;

/// The machine, and whether to end.
#[derive(Debug)]
pub struct Shared {
    machine: Mutex<Machine>,
    /// The threads end when this is set.
    pub ended: AtomicBool,
}

impl Shared {
    /// Running.
    pub fn new(machine: Machine) -> Self {
        Self {
            machine: Mutex::new(machine),
            ended: AtomicBool::new(false),
        }
    }

    /// The machine, for as short a time as can be. A thread that panicked has left it as it was.
    pub fn machine(&self) -> MutexGuard<'_, Machine> {
        self.machine.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
