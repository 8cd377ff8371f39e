//! Training: PPO (Schulman et al., 2017) in native `f32`, §III-B and §IV-A.3.
//!
//! [`train`] takes copies of a task ([`Environments`]), a [`Recipe`] and a seed, and gives back a
//! policy as plain layers of weights; [`train_recurrent`] does the same with layers of memory
//! ([`Lstm`]) below them. [`surrogate`] is the task that is learned, the MDP over belief summaries.
//! `ppo` reads like the algorithm: collect a rollout, estimate advantages, go over it in
//! minibatches. What takes the time is in `kernels`: loops compiled for each [`VectorUnit`] and
//! chosen when the program runs. One thread, one seed, named streams of random numbers ([`rng`]):
//! the same seed gives the same weights on the same vector unit.

mod adam;
mod agent;
mod batch;
mod clip;
mod environment;
mod error;
mod gae;
#[cfg(test)]
mod kernel_tests;
mod kernels;
mod learner;
mod loss;
mod network;
mod normal;
mod policy;
mod ppo;
mod progress;
mod recipe;
mod recurrent;
#[cfg(test)]
mod reference;
pub mod rng;
mod rollout;
mod scaling;
pub mod surrogate;

pub use environment::{End, Environments, StepOutcome};
pub use error::TrainError;
pub use network::DenseLayer;
pub use policy::Policy;
pub use ppo::{Settings, Trained, train};
pub use progress::Progress;
pub use pubs_core::vector::VectorUnit;
pub use recipe::{InputRange, Recipe, Schedule, UnknownRecipe};
pub use recurrent::{Lstm, LstmLayer, RecurrentPolicy, TrainedRecurrent, train_recurrent};
pub use scaling::InputScaling;
