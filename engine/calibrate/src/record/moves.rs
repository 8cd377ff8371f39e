//! The four movement actions of an arm, by what they do.

use pubs_core::Task;

/// Indices into the task's actions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Moves {
    pub safe_open: usize,
    pub safe_close: usize,
    pub high_open: usize,
    pub high_close: usize,
}

impl Moves {
    /// How many there are.
    pub const COUNT: usize = 4;

    /// Those of a task; `None` where one is missing.
    pub fn of(task: &Task) -> Option<Self> {
        let find = |high_force: bool, sign: f64| {
            task.actions
                .iter()
                .position(|action| action.is_high_force() == high_force && action.sign() == sign)
        };
        Some(Self {
            safe_open: find(false, 1.0)?,
            safe_close: find(false, -1.0)?,
            high_open: find(true, 1.0)?,
            high_close: find(true, -1.0)?,
        })
    }
}
