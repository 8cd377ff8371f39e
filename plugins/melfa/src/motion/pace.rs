//! When the next request is due: one per control cycle, in step with the controller's replies.
//!
//! The next request is due one cycle after the one before was due. A controller that answers at
//! the end of its cycle, not at once, is approached a little faster than its cycle, so that requests
//! go out just after its replies and have the whole cycle to arrive in; which kind it is shows while
//! the arm is only watched, when a request more or less in one of its cycles does no harm. A reply
//! that has not come when the next request is due is waited for a little longer. A thread that comes
//! late begins a new row of due times from where it is; what it did not send in time is not sent
//! afterwards.

/// By this share of a cycle the end of the controller's cycle is approached.
const APPROACH: f64 = 0.02;

/// For this share of a cycle a reply is waited for beyond the due time.
const SLACK: f64 = 0.25;

/// A controller whose replies come this share of a cycle after the requests, in the mean, answers at
/// the end of its cycle.
const ANSWERS_AT_END: f64 = 0.5;

/// Weight of one reply in that mean.
const WEIGHT: f64 = 0.05;

/// Due times.
#[derive(Debug, Clone)]
pub struct Pace {
    cycle_ns: u64,
    due_ns: u64,
    sent_ns: u64,
    /// Mean time from request to reply, as a share of a cycle.
    mean_wait: f64,
    answered_before: bool,
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
    pub fn new(cycle_ns: u64, now_ns: u64) -> Self {
        Self {
            cycle_ns,
            due_ns: now_ns,
            sent_ns: now_ns.saturating_sub(cycle_ns),
            mean_wait: 0.0,
            answered_before: true,
        }
    }

    /// When the next request goes out with a reply to the last one.
    pub fn due_ns(&self) -> u64 {
        self.due_ns
    }

    /// When it goes out without one. Where the one before was not answered either, the row of due
    /// times is kept as it is.
    pub fn give_up_ns(&self) -> u64 {
        let slack = if self.answered_before { SLACK } else { 0.0 };
        self.due_ns + (slack * self.cycle_ns as f64) as u64
    }

    /// A request goes out at `now_ns`. `reply_ns` is when the last one was answered, if it was;
    /// `watched` says that the arm is not moved.
    pub fn depart(&mut self, now_ns: u64, reply_ns: Option<u64>, watched: bool) -> Departure {
        let planned_ns = match reply_ns {
            Some(reply_ns) => self.due_ns.max(reply_ns),
            None => self.give_up_ns(),
        };
        if let Some(reply_ns) = reply_ns {
            let wait = reply_ns.saturating_sub(self.sent_ns) as f64 / self.cycle_ns as f64;
            self.mean_wait += WEIGHT * (wait.min(1.0) - self.mean_wait);
        }
        let late_ns = now_ns.saturating_sub(planned_ns);
        let held_ns = now_ns.saturating_sub(self.sent_ns + self.cycle_ns);
        let behind = late_ns > self.cycle_ns || planned_ns > self.due_ns;
        let from_ns = if behind { now_ns } else { self.due_ns };
        let approaches = reply_ns.is_some() && (watched || self.mean_wait > ANSWERS_AT_END);
        let share = if approaches { 1.0 - APPROACH } else { 1.0 };
        self.due_ns = from_ns + (share * self.cycle_ns as f64) as u64;
        self.sent_ns = now_ns;
        self.answered_before = reply_ns.is_some();
        Departure { late_ns, held_ns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: u64 = 3_500_000;

    /// A controller that answers at the end of its own cycles of `period` ns; the driver wakes
    /// 50 µs late. Times at which requests go out: 100 while the arm is watched, `count` after.
    fn requests(first: u64, period: u64, count: usize) -> Vec<u64> {
        let mut pace = Pace::new(CYCLE, first);
        let (mut now, mut reply) = (first, None);
        let mut sent = Vec::new();
        for index in 0..100 + count {
            pace.depart(now, reply, index < 100);
            sent.push(now);
            let answer = (now / period + 1) * period;
            let comes = answer <= pace.give_up_ns();
            reply = comes.then_some(answer);
            now = if comes {
                pace.due_ns().max(answer)
            } else {
                pace.give_up_ns()
            } + 50_000;
        }
        sent.split_off(100)
    }

    #[test]
    fn a_controller_that_answers_at_once_is_asked_once_per_cycle() {
        let mut pace = Pace::new(CYCLE, 1_000_000_000);
        for cycle in 0..1000 {
            let due = 1_000_000_000 + cycle * CYCLE;
            assert_eq!(pace.due_ns(), due, "cycle {cycle}");
            // Each 80 µs late, the reply long there: no drift.
            let found = pace.depart(due + 80_000, Some(due.saturating_sub(3_300_000)), false);
            assert_eq!(found.late_ns, 80_000);
            assert!(found.held_ns <= 80_000, "{found:?}");
        }
    }

    #[test]
    fn requests_come_to_lie_just_after_replies_at_the_end_of_a_cycle() {
        for first in [0, 1_000_000, 2_000_000, 3_000_000, 3_400_000] {
            for period in [CYCLE - 2_000, CYCLE, CYCLE + 2_000] {
                let sent = requests(10 * CYCLE + first, period, 500);
                let after = sent.iter().map(|now| now % period).max().unwrap_or(0);
                assert!(
                    after < 300_000,
                    "first {first}, period {period}: up to {after} ns after the reply"
                );
                let cycles: Vec<u64> = sent.iter().map(|now| now / period).collect();
                let once = cycles.windows(2).all(|pair| pair[1] == pair[0] + 1);
                assert!(
                    once,
                    "first {first}, period {period}: not one request in each cycle"
                );
            }
        }
    }

    #[test]
    fn without_replies_the_row_of_due_times_goes_on() {
        let mut pace = Pace::new(CYCLE, 1_000_000_000);
        let mut sent = Vec::new();
        for _ in 0..20 {
            let now = pace.give_up_ns();
            pace.depart(now, None, false);
            sent.push(now);
        }
        let even = sent
            .windows(2)
            .skip(1)
            .all(|pair| pair[1] - pair[0] == CYCLE);
        assert!(even, "{sent:?}");
    }

    #[test]
    fn after_a_stall_nothing_is_caught_up() {
        let mut pace = Pace::new(CYCLE, 1_000_000_000);
        let stall = 1_000_000_000;
        let woken = 1_000_000_000 + stall;
        let found = pace.depart(woken, Some(1_000_000), false);
        assert_eq!(found.late_ns, stall);
        assert_eq!(
            found.held_ns, stall,
            "the controller has had no target since"
        );
        assert_eq!(pace.due_ns(), woken + CYCLE);
    }
}
