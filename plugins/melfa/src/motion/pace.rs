//! When the next request is due: one per control cycle, in step with the controller's replies.
//!
//! The next request is due one cycle after the one before was due. Where the reply to that one has
//! not come by then, it is waited for, up to the timeout, and the request goes out with it: so the
//! pace settles on the controller's own. A controller that answers at the end of its cycle, not at
//! once, is approached a little faster than its cycle, so that requests go out just after its
//! replies and have the whole cycle to arrive in. A thread that comes late begins a new row of due
//! times from where it is; what it did not send in time is not sent afterwards.

/// A reply that comes this share of a cycle after its request, or later, waited for the end of the
/// controller's cycle.
const WAITED: f64 = 0.3;

/// By this share of a cycle such a controller is approached.
const APPROACH: f64 = 0.02;

/// Due times.
#[derive(Debug, Clone)]
pub struct Pace {
    cycle_ns: u64,
    timeout_ns: u64,
    due_ns: u64,
    sent_ns: u64,
}

/// How a request went out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Departure {
    /// How late the thread was, ns, waiting for the reply not counted.
    pub late_ns: u64,
    /// For how long the controller has had no new target beyond one cycle, ns.
    pub held_ns: u64,
}

impl Pace {
    /// The first request is due at `now_ns`.
    pub fn new(cycle_ns: u64, timeout_cycles: f64, now_ns: u64) -> Self {
        Self {
            cycle_ns,
            timeout_ns: (timeout_cycles * cycle_ns as f64) as u64,
            due_ns: now_ns,
            sent_ns: now_ns.saturating_sub(cycle_ns),
        }
    }

    /// When the next request goes out with a reply to the last one.
    pub fn due_ns(&self) -> u64 {
        self.due_ns
    }

    /// When it goes out without one.
    pub fn give_up_ns(&self) -> u64 {
        self.due_ns.max(self.sent_ns + self.timeout_ns)
    }

    /// A request goes out at `now_ns`; `ready_ns` is when nothing was left to wait for.
    pub fn depart(&mut self, now_ns: u64, ready_ns: u64) -> Departure {
        let planned_ns = self.due_ns.max(ready_ns);
        let late_ns = now_ns.saturating_sub(planned_ns);
        let held_ns = now_ns.saturating_sub(self.sent_ns + self.cycle_ns);
        let behind = late_ns > self.cycle_ns || planned_ns > self.due_ns;
        let from_ns = if behind { now_ns } else { self.due_ns };
        let waited_ns = ready_ns.saturating_sub(self.sent_ns);
        let approach = if waited_ns as f64 > WAITED * self.cycle_ns as f64 {
            APPROACH
        } else {
            0.0
        };
        self.due_ns = from_ns + ((1.0 - approach) * self.cycle_ns as f64) as u64;
        self.sent_ns = now_ns;
        Departure { late_ns, held_ns }
    }

    /// When the last request went out.
    pub fn sent_ns(&self) -> u64 {
        self.sent_ns
    }

    /// A pause: the next request is due `after_ns` from now.
    pub fn pause(&mut self, now_ns: u64, after_ns: u64) {
        self.due_ns = now_ns + after_ns;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: u64 = 3_500_000;

    #[test]
    fn replies_in_time_leave_the_row_of_due_times_as_it_is() {
        let mut pace = Pace::new(CYCLE, 2.0, 1_000_000_000);
        for cycle in 0..1000 {
            let due = 1_000_000_000 + cycle * CYCLE;
            assert_eq!(pace.due_ns(), due, "cycle {cycle}");
            // Each 80 µs late, the reply long there: no drift.
            let found = pace.depart(due + 80_000, due - 3_200_000);
            assert_eq!(found.late_ns, 80_000);
            assert!(found.held_ns <= 80_000, "{found:?}");
        }
    }

    #[test]
    fn the_pace_settles_on_that_of_the_replies() {
        // The controller answers at its own boundaries, every 3.6 ms.
        let period = 3_600_000;
        let mut pace = Pace::new(CYCLE, 2.0, 0);
        let mut now = 0;
        let mut sent = Vec::new();
        for _ in 0..200 {
            let reply = (now / period + 1) * period;
            now = pace.due_ns().max(reply) + 20_000;
            sent.push(now);
            pace.depart(now, reply);
        }
        let mean = (sent[199] - sent[99]) / 100;
        assert!(
            mean.abs_diff(period) < 20_000,
            "mean {mean} ns between requests"
        );
    }

    #[test]
    fn requests_come_to_lie_just_after_the_replies() {
        // The controller answers at its boundaries; at first requests go out 2 ms after them.
        let mut pace = Pace::new(CYCLE, 2.0, 10 * CYCLE + 2_000_000);
        let (mut now, mut last) = (pace.due_ns(), 0);
        for _ in 0..100 {
            pace.depart(now, last);
            let reply = (now / CYCLE + 1) * CYCLE;
            now = pace.due_ns().max(reply) + 50_000;
            last = reply;
        }
        let after = now % CYCLE;
        assert!(
            after < 300_000,
            "requests go out {after} ns after the replies"
        );
    }

    #[test]
    fn after_a_stall_nothing_is_caught_up() {
        let mut pace = Pace::new(CYCLE, 2.0, 1_000_000_000);
        let stall = 1_000_000_000;
        let woken = 1_000_000_000 + stall;
        let found = pace.depart(woken, 0);
        assert_eq!(found.late_ns, stall);
        assert_eq!(
            found.held_ns, stall,
            "the controller has had no target since"
        );
        assert_eq!(pace.due_ns(), woken + CYCLE);
        assert_eq!(pace.give_up_ns(), woken + 2 * CYCLE);
    }
}
