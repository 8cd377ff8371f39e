//! Recurrent PPO: policies that see raw observations and remember, the baselines of §IV-B.
//!
//! Policy and value network each have layers of long short-term memory in front of a perceptron
//! and share nothing, as in `RecurrentPPO` of sb3-contrib with its `MlpLstmPolicy`. States are 0
//! where an episode starts. Gradients go back through time over whole sequences, the steps of one
//! copy in one rollout, from the states that the copy had when the rollout began.

mod backward;
mod export;
mod forward;
mod learner;
mod network;
mod policy;
mod stack;
mod trace;
mod train;
mod trainee;

pub use export::LstmLayer;
pub use policy::RecurrentPolicy;
pub use train::{TrainedRecurrent, train_recurrent};

/// The recurrent layers of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lstm {
    /// How many, one upon the other.
    pub layers: usize,
    /// Units in each.
    pub width: usize,
}
