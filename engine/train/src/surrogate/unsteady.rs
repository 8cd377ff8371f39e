//! Updates without forces: an arm that takes up another action speeds up, turns round and sways.
//!
//! The filter loop of a run weighs no forces until that is over, nor across the change itself. A
//! simulator that gave them would teach a policy to learn from jerks.

use pubs_core::{Motion, Task};

/// How long the present action's forces still do not count.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Unsteady {
    action: Option<usize>,
    speed_m_s: f64,
    /// Filter updates that are left; `None` off the arm, where nothing sways.
    updates: Option<u32>,
}

impl Unsteady {
    /// The next policy step carries out the action of this index.
    pub fn change_to(&mut self, task: &Task, index: usize) {
        let Some(control) = task.control else {
            return;
        };
        if self.action == Some(index) {
            return;
        }
        let action = &task.actions[index];
        let speed_m_s = match action.motion {
            Motion::Move { mode, .. } => action.sign() * control.speed_m_s(mode),
            Motion::Stop => 0.0,
        };
        let unsteady_s = control.unsteady_s(self.speed_m_s, speed_m_s);
        // The first update that is steady has none before it to compare with.
        let updates = (unsteady_s * task.belief.rate_hz).ceil() + 1.0;
        *self = Self {
            action: Some(index),
            speed_m_s,
            updates: Some(updates as u32),
        };
    }

    /// Whether the next update is one without forces, the handle having moved by `displacement`. A
    /// handle that is held tells so at once.
    pub fn passes_over(&mut self, displacement: f64) -> bool {
        let Some(updates) = &mut self.updates else {
            return false;
        };
        if displacement == 0.0 {
            *updates = 0;
            self.speed_m_s = 0.0;
            return false;
        }
        let unsteady = *updates > 0;
        *updates = updates.saturating_sub(1);
        unsteady
    }
}
