//! The two slower loops, whatever they are for, and what is left when the arm rests.
//!
//! A run has the filter and the policy in them; a calibration has what carries out demonstrations.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pubs_core::Task;
use pubs_core::controller::Control;

use crate::arm::Arm;
use crate::control_loop::ControlLoop;
use crate::grip::GripWatch;
use crate::guard::{Guard, Trip};
use crate::messages::{Order, Sample, Signals};
use crate::recording::Frame;
use crate::report::LatenessReport;
use crate::{live, lockstep};

/// The middle loop: makes of the newest sample what the slow loop needs.
pub trait Follower: Send + 'static {
    /// What it tells the chooser: always the latest value, never a queue.
    type Message: Clone + Default + Send + 'static;

    /// One tick with the newest sample.
    ///
    /// # Errors
    /// In words, where it cannot go on; the arm then stops for good.
    fn step(&mut self, now_ns: u64, sample: &Sample) -> Result<Self::Message, String>;
}

/// The slow loop: chooses actions.
pub trait Chooser: Send + 'static {
    /// What it hears from the follower.
    type Message;
    /// What it shows to whoever watches.
    type Status: Clone + Default + Send + 'static;

    /// One tick with the follower's newest message.
    ///
    /// # Errors
    /// In words, where it cannot go on; the arm then stops for good.
    fn step(&mut self, now_ns: u64, message: &Self::Message) -> Result<(Order, Verdict), String>;

    /// What to show just now.
    fn status(&self, now_ns: u64) -> Self::Status;
}

/// What a tick of the chooser asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Carry out the order.
    Going,
    /// All is done: come to rest.
    Done,
    /// A safety violation by this action, judged by the true state: stop for good.
    Violation(String),
}

/// One tick of the controller, as it saw it.
#[derive(Debug, Clone, Copy)]
pub struct Period<'a> {
    /// Its number, from 1.
    pub tick: u64,
    /// When it came.
    pub time_ns: u64,
    /// [`Order::time_ns`] of the order in force.
    pub order_ns: u64,
    /// Whether the arm was to come to rest whatever was ordered.
    pub stopping: bool,
    /// What was felt; `None` where the driver gave no reading that can be used.
    pub felt: Option<Felt>,
    /// Why the guard stopped the arm, in the first tick that knows of it.
    pub trip: Option<&'a Trip>,
}

/// A reading and what the controller made of it.
#[derive(Debug, Clone, Copy)]
pub struct Felt {
    /// For a recording.
    pub frame: Frame,
    /// For the follower.
    pub sample: Sample,
}

/// Gets every control period, in the controller's thread: it must never wait.
pub type Tap = Box<dyn FnMut(&Period<'_>) + Send>;

/// How often the slower loops step, and how they are called.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// Of follower and chooser, for people.
    pub names: [&'static str; 2],
    /// Ticks of the follower per second.
    pub follower_hz: f64,
    /// Ticks of the chooser per second.
    pub chooser_hz: f64,
}

/// Everything that moves the arm, wired up but for the clock.
pub struct Drive<F, C> {
    pub(crate) controller: ControlLoop,
    pub(crate) follower: F,
    pub(crate) chooser: C,
    pub(crate) signals: Signals,
    pub(crate) names: [&'static str; 2],
    pub(crate) rates_hz: [f64; 3],
    pub(crate) interrupt: Arc<AtomicBool>,
}

/// What is left when the arm rests.
#[derive(Debug)]
pub struct Driven<F, C> {
    /// The middle loop; `None` where it hung or panicked.
    pub follower: Option<F>,
    /// The slow loop.
    pub chooser: C,
    /// Why the guard stopped the arm, if it did.
    pub trip: Option<Trip>,
    /// From the first tick to rest, s.
    pub time_s: f64,
    /// When the arm came to rest.
    pub end_ns: u64,
    /// How late the loops were; zero on a virtual clock.
    pub lateness: LatenessReport,
    /// Whether the kernel granted real-time scheduling.
    pub real_time: bool,
}

impl<F, C> Drive<F, C>
where
    F: Follower,
    C: Chooser<Message = F::Message>,
{
    /// Wires the loops to a guarded arm. `signals` are those that the loops were made with.
    #[allow(clippy::too_many_arguments, reason = "each is a different thing")]
    pub fn new(
        task: &Arc<Task>,
        control: Control,
        arm: Box<dyn Arm>,
        follower: F,
        chooser: C,
        rates: &Rates,
        signals: Signals,
        tap: Option<Tap>,
        interrupt: Arc<AtomicBool>,
    ) -> Self {
        let guard = Guard::new(arm, task, control);
        Self {
            controller: ControlLoop::new(
                Arc::clone(task),
                control,
                guard,
                signals.clone(),
                rates,
                tap,
            ),
            follower,
            chooser,
            signals,
            names: rates.names,
            rates_hz: [control.rate_hz, rates.follower_hz, rates.chooser_hz],
            interrupt,
        }
    }

    /// The same with the grasp watched.
    #[must_use]
    pub fn watching(mut self, grip: GripWatch) -> Self {
        self.controller.watch_grip(grip);
        self
    }

    /// Runs until the arm rests, in real time or on a virtual clock. `watch` is called a few times
    /// per second from another thread than the loops (in lockstep: at each tick of the chooser).
    pub fn run(self, lockstep: bool, watch: &mut dyn FnMut(&C::Status)) -> Driven<F, C> {
        if lockstep {
            lockstep::run(self, watch)
        } else {
            live::run(self, watch)
        }
    }
}
