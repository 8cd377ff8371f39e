//! The surrogate MDP over belief summaries, M' = (X, A, T', R', γ), §III-B.
//!
//! A step carries the action out on a simulated true state, lets the particle filter follow with
//! sampled observations, and pays the reward of the true state: sample from T and Z, update the
//! belief, reward. The filter is the robot's own, and runs as often per policy step.

mod curriculum;
mod draw;
mod environments;
mod episode;
mod senses;
mod simulator;
mod unsteady;

pub use curriculum::Curriculum;
pub use draw::{draw_goal, draw_start};
pub use environments::{SurrogateEnvironments, TrainingOptions};
pub use episode::{Episode, Step, Stopped};
pub use senses::Senses;
pub use simulator::Simulator;

/// Which goals a policy is made for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goals {
    /// One goal state (rad, m or plain), as in the paper.
    One(f64),
    /// Every goal of the range; it is among the policy's inputs.
    Every,
}
