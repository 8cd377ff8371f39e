//! What the loops tell each other: always the latest value, never a queue.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pubs_core::belief::Summary;
use pubs_core::observation::ARM_CHANNELS;

/// Controller to filter: one control period.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample {
    /// Number of the controller's tick, from 1; 0: there is no sample.
    pub tick: u64,
    /// Index of the action in force.
    pub action: usize,
    /// Joint displacement since the grasp (rad or m).
    pub displacement: f64,
    /// (f_d, f_z, f_n) along the action's direction, N.
    pub forces_n: [f64; 3],
    /// Whether the arm moves as the action asks, neither speeding up nor still turning round, so
    /// that the forces are those the observation model describes.
    pub settled: bool,
    /// Speed along the path that is commanded, positive towards open, m/s.
    pub speed_m_s: f64,
    /// Which demonstration of a calibration it belongs to; 0: none.
    pub demonstration: u32,
    /// Whether there is a sample at all.
    pub valid: bool,
}

/// Filter to policy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeliefMessage {
    /// Number of the filter's step, from 1; 0: there is no belief.
    pub step: u64,
    /// Mean and entropy.
    pub summary: Summary,
    /// The newest reading of each of the model's channels that counted, 0 before the first.
    pub readings: [f32; ARM_CHANNELS.len()],
    /// Bit i: the shield allows action i.
    pub allowed: u64,
    /// Joint displacement since the grasp (rad or m), from the sample that was used.
    pub displacement: f64,
    /// Speed the arm is commanded, m/s, from the same.
    pub speed_m_s: f64,
    /// Whether there is a belief at all.
    pub valid: bool,
}

impl Default for BeliefMessage {
    fn default() -> Self {
        Self {
            step: 0,
            summary: Summary {
                mean: 0.0,
                entropy: 1.0,
            },
            readings: [0.0; ARM_CHANNELS.len()],
            allowed: u64::MAX,
            displacement: 0.0,
            speed_m_s: 0.0,
            valid: false,
        }
    }
}

/// Chooser to controller.
#[derive(Debug, Clone, Copy, Default)]
pub struct Order {
    /// When the chooser stepped; its sign of life.
    pub time_ns: u64,
    /// Index of the action.
    pub action: usize,
    /// Which demonstration of a calibration it belongs to; 0: none.
    pub demonstration: u32,
    /// Whether there is an order at all.
    pub valid: bool,
}

/// Policy to whoever watches.
#[derive(Debug, Clone, Copy)]
pub struct Status {
    /// Since the start, s.
    pub time_s: f64,
    /// Which goal of the list.
    pub goal: usize,
    /// Mean and entropy.
    pub summary: Summary,
    /// Index of the action.
    pub action: usize,
    /// Policy steps towards this goal.
    pub steps: u32,
}

impl Default for Status {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            goal: 0,
            summary: Summary {
                mean: 0.0,
                entropy: 1.0,
            },
            action: 0,
            steps: 0,
        }
    }
}

/// Flags that every loop sees.
#[derive(Debug, Clone, Default)]
pub struct Signals(Arc<Flags>);

#[derive(Debug, Default)]
struct Flags {
    stop: AtomicBool,
    tripped: AtomicBool,
    /// Bits of the true joint state, NaN where nobody knows; it travels apart from the samples.
    truth: AtomicU64,
    follower_alive_ns: AtomicU64,
    controller_alive_ns: AtomicU64,
}

impl Signals {
    /// Nothing signalled, truth unknown.
    pub fn new() -> Self {
        let signals = Self::default();
        signals.set_truth(None);
        signals
    }

    /// The run is over: come to rest and leave.
    pub(crate) fn finish(&self) {
        self.0.stop.store(true, Ordering::Release);
    }

    /// Whether the run is over.
    pub(crate) fn is_finished(&self) -> bool {
        self.0.stop.load(Ordering::Acquire)
    }

    /// The guard has stopped the arm for good.
    pub(crate) fn trip(&self) {
        self.0.tripped.store(true, Ordering::Release);
    }

    /// Whether the guard has stopped the arm.
    pub(crate) fn is_tripped(&self) -> bool {
        self.0.tripped.load(Ordering::Acquire)
    }

    /// Sets the true state, for scoring.
    pub(crate) fn set_truth(&self, truth: Option<f64>) {
        self.0
            .truth
            .store(truth.unwrap_or(f64::NAN).to_bits(), Ordering::Release);
    }

    /// The true state, where somebody knows.
    pub fn truth(&self) -> Option<f64> {
        let truth = f64::from_bits(self.0.truth.load(Ordering::Acquire));
        truth.is_finite().then_some(truth)
    }

    /// The middle loop stepped.
    pub(crate) fn follower_lives(&self, now_ns: u64) {
        self.0.follower_alive_ns.store(now_ns, Ordering::Release);
    }

    /// When the middle loop last stepped.
    pub(crate) fn follower_alive_ns(&self) -> u64 {
        self.0.follower_alive_ns.load(Ordering::Acquire)
    }

    /// The controller stepped.
    pub(crate) fn controller_lives(&self, now_ns: u64) {
        self.0.controller_alive_ns.store(now_ns, Ordering::Release);
    }

    /// When the controller last stepped.
    pub(crate) fn controller_alive_ns(&self) -> u64 {
        self.0.controller_alive_ns.load(Ordering::Acquire)
    }
}
