//! The controller loop: reads the driver, commands a velocity, eq. (12) and (13).

use std::sync::Arc;

use nalgebra::Vector3;
use pubs_core::Task;
use pubs_core::controller::{self, Control, SWAY_S};
use pubs_core::joint::{Direction, Path, Pose};
use pubs_plugin::Reading;

use crate::grip::GripWatch;
use crate::guard::{COMMAND_PERIODS, Guard, Trip};
use crate::loops::{Rates, Tap};
use crate::messages::{Order, Sample, Signals};
use crate::recording::Frame;

/// The slower loops may be silent for so many of their periods.
const SILENT_PERIODS: f64 = 5.0;

/// The arm counts as moving as asked within this share of the asked speed.
const SETTLED_SHARE: f64 = 0.1;

/// State of the loop between two ticks.
pub struct ControlLoop {
    task: Arc<Task>,
    control: Control,
    guard: Guard,
    signals: Signals,
    slower: [Slower; 2],
    tap: Option<Tap>,
    grip: Option<GripWatch>,
    path: Option<(Path, Pose)>,
    speed_m_s: f64,
    /// The speed that has been wanted and reached, and since when.
    steady: Option<(f64, u64)>,
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
            task,
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
            path: None,
            speed_m_s: 0.0,
            steady: None,
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
        self.supervise(now_ns, order, interrupted);
        let path = self.path.as_ref().map(|(path, _)| path);
        let reading = self.guard.read(now_ns, path, self.speed_m_s);
        self.signals.set_truth(self.guard.truth());
        if self.guard.tripped().is_some() {
            self.signals.trip();
        }
        let sample = reading.map(|reading| {
            let sample = self.advance(&reading, order, now_ns);
            self.keep(reading, &sample);
            sample
        });
        if sample.is_none() {
            self.ramp_down_blind(now_ns);
        }
        self.signals.controller_lives(now_ns);
        self.last_step_ns = Some(now_ns);
        let over = self.is_stopping() && self.speed_m_s == 0.0;
        if over {
            self.guard.stop();
        }
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
        if late_s > COMMAND_PERIODS / self.control.rate_hz && self.speed_m_s != 0.0 {
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

    fn keep(&mut self, reading: Reading, sample: &Sample) {
        let Some(tap) = self.tap.as_mut().filter(|_| sample.valid) else {
            return;
        };
        let frame = Frame {
            reading,
            action: sample.action,
            demonstration: sample.demonstration,
            speed_m_s: sample.speed_m_s,
            settled: sample.settled,
            truth: self.signals.truth(),
        };
        tap(&frame, sample);
    }

    fn advance(&mut self, reading: &Reading, order: &Order, now_ns: u64) -> Sample {
        let pose = Pose::new(reading.position_m, reading.orientation_xyzw);
        if self.path.is_none() {
            self.path = Path::at_grasp(&self.task.joint, &pose).map(|path| (path, pose));
        }
        let Some((path, last_pose)) = &mut self.path else {
            return Sample::default();
        };
        *last_pose = pose;
        let path = path.clone();
        let index = if order.valid {
            order.action
        } else {
            self.task.stop
        };
        let action = &self.task.actions[index];
        let force_along_n = controller::force_along(&path, &pose, action, reading.force_n);
        let stopping = self.guard.tripped().is_some() || self.signals.is_finished();
        let wanted = if stopping {
            0.0
        } else {
            self.control.speed(action, force_along_n)
        };
        let (is_stop, sign) = (action.is_stop(), action.sign());
        let settled = self.is_steady(wanted, now_ns) && !is_stop;
        self.speed_m_s = self.control.ramp(self.speed_m_s, wanted);
        self.guard.command(&path, &pose, self.speed_m_s, now_ns);

        // Opening for the stop action, whose sign is 0.
        let direction = Direction::of(sign);
        let force = pose.orientation * Vector3::from(reading.force_n);
        let sample = Sample {
            action: index,
            displacement: path.displacement(&pose),
            forces_n: path.frame(&pose, direction).decompose(&force),
            settled,
            speed_m_s: self.speed_m_s,
            demonstration: order.demonstration,
            valid: true,
        };
        let moves = !stopping && !is_stop;
        if let Some(trip) = self.grip.as_mut().and_then(|grip| grip.see(&sample, moves)) {
            self.guard.trip(trip);
        }
        sample
    }

    /// Whether the arm is held at rest, or has moved with the wanted speed for so long that nothing
    /// sways any more.
    fn is_steady(&mut self, wanted_m_s: f64, now_ns: u64) -> bool {
        if !is_settled(self.speed_m_s, wanted_m_s) {
            self.steady = None;
            return false;
        }
        let known = self
            .steady
            .filter(|&(speed_m_s, _)| speed_m_s == wanted_m_s);
        let (_, since_ns) = *self.steady.insert(known.unwrap_or((wanted_m_s, now_ns)));
        wanted_m_s == 0.0 || now_ns.saturating_sub(since_ns) as f64 * 1e-9 >= SWAY_S
    }

    /// Without a reading the last known pose must do; the guard has tripped.
    fn ramp_down_blind(&mut self, now_ns: u64) {
        self.speed_m_s = self.control.ramp(self.speed_m_s, 0.0);
        match &self.path {
            Some((path, pose)) => {
                self.guard
                    .command(&path.clone(), &pose.clone(), self.speed_m_s, now_ns)
            }
            None => self.guard.stop(),
        }
    }
}

/// Whether the speed is the wanted one already: then nothing accelerates.
fn is_settled(speed_m_s: f64, wanted_m_s: f64) -> bool {
    (speed_m_s - wanted_m_s).abs() <= SETTLED_SHARE * wanted_m_s.abs().max(1e-6)
}
