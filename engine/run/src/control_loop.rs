//! The controller loop: reads the driver, commands a velocity, eq. (12) and (13).

use std::sync::Arc;

use pubs_core::Task;
use pubs_core::controller::Control;
use pubs_plugin::Reading;

use crate::grip::GripWatch;
use crate::guard::{COMMAND_PERIODS, Guard, Trip};
use crate::loops::{Felt, Period, Rates, Tap};
use crate::messages::{Order, Sample, Signals};
use crate::motion::Motion;
use crate::recording::Frame;

/// The slower loops may be silent for so many of their periods.
const SILENT_PERIODS: f64 = 5.0;

/// State of the loop between two ticks.
pub struct ControlLoop {
    control: Control,
    guard: Guard,
    signals: Signals,
    slower: [Slower; 2],
    tap: Option<Tap>,
    grip: Option<GripWatch>,
    motion: Motion,
    /// Ticks so far.
    ticks: u64,
    /// Whether the tap knows why the guard stopped the arm.
    told: bool,
    last_step_ns: Option<u64>,
    first_step_ns: u64,
}

/// A slower loop, whose signs of life are watched.
#[derive(Debug, Clone, Copy)]
struct Slower {
    name: &'static str,
    rate_hz: f64,
}

/// Where a tick left the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tick {
    /// Go on.
    Going,
    /// The arm rests and the loop is done.
    AtRest,
}

impl ControlLoop {
    /// A loop around a guarded arm; `tap` gets every control period.
    pub fn new(
        task: Arc<Task>,
        control: Control,
        guard: Guard,
        signals: Signals,
        rates: &Rates,
        tap: Option<Tap>,
    ) -> Self {
        let [follower, chooser] = rates.names;
        Self {
            motion: Motion::new(task, control),
            control,
            guard,
            signals,
            slower: [
                Slower {
                    name: chooser,
                    rate_hz: rates.chooser_hz,
                },
                Slower {
                    name: follower,
                    rate_hz: rates.follower_hz,
                },
            ],
            tap,
            grip: None,
            ticks: 0,
            told: false,
            last_step_ns: None,
            first_step_ns: 0,
        }
    }

    /// Has the grasp watched from now on.
    pub fn watch_grip(&mut self, grip: GripWatch) {
        self.grip = Some(grip);
    }

    /// The guard, for its verdict.
    pub fn guard(&mut self) -> &mut Guard {
        &mut self.guard
    }

    /// One tick: the newest sample, and whether to go on.
    pub fn step(
        &mut self,
        now_ns: u64,
        order: &Order,
        interrupted: bool,
    ) -> (Option<Sample>, Tick) {
        self.ticks += 1;
        self.supervise(now_ns, order, interrupted);
        let reading = self
            .guard
            .read(now_ns, self.motion.path(), self.motion.speed_m_s());
        self.signals.set_truth(self.guard.truth());
        if self.guard.tripped().is_some() {
            self.signals.trip();
        }
        let stopping = self.is_stopping();
        let felt =
            reading.map(|reading| (reading, self.advance(&reading, order, stopping, now_ns)));
        if felt.is_none() {
            self.ramp_down_blind(now_ns);
        }
        self.tell(now_ns, order, stopping, felt);
        self.signals.controller_lives(now_ns);
        self.last_step_ns = Some(now_ns);
        let over = self.is_stopping() && self.motion.speed_m_s() == 0.0;
        if over {
            self.guard.stop();
        }
        let sample = felt.map(|(_, sample)| sample);
        (sample, if over { Tick::AtRest } else { Tick::Going })
    }

    fn is_stopping(&self) -> bool {
        self.guard.tripped().is_some() || self.signals.is_finished()
    }

    /// What no reading can show: that this loop or another is late, or that somebody calls halt.
    fn supervise(&mut self, now_ns: u64, order: &Order, interrupted: bool) {
        if interrupted {
            self.guard.trip(Trip::Interrupted);
        }
        let Some(last_ns) = self.last_step_ns else {
            self.first_step_ns = now_ns;
            return;
        };
        let seconds = |from_ns: u64| now_ns.saturating_sub(from_ns) as f64 * 1e-9;
        let late_s = seconds(last_ns) - 1.0 / self.control.rate_hz;
        if late_s > COMMAND_PERIODS / self.control.rate_hz && self.motion.speed_m_s() != 0.0 {
            self.guard.trip(Trip::Late { late_s });
        }
        let alive_ns = [order.time_ns, self.signals.follower_alive_ns()];
        for (Slower { name, rate_hz }, alive_ns) in self.slower.into_iter().zip(alive_ns) {
            let silent_s = seconds(alive_ns.max(self.first_step_ns));
            if silent_s > SILENT_PERIODS / rate_hz && !self.signals.is_finished() {
                self.guard.trip(Trip::Silent { name, silent_s });
            }
        }
    }

    fn tell(
        &mut self,
        now_ns: u64,
        order: &Order,
        stopping: bool,
        felt: Option<(Reading, Sample)>,
    ) {
        let Some(tap) = self.tap.as_mut() else {
            return;
        };
        let truth = self.signals.truth();
        let felt = felt
            .filter(|(_, sample)| sample.valid)
            .map(|(reading, sample)| Felt {
                frame: Frame {
                    reading,
                    action: sample.action,
                    demonstration: sample.demonstration,
                    speed_m_s: sample.speed_m_s,
                    settled: sample.settled,
                    truth,
                },
                sample,
            });
        let trip = self.guard.tripped().filter(|_| !self.told);
        self.told |= trip.is_some();
        tap(&Period {
            tick: self.ticks,
            time_ns: now_ns,
            order_ns: order.time_ns,
            stopping,
            felt,
            trip,
        });
    }

    fn advance(&mut self, reading: &Reading, order: &Order, stopping: bool, now_ns: u64) -> Sample {
        let moved = self
            .motion
            .follow(self.ticks, reading, order, stopping, now_ns);
        let (Some(sample), Some((path, pose))) = (moved, self.motion.last()) else {
            return Sample::default();
        };
        self.guard.command(path, pose, sample.speed_m_s, now_ns);
        let grip = self.grip.as_mut();
        if let Some(trip) = grip.and_then(|grip| grip.see(&sample, stopping)) {
            self.guard.trip(trip);
        }
        sample
    }

    /// Without a reading the last known pose must do; the guard has tripped.
    fn ramp_down_blind(&mut self, now_ns: u64) {
        self.motion.brake();
        match self.motion.last() {
            Some((path, pose)) => {
                self.guard
                    .command(path, pose, self.motion.speed_m_s(), now_ns);
            }
            None => self.guard.stop(),
        }
    }
}
