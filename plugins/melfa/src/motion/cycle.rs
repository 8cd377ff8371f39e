//! One cycle: take the replies, decide, send one request.

mod aim;

use pubs_melfa_protocol::mxt::Command;

use super::{Inputs, MotionSettings, Pace, Phase};
use crate::board::{Board, Order, Shared, Timed};
use crate::fault::Fault;
use crate::mxt::{MxtLink, Snapshot};
use crate::shaper::Shaper;
use crate::system::monotonic_ns;
use crate::twist::Motion;
use aim::Aim;

/// The arm is taken to stand so many filter times after its target does, and so many cycles more.
const SETTLING_FILTERS: f64 = 5.0;
const SETTLING_CYCLES: u32 = 10;

/// A filter shorter than this does not smooth, s.
const LEAST_FILTER_S: f64 = 1e-3;

/// The state of the motion thread.
pub(super) struct Cycle {
    settings: MotionSettings,
    link: MxtLink,
    board: Shared,
    pace: Pace,
    shaper: Shaper,
    phase: Phase,
    latest: Snapshot,
    aim: Option<Aim>,
    /// Whether the last request has been answered.
    answered: bool,
    lost_since_ns: u64,
    /// Cycles for which the target has stood.
    still: u32,
}

impl Cycle {
    pub(super) fn new(
        settings: MotionSettings,
        link: MxtLink,
        first: Snapshot,
        board: Shared,
    ) -> Self {
        let now_ns = monotonic_ns();
        {
            let mut board = board.lock();
            board.stats.step_limit_m = settings.speed.linear * settings.cycle_s;
            board.stats.joint_share_limit = settings.joint_guard.speed_fraction;
            board.alive_ns = now_ns;
        }
        Self {
            pace: Pace::new(settings.cycle_ns(), now_ns),
            shaper: Shaper::new(settings.cycle_s, settings.jerk),
            phase: Phase::Watching,
            latest: first,
            aim: None,
            answered: true,
            lost_since_ns: 0,
            still: 0,
            settings,
            link,
            board,
        }
    }

    /// One cycle; false when the session is over.
    pub(super) fn step(&mut self) -> bool {
        self.await_reply();
        let now_ns = monotonic_ns();
        let reply_ns = self.answered.then_some(self.latest.time_ns);
        let departure = self.pace.depart(now_ns, reply_ns, !self.phase.commands());
        self.lag_behind(departure.held_ns);

        let shared = self.board.clone();
        let mut board = shared.lock();
        if self.phase != Phase::Lost {
            board.stats.lateness.record(departure.late_ns);
            board.stats.misses += u64::from(!self.answered);
        }
        let wanted = self.decide(&mut board, now_ns, departure.held_ns);
        if self.phase.commands() {
            self.advance(&mut board, &wanted, now_ns);
        }
        self.publish(&mut board, now_ns);
        drop(board);
        self.send()
    }

    /// Waits for the reply to the last request and for the next one's due time.
    fn await_reply(&mut self) {
        loop {
            let until_ns = if self.answered {
                self.pace.due_ns()
            } else {
                self.pace.give_up_ns()
            };
            if self.link.wait(until_ns) {
                self.receive();
            }
            if monotonic_ns() >= until_ns {
                return;
            }
        }
    }

    fn receive(&mut self) {
        let found = self.link.drain();
        if let Some(snapshot) = found.newest {
            self.latest = snapshot;
            self.answered = true;
        }
        if found.fresh > 0 || found.ignored > 0 {
            let mut board = self.board.lock();
            board.stats.replies += found.fresh;
            board.stats.ignored += found.ignored;
        }
    }

    /// How long ago the newest reply came.
    fn silence_ns(&self, now_ns: u64) -> u64 {
        now_ns.saturating_sub(self.latest.time_ns)
    }

    /// A controller without a new target lets the arm come to rest on the last one, by its filter;
    /// to go on from less speed than that would be a jump.
    fn lag_behind(&mut self, held_ns: u64) {
        if held_ns >= self.settings.cycle_ns() {
            let filter_s = self.settings.filter_s.max(LEAST_FILTER_S);
            self.shaper
                .lag_behind((-(held_ns as f64) * 1e-9 / filter_s).exp());
        }
    }

    /// The phase of this cycle, and the velocity wanted in it.
    fn decide(&mut self, board: &mut Board, now_ns: u64, held_ns: u64) -> Motion {
        let before = self.phase;
        let silence_ns = self.silence_ns(now_ns);
        let silent = silence_ns > self.settings.silent_ns;
        // The controller may have stopped the arm.
        board.state_wanted |= silent && before != Phase::Lost;
        if before == Phase::Lost && now_ns - self.lost_since_ns > self.settings.relink_ns {
            let seconds = self.settings.relink_ns as f64 * 1e-9;
            board.fail(Fault::link(format!(
                "MXT has not answered for {seconds:.0} s: check cable, controller and program, then begin again"
            )));
        }
        let order = self.order(board, now_ns);
        let inputs = Inputs {
            ordered: order.is_some(),
            at_rest: self.shaper.is_at_rest(),
            settled: self.is_settled(),
            silent,
            lost: silence_ns.max(held_ns) > self.settings.lost_ns,
            relinked: self.latest.time_ns > self.lost_since_ns
                && board.permitted_ns > self.lost_since_ns,
            fault: board.fault.as_ref().map(|fault| fault.kind),
            closing: board.closing,
        };
        self.phase = before.next(&inputs);
        self.enter(board, before, now_ns);
        match order {
            Some(order) if self.phase == Phase::Following => self.allowed(board, &order.velocity),
            _ => Motion::default(),
        }
    }

    /// The engine's order, if it still holds and nothing forbids it; else it is forgotten, so that
    /// nothing begins to move without a new one.
    fn order(&self, board: &mut Board, now_ns: u64) -> Option<Order> {
        let forbidden = board.hold(now_ns).is_some()
            || board.closing
            || board.fault.is_some()
            || self.phase == Phase::Lost;
        if forbidden || board.order.is_some_and(|order| now_ns >= order.expires_ns) {
            board.order = None;
        }
        board.order
    }

    fn is_settled(&self) -> bool {
        let cycles = SETTLING_FILTERS * self.settings.filter_s / self.settings.cycle_s;
        self.still >= cycles as u32 + SETTLING_CYCLES
    }

    fn enter(&mut self, board: &mut Board, before: Phase, now_ns: u64) {
        if self.phase == before {
            return;
        }
        match self.phase {
            Phase::Lost => {
                crate::log::say("link", "the link to MXT is lost; it is tried again");
                self.lost_since_ns = now_ns;
                self.shaper.rest();
                self.aim = None;
                self.link.forget();
                board.order = None;
                board.state_wanted = true;
            }
            Phase::Watching => {
                self.aim = None;
                if before == Phase::Lost {
                    crate::log::say(
                        "link",
                        "the link to MXT is made again; the arm stays at rest",
                    );
                    board.stats.relinks += 1;
                }
            }
            Phase::Following if self.aim.is_none() => {
                self.aim = Some(Aim::at(&self.latest, &self.settings.frames));
            }
            _ => {}
        }
    }

    fn publish(&mut self, board: &mut Board, now_ns: u64) {
        board.alive_ns = now_ns;
        board.phase = self.phase;
        board.pose = Some(Timed {
            time_ns: self.latest.time_ns,
            value: self.settings.frames.to_engine(&self.latest.isometry()),
        });
        board.stats.sent += 1;
    }

    /// Sends this cycle's request; false when it was the last.
    fn send(&mut self) -> bool {
        let command = match self.phase {
            Phase::Watching | Phase::Lost => Command::Null,
            Phase::Following | Phase::Braking | Phase::Holding => Command::Move,
            Phase::Ended => Command::End,
        };
        let target = self.aim.as_ref().map(|aim| aim.sent);
        self.link
            .send(command, target.filter(|_| command == Command::Move));
        self.answered = false;
        self.phase != Phase::Ended
    }
}
