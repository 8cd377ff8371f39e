//! What the arm does while it is recorded.
//!
//! A cycle gives one demonstration of each movement action, in two round trips from the closed
//! limit: out and back in safe mode; then out and back in high-force mode, each stroke ended in
//! safe mode. A high-force stroke stops where one more policy step of it would leave the limits
//! (§III-A.5), so its last stretch is left out.
//!
//! Where safe mode is blocked at the closed limit, the object is locked: that pull is kept as it
//! is, high force breaks the lock, and safe mode is recorded again from just beyond it.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::mpsc::Sender;

use pubs_core::controller::Control;
use pubs_core::{Joint, Task};
use pubs_run::recording::Done;
use pubs_run::{Chooser, Order, Sample, Verdict};

use super::moves::Moves;
use crate::contact::rest_displacement;

/// Between two strokes the arm rests for so long, s.
const REST_S: f64 = 0.3;

/// A stroke has met something when the tool stands still for so long, s. As many readings of the
/// pressing force are kept.
const HOLD_S: f64 = 0.5;

/// Standing still means to move less than this, m.
const STILL_M: f64 = 0.001;

/// A stroke may take this many times what its way needs at its speed, and so many seconds more.
const PATIENCE: (f64, f64) = (2.0, 5.0);

/// A limit is met within this share of the range, and so much way more.
const LIMIT_SHARE: f64 = 0.02;
/// See [`LIMIT_SHARE`].
const LIMIT_SLACK_M: f64 = 0.01;

/// Beyond the lock the force stays below this share of the threshold.
const FREE_SHARE: f64 = 0.8;

/// The lock is left by so much way more each time that safe mode is still caught, m.
const FURTHER_M: f64 = 0.005;

/// So many times at most.
const ATTEMPTS: u32 = 8;

/// Where the lock may be, as a share of the range from the closed limit.
const LOCK_SHARE: f64 = 0.3;

/// What to show of a recording under way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RecordStatus {
    /// Since the start, s.
    pub time_s: f64,
    /// Which demonstration of each action, from 1; 0: on the way to the limit.
    pub demonstration: u32,
    /// Index of the action.
    pub action: usize,
    /// The joint state, once a limit was touched (rad or m).
    pub state: Option<f64>,
    /// Demonstrations done so far.
    pub done: usize,
}

/// The strokes of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stroke {
    /// Safe, to the closed limit, for the zero.
    Approach,
    /// Safe, from the closed limit.
    Open,
    /// High force, out of the lock.
    Break,
    /// Safe, on to the open limit.
    BreakOn,
    /// Safe, back to just beyond the lock.
    Return,
    /// Safe, from beyond the lock to the open limit.
    OpenBeyond,
    /// Safe, to the closed limit.
    Close,
    /// High force, from the closed limit.
    ForceOpen,
    /// Safe, on to the open limit.
    ForceOpenOn,
    /// High force, from the open limit.
    ForceClose,
    /// Safe, on to the closed limit.
    ForceCloseOn,
}

/// What ends a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Until {
    Contact,
    State(f64),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Moving { since_ns: u64 },
    Resting { since_ns: u64 },
    Over,
}

/// See the head of this file.
pub(super) struct Demonstrator {
    joint: Joint,
    control: Control,
    moves: Moves,
    stop: usize,
    names: Vec<String>,
    high_step: f64,
    wanted: u32,
    done: Vec<Done>,
    known: HashSet<(usize, u32)>,
    events: Sender<Done>,
    cycle: u32,
    stroke: Stroke,
    phase: Phase,
    began_ns: Option<u64>,
    /// Displacement at the closed limit, nothing pressing.
    zero: Option<f64>,
    /// State just beyond the lock.
    beyond: Option<f64>,
    attempts: u32,
    /// (displacement, force along the motion) of this stroke.
    approach: Vec<(f64, f64)>,
    still: (u64, f64),
    last: Sample,
}

impl Demonstrator {
    pub fn new(
        task: &Arc<Task>,
        control: Control,
        moves: Moves,
        wanted: u32,
        done: Vec<Done>,
        events: Sender<Done>,
    ) -> Self {
        let index = |name: &str| task.actions.iter().position(|action| action.name == name);
        let known = done
            .iter()
            .filter_map(|done| Some((index(&done.action)?, done.demonstration)))
            .collect();
        Self {
            joint: task.joint.clone(),
            control,
            moves,
            stop: task.stop,
            names: task
                .actions
                .iter()
                .map(|action| action.name.clone())
                .collect(),
            high_step: task.actions[moves.high_open].displacement(),
            wanted,
            done,
            known,
            events,
            cycle: 0,
            stroke: Stroke::Approach,
            phase: Phase::Resting { since_ns: 0 },
            began_ns: None,
            zero: None,
            beyond: None,
            attempts: 0,
            approach: Vec::new(),
            still: (0, 0.0),
            last: Sample::default(),
        }
    }

    pub fn into_done(self) -> Vec<Done> {
        self.done
    }

    fn action(&self) -> usize {
        match self.stroke {
            Stroke::Approach | Stroke::Return | Stroke::Close | Stroke::ForceCloseOn => {
                self.moves.safe_close
            }
            Stroke::Open | Stroke::BreakOn | Stroke::OpenBeyond | Stroke::ForceOpenOn => {
                self.moves.safe_open
            }
            Stroke::Break | Stroke::ForceOpen => self.moves.high_open,
            Stroke::ForceClose => self.moves.high_close,
        }
    }

    fn sign(&self) -> f64 {
        let opens = [self.moves.safe_open, self.moves.high_open];
        if opens.contains(&self.action()) {
            1.0
        } else {
            -1.0
        }
    }

    fn until(&self) -> Until {
        match self.stroke {
            Stroke::Break | Stroke::ForceOpen => Until::State(self.joint.upper - self.high_step),
            Stroke::ForceClose => Until::State(self.joint.lower + self.high_step),
            Stroke::Return => Until::State(self.beyond.unwrap_or(self.joint.lower)),
            _ => Until::Contact,
        }
    }

    /// The joint state by the tool's way from the closed limit.
    fn state(&self, displacement: f64) -> Option<f64> {
        Some(self.joint.lower + displacement - self.zero?)
    }

    fn tolerance(&self) -> f64 {
        let give_m = self.control.force_threshold_n / self.control.contact_stiffness_n_per_m;
        LIMIT_SHARE * self.joint.range() + (2.0 * give_m + LIMIT_SLACK_M) * self.joint.per_metre()
    }

    fn choose(&mut self, now_ns: u64, sample: &Sample) -> Result<Verdict, String> {
        match self.phase {
            Phase::Over => Ok(Verdict::Done),
            Phase::Resting { since_ns } => {
                if seconds(since_ns, now_ns) >= REST_S && sample.speed_m_s == 0.0 {
                    self.begin(now_ns, sample);
                }
                Ok(Verdict::Going)
            }
            Phase::Moving { since_ns } => self.follow(now_ns, since_ns, sample),
        }
    }

    fn begin(&mut self, now_ns: u64, sample: &Sample) {
        self.approach.clear();
        self.still = (now_ns, sample.displacement);
        self.phase = Phase::Moving { since_ns: now_ns };
    }

    fn follow(&mut self, now_ns: u64, since_ns: u64, sample: &Sample) -> Result<Verdict, String> {
        if sample.action != self.action() {
            // The order has not arrived yet.
            return Ok(Verdict::Going);
        }
        self.approach
            .push((sample.displacement, sample.forces_n[0]));
        if let (Until::State(goal), Some(state)) = (self.until(), self.state(sample.displacement))
            && (state - goal) * self.sign() >= 0.0
        {
            return self.rest(now_ns, |stroke| stroke.reached());
        }
        let still_way = STILL_M * self.joint.per_metre();
        if (sample.displacement - self.still.1).abs() > still_way {
            self.still = (now_ns, sample.displacement);
        }
        if seconds(self.still.0, now_ns) >= HOLD_S {
            return self.rest(now_ns, |stroke| stroke.met());
        }
        self.check_patience(seconds(since_ns, now_ns))?;
        Ok(Verdict::Going)
    }

    fn rest(
        &mut self,
        now_ns: u64,
        end: impl FnOnce(&mut Self) -> Result<Option<Stroke>, String>,
    ) -> Result<Verdict, String> {
        let next = end(self)?;
        self.phase = match next {
            Some(stroke) => {
                self.stroke = stroke;
                Phase::Resting { since_ns: now_ns }
            }
            None => Phase::Over,
        };
        Ok(Verdict::Going)
    }

    fn check_patience(&self, seconds: f64) -> Result<(), String> {
        let speed =
            if self.action() == self.moves.high_open || self.action() == self.moves.high_close {
                self.control.high_speed_m_s
            } else {
                self.control.safe_speed_m_s
            };
        let way_m = self.joint.range() / self.joint.per_metre();
        let allowed = PATIENCE.0 * way_m / speed + PATIENCE.1;
        if seconds <= allowed {
            return Ok(());
        }
        Err(format!(
            "`{}` has gone on for {seconds:.0} s and met no limit, although the whole range takes {:.0} s; \
             is the handle still in the grasp, and are the limits right?",
            self.names[self.action()],
            way_m / speed
        ))
    }

    /// The stroke came to where it should end.
    fn reached(&mut self) -> Result<Option<Stroke>, String> {
        match self.stroke {
            Stroke::Break => {
                self.finish(self.moves.high_open);
                self.find_beyond();
                Ok(Some(Stroke::BreakOn))
            }
            Stroke::Return => Ok(Some(Stroke::OpenBeyond)),
            Stroke::ForceOpen => {
                self.finish(self.moves.high_open);
                Ok(Some(Stroke::ForceOpenOn))
            }
            Stroke::ForceClose => {
                self.finish(self.moves.high_close);
                Ok(Some(Stroke::ForceCloseOn))
            }
            _ => self.unexpected(),
        }
    }

    /// The stroke met something that holds it.
    fn met(&mut self) -> Result<Option<Stroke>, String> {
        let (_, force) = self.last_reading();
        if force < 0.5 * self.control.force_threshold_n {
            return Err(format!(
                "the arm stands still during `{}` although only {force:.1} N hold it (safe mode stops above {:.1} N); \
                 does the driver follow its commands?",
                self.names[self.action()],
                self.control.force_threshold_n
            ));
        }
        if self.stroke == Stroke::Approach {
            return Ok(self.touch());
        }
        let (closed, open) = (self.is_at(self.joint.lower), self.is_at(self.joint.upper));
        match self.stroke {
            Stroke::Open if open => {
                self.finish(self.moves.safe_open);
                Ok(Some(Stroke::Close))
            }
            Stroke::Open if closed => Ok(Some(Stroke::Break)),
            Stroke::BreakOn if open => Ok(Some(Stroke::Return)),
            Stroke::OpenBeyond if open => {
                self.finish(self.moves.safe_open);
                Ok(Some(Stroke::Close))
            }
            Stroke::OpenBeyond if self.attempts < ATTEMPTS => {
                self.attempts += 1;
                let further = FURTHER_M * self.joint.per_metre();
                self.beyond = self.beyond.map(|beyond| beyond + further);
                Ok(Some(Stroke::Break))
            }
            Stroke::Close if closed => {
                self.finish(self.moves.safe_close);
                Ok(self.second_trip())
            }
            Stroke::ForceOpenOn if open => Ok(Some(Stroke::ForceClose)),
            Stroke::ForceCloseOn if closed => Ok(self.next_cycle()),
            _ => self.unexpected(),
        }
    }

    /// The first touch of the closed limit gives the zero.
    fn touch(&mut self) -> Option<Stroke> {
        let stiffness_n = self.control.contact_stiffness_n_per_m / self.joint.per_metre();
        self.zero = rest_displacement(
            &self.approach,
            self.sign(),
            self.control.force_threshold_n,
            stiffness_n,
        )
        .or(Some(self.last_reading().0));
        self.next_cycle()
    }

    fn next_cycle(&mut self) -> Option<Stroke> {
        let missing = |cycle: &u32| {
            let all = [
                self.moves.safe_open,
                self.moves.safe_close,
                self.moves.high_open,
                self.moves.high_close,
            ];
            all.iter().any(|&action| !self.has(action, *cycle))
        };
        self.cycle = (self.cycle + 1..=self.wanted).find(missing)?;
        let first_trip = [self.moves.safe_open, self.moves.safe_close];
        if first_trip
            .iter()
            .all(|&action| self.has(action, self.cycle))
        {
            return Some(Stroke::ForceOpen);
        }
        Some(Stroke::Open)
    }

    fn second_trip(&mut self) -> Option<Stroke> {
        let second_trip = [self.moves.high_open, self.moves.high_close];
        if second_trip
            .iter()
            .all(|&action| self.has(action, self.cycle))
        {
            return self.next_cycle();
        }
        Some(Stroke::ForceOpen)
    }

    fn has(&self, action: usize, cycle: u32) -> bool {
        self.known.contains(&(action, cycle))
    }

    fn finish(&mut self, action: usize) {
        if !self.known.insert((action, self.cycle)) {
            return;
        }
        let done = Done {
            action: self.names[action].clone(),
            demonstration: self.cycle,
        };
        // Nobody hears where the controller is gone; the report has it all the same.
        let _ = self.events.send(done.clone());
        self.done.push(done);
    }

    /// Where the force of the stroke that broke the lock has fallen for good.
    fn find_beyond(&mut self) {
        if self.beyond.is_some() {
            return;
        }
        let zone = self.joint.lower + LOCK_SHARE * self.joint.range();
        let free_n = FREE_SHARE * self.control.force_threshold_n;
        let caught = self
            .approach
            .iter()
            .rev()
            .find_map(|&(displacement, force)| {
                let state = self.state(displacement)?;
                (state < zone && force > free_n).then_some(state)
            });
        let lock_end = caught.unwrap_or(self.joint.lower);
        self.beyond = Some(lock_end + FURTHER_M * self.joint.per_metre());
    }

    fn last_reading(&self) -> (f64, f64) {
        (self.last.displacement, self.last.forces_n[0])
    }

    fn is_at(&self, limit: f64) -> bool {
        let state = self.state(self.last.displacement);
        state.is_some_and(|state| (state - limit).abs() <= self.tolerance())
    }

    fn unexpected(&self) -> Result<Option<Stroke>, String> {
        let show = |state: f64| self.joint.display(state);
        let at = self
            .state(self.last.displacement)
            .map_or_else(|| "an unknown state".to_owned(), show);
        Err(format!(
            "`{}` met {:.1} N at {at}, but the limits are {} and {}; \
             are limits and radius right, or does something jam the object?",
            self.names[self.action()],
            self.last.forces_n[0],
            show(self.joint.lower),
            show(self.joint.upper)
        ))
    }
}

impl Chooser for Demonstrator {
    type Message = Sample;
    type Status = RecordStatus;

    fn step(&mut self, now_ns: u64, sample: &Sample) -> Result<(Order, Verdict), String> {
        self.began_ns.get_or_insert(now_ns);
        let verdict = if sample.valid {
            self.last = *sample;
            self.choose(now_ns, sample)?
        } else {
            Verdict::Going
        };
        let action = match self.phase {
            Phase::Moving { .. } => self.action(),
            Phase::Resting { .. } | Phase::Over => self.stop,
        };
        let order = Order {
            time_ns: now_ns,
            action,
            demonstration: self.cycle,
            valid: true,
        };
        Ok((order, verdict))
    }

    fn status(&self, now_ns: u64) -> RecordStatus {
        RecordStatus {
            time_s: self
                .began_ns
                .map_or(0.0, |began_ns| seconds(began_ns, now_ns)),
            demonstration: self.cycle,
            action: self.action(),
            state: self.state(self.last.displacement),
            done: self.done.len(),
        }
    }
}

fn seconds(from_ns: u64, to_ns: u64) -> f64 {
    to_ns.saturating_sub(from_ns) as f64 * 1e-9
}
