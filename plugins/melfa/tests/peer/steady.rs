//! Tests of what happens in milliseconds, on a machine that may be busy with something else.

use std::panic::{catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The longest stall since a test began.
static STALL_US: AtomicU64 = AtomicU64::new(0);

/// A machine that stalls for so long proves nothing about the driver.
const STALLED_US: u64 = 10_000;

/// And is given so many chances.
const ATTEMPTS: u32 = 5;

/// A thread of a controller came so much too late.
pub fn note_stall(stall: Duration) {
    STALL_US.fetch_max(stall.as_micros() as u64, Ordering::Relaxed);
}

/// Carries out a test; again where it failed while the machine stalled.
pub fn steadily(name: &str, test: impl Fn() + std::panic::RefUnwindSafe) {
    for attempt in 1..=ATTEMPTS {
        STALL_US.store(0, Ordering::Relaxed);
        let result = catch_unwind(&test);
        let stall_us = STALL_US.load(Ordering::Relaxed);
        match result {
            Ok(()) => return,
            Err(_) if stall_us > STALLED_US && attempt < ATTEMPTS => {
                println!("{name}: again, since the machine stalled for {stall_us} µs");
            }
            Err(failure) => resume_unwind(failure),
        }
    }
}
