//! The host's monotonic clock, and sleeping until a moment of it.

/// Nanoseconds in a second.
pub const SECOND_NS: u64 = 1_000_000_000;

/// How long before a deadline the sleep ends and spinning begins: the kernel wakes a sleeper some
/// 100 µs late, and a loop of 10 ms can spare that much of a core.
const SPIN_NS: u64 = 150_000;

/// Nanoseconds of the monotonic clock.
pub fn now_ns() -> u64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the pointer is to a valid timespec that outlives the call.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    time.tv_sec as u64 * SECOND_NS + time.tv_nsec as u64
}

/// Sleeps until `deadline_ns`, by an absolute sleep and a short spin: no drift, however long the
/// loop's own work takes.
pub fn sleep_until(deadline_ns: u64) {
    let wake_ns = deadline_ns.saturating_sub(SPIN_NS);
    if now_ns() < wake_ns {
        let wake = libc::timespec {
            tv_sec: (wake_ns / SECOND_NS) as libc::time_t,
            tv_nsec: (wake_ns % SECOND_NS) as libc::c_long,
        };
        loop {
            // SAFETY: both pointers are valid or null as clock_nanosleep allows.
            let result = unsafe {
                libc::clock_nanosleep(
                    libc::CLOCK_MONOTONIC,
                    libc::TIMER_ABSTIME,
                    &raw const wake,
                    std::ptr::null_mut(),
                )
            };
            if result != libc::EINTR {
                break;
            }
        }
    }
    while now_ns() < deadline_ns {
        std::hint::spin_loop();
    }
}

/// Asks the kernel for timely waking of the calling thread: real-time scheduling where that is
/// permitted, and the least timer slack in any case. Whether real-time scheduling was granted.
pub fn make_timely() -> bool {
    // Below the kernel's own threads (50 and up), above everything else.
    let parameters = libc::sched_param { sched_priority: 40 };
    // SAFETY: plain system calls on the calling thread; the pointer is valid for the call.
    unsafe {
        libc::prctl(libc::PR_SET_TIMERSLACK, 1_u64);
        libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) == 0
    }
}

/// Tick number `tick` of a loop at `rate_hz` that began at `start_ns`.
pub fn tick_ns(start_ns: u64, tick: u64, rate_hz: f64) -> u64 {
    start_ns + (tick as f64 * SECOND_NS as f64 / rate_hz).round() as u64
}
