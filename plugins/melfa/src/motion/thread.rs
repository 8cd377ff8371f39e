//! The thread around the cycle: timely, and with a way to rest after a breakdown.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{self, JoinHandle};

use pubs_plugin::DriverSetup;

use super::cycle::Cycle;
use crate::board::Shared;
use crate::fault::Fault;
use crate::frames::Frames;
use crate::joint_guard::JointGuard;
use crate::mxt::{MxtLink, Snapshot};
use crate::params::{Params, s_ns};
use crate::shaper::Bounds;
use crate::system::make_timely;
use crate::target::Writing;

/// What the motion thread must know, in SI.
#[derive(Debug, Clone)]
#[allow(missing_docs)]
pub struct MotionSettings {
    pub frames: Frames,
    pub joint_guard: JointGuard,
    pub writing: Writing,
    pub cycle_s: f64,
    pub filter_s: f64,
    /// m/s and rad/s.
    pub speed: Bounds,
    /// While following.
    pub acceleration: Bounds,
    /// Of a stop.
    pub stop: Bounds,
    pub jerk: Bounds,
    /// Greatest lead of the target over the arm, m and rad.
    pub lead: Bounds,
    /// Without a reply for so long the arm is brought to rest, ns.
    pub silent_ns: u64,
    /// And for so long the link is lost, ns.
    pub lost_ns: u64,
    pub relink_ns: u64,
}

impl MotionSettings {
    /// As the parameters and the object's controller say.
    pub fn new(params: &Params, setup: &DriverSetup) -> Self {
        let acceleration = Bounds {
            linear: params.acceleration_m_s2,
            angular: params.angular_acceleration_rad_s2,
        };
        let stop_m_s2 = setup.control.stop_deceleration_m_s2;
        Self {
            frames: Frames::new(params),
            joint_guard: JointGuard {
                speed_fraction: params.joint_speed_fraction,
                singularity_rad: params.singularity_deg.to_radians(),
                margin_rad: params.joint_margin_deg.to_radians(),
            },
            writing: Writing {
                quantum_mm: params.quantum_mm,
                quantum_rad: params.quantum_rad,
                continuous_angles: params.continuous_angles,
            },
            cycle_s: params.cycle_s(),
            filter_s: params.filter_ms * 1e-3,
            speed: Bounds {
                linear: params.speed_limit_m_s,
                angular: params.angular_speed_limit_rad_s,
            },
            stop: Bounds {
                linear: acceleration.linear.min(stop_m_s2),
                ..acceleration
            },
            acceleration,
            jerk: Bounds {
                linear: params.jerk_m_s3,
                angular: params.angular_jerk_rad_s3,
            },
            lead: Bounds {
                linear: params.lead_m,
                angular: params.lead_rad,
            },
            silent_ns: s_ns(params.receive_timeout_cycles * params.cycle_s()),
            lost_ns: s_ns(f64::from(params.link_lost_misses) * params.cycle_s()),
            relink_ns: s_ns(params.relink_s),
        }
    }

    /// One control cycle, ns.
    pub fn cycle_ns(&self) -> u64 {
        s_ns(self.cycle_s)
    }
}

/// The motion thread.
#[derive(Debug)]
pub struct MotionThread(JoinHandle<()>);

impl MotionThread {
    /// Starts watching; nothing moves until the board has an order.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn spawn(
        settings: MotionSettings,
        link: MxtLink,
        first: Snapshot,
        board: Shared,
    ) -> std::io::Result<Self> {
        let thread = thread::Builder::new().name("melfa motion".to_owned());
        let handle = thread.spawn(move || {
            board.lock().stats.real_time = make_timely();
            let mut cycle = Cycle::new(settings, link, first, board.clone());
            run(&board, || cycle.step());
        })?;
        Ok(Self(handle))
    }

    /// Whether it has ended.
    pub fn is_finished(&self) -> bool {
        self.0.is_finished()
    }
}

/// Calls `step` until it says that the session is over. A first breakdown becomes a fault, so that
/// the steps after it bring the arm to rest; a second one ends the thread.
fn run(board: &Shared, mut step: impl FnMut() -> bool) {
    for _ in 0..2 {
        let result = catch_unwind(AssertUnwindSafe(|| while step() {}));
        match result {
            Ok(()) => return,
            Err(panic) => {
                let text = format!("the motion thread broke down: {}", text_of(panic.as_ref()));
                board.lock().fail(Fault::driver(text));
            }
        }
    }
}

fn text_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_breakdown_becomes_a_fault_and_the_steps_go_on() {
        let board = Shared::default();
        let mut steps = 0;
        run(&board, || {
            steps += 1;
            assert!(steps != 3, "bearing seized");
            steps < 10
        });
        assert_eq!(steps, 10, "steps after the breakdown bring the arm to rest");
        let fault = board.lock().fault.clone().unwrap();
        assert!(fault.reason.contains("bearing seized"), "{fault:?}");
        run(&board, || panic!("again"));
    }
}
