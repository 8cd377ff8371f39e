//! What the system must be asked for directly: its monotonic clock, waiting with the precision of
//! that clock, and timely scheduling. The standard library tells no time that another part of the
//! process could compare with, and its socket timeouts are as coarse as the kernel's tick.

use std::net::UdpSocket;
use std::os::fd::AsRawFd;

const SECOND_NS: u64 = 1_000_000_000;

/// Nanoseconds of CLOCK_MONOTONIC.
pub fn monotonic_ns() -> u64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the pointer is to a timespec that lives through the call; the clock exists on every
    // system this builds for, so the call cannot fail.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    time.tv_sec as u64 * SECOND_NS + time.tv_nsec as u64
}

/// Waits until a packet lies in the socket, or the clock has reached `until_ns`. Whether one does.
pub fn wait_readable(socket: &UdpSocket, until_ns: u64) -> bool {
    let left_ns = until_ns.saturating_sub(monotonic_ns());
    let timeout = libc::timespec {
        tv_sec: (left_ns / SECOND_NS) as libc::time_t,
        tv_nsec: (left_ns % SECOND_NS) as libc::c_long,
    };
    let mut watched = libc::pollfd {
        fd: socket.as_raw_fd(),
        events: libc::POLLIN,
        revents: 0,
    };
    // SAFETY: both pointers are to values that live through the call, and there is one pollfd; the
    // descriptor is open, since the socket is borrowed; a null mask leaves the signals as they are.
    let ready = unsafe { libc::ppoll(&raw mut watched, 1, &raw const timeout, std::ptr::null()) };
    ready > 0
}

/// Sleeps until the clock has reached `until_ns`.
pub fn sleep_until(until_ns: u64) {
    while let left_ns @ 1.. = until_ns.saturating_sub(monotonic_ns()) {
        std::thread::sleep(std::time::Duration::from_nanos(left_ns));
    }
}

/// Asks for timely waking of the calling thread: real-time scheduling where that is permitted, and
/// the least timer slack in any case. Whether real-time scheduling was granted.
pub fn make_timely() -> bool {
    // Above the engine's loops (40), since the arm's cycle is shorter; below the kernel's threads.
    let parameters = libc::sched_param { sched_priority: 45 };
    // SAFETY: plain system calls on the calling thread; the pointer is valid for the call.
    unsafe {
        libc::prctl(libc::PR_SET_TIMERSLACK, 1_u64);
        libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) == 0
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn waiting_ends_with_a_packet_or_at_its_time() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let until_ns = monotonic_ns() + 3_000_000;
        assert!(!wait_readable(&socket, until_ns), "nothing was sent");
        assert!(monotonic_ns() >= until_ns, "came back before its time");
        socket.send_to(b"x", socket.local_addr().unwrap()).unwrap();
        assert!(wait_readable(&socket, monotonic_ns() + 5 * SECOND_NS));
        assert!(monotonic_ns() < until_ns + 2 * SECOND_NS, "waited on");
    }
}
