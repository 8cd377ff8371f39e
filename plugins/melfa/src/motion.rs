//! The motion thread: one absolute target per control cycle.

mod cycle;
mod pace;
mod phase;
mod thread;

pub use pace::Pace;
pub use phase::{Inputs, Phase};
pub use thread::{MotionSettings, MotionThread};
