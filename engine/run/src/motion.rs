//! What one reading means for the motion: where the joint is, what is felt along it, and how fast
//! the arm is to go, eq. (12) and (13).

use std::sync::Arc;

use nalgebra::Vector3;
use pubs_core::Task;
use pubs_core::controller::{self, Control, SWAY_S};
use pubs_core::joint::{Direction, Path, Pose};
use pubs_plugin::Reading;

use crate::messages::{Order, Sample};

/// The arm counts as moving as asked within this share of the asked speed.
const SETTLED_SHARE: f64 = 0.1;

/// The controller's state without its robot: the same readings and orders give the same samples,
/// in a run and in its replay.
pub struct Motion {
    task: Arc<Task>,
    control: Control,
    path: Option<(Path, Pose)>,
    speed_m_s: f64,
    /// The speed that has been wanted and reached, and since when.
    steady: Option<(f64, u64)>,
}

impl Motion {
    /// At rest, the path of the handle still unknown.
    pub fn new(task: Arc<Task>, control: Control) -> Self {
        Self {
            task,
            control,
            path: None,
            speed_m_s: 0.0,
            steady: None,
        }
    }

    /// The path of the handle, once there was a reading.
    pub fn path(&self) -> Option<&Path> {
        self.last().map(|(path, _)| path)
    }

    /// The path and the last pose on it.
    pub fn last(&self) -> Option<&(Path, Pose)> {
        self.path.as_ref()
    }

    /// The speed that is commanded, positive towards open, m/s.
    pub fn speed_m_s(&self) -> f64 {
        self.speed_m_s
    }

    /// A period without a reading: the speed falls.
    pub fn brake(&mut self) {
        self.speed_m_s = self.control.ramp(self.speed_m_s, 0.0);
    }

    /// The period of this tick with its reading; `stopping` where the arm is to come to rest whatever
    /// is ordered. `None` on joints that no arm moves.
    pub fn follow(
        &mut self,
        tick: u64,
        reading: &Reading,
        order: &Order,
        stopping: bool,
        now_ns: u64,
    ) -> Option<Sample> {
        let pose = Pose::new(reading.position_m, reading.orientation_xyzw);
        if self.path.is_none() {
            self.path = Path::at_grasp(&self.task.joint, &pose).map(|path| (path, pose));
        }
        let (path, last_pose) = self.path.as_mut()?;
        *last_pose = pose;
        let path = path.clone();
        let index = if order.valid {
            order.action
        } else {
            self.task.stop
        };
        let action = &self.task.actions[index];
        let force_along_n = controller::force_along(&path, &pose, action, reading.force_n);
        let wanted = if stopping {
            0.0
        } else {
            self.control.speed(action, force_along_n)
        };
        let (is_stop, sign) = (action.is_stop(), action.sign());
        let settled = self.is_steady(wanted, now_ns) && !is_stop;
        self.speed_m_s = self.control.ramp(self.speed_m_s, wanted);

        // Opening for the stop action, whose sign is 0.
        let direction = Direction::of(sign);
        let force = pose.orientation * Vector3::from(reading.force_n);
        Some(Sample {
            tick,
            action: index,
            displacement: path.displacement(&pose),
            forces_n: path.frame(&pose, direction).decompose(&force),
            settled,
            speed_m_s: self.speed_m_s,
            demonstration: order.demonstration,
            valid: true,
        })
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
}

/// Whether the speed is the wanted one already: then nothing accelerates.
fn is_settled(speed_m_s: f64, wanted_m_s: f64) -> bool {
    (speed_m_s - wanted_m_s).abs() <= SETTLED_SHARE * wanted_m_s.abs().max(1e-6)
}
