//! What an episode keeps up for whoever chooses its actions.

use std::sync::Arc;

use pubs_core::Input;

/// The policy's inputs, and whether a particle filter follows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Senses {
    /// What the policy reads, in order; nothing for a chooser with a belief of its own.
    pub inputs: Arc<[Input]>,
    /// Whether a particle filter follows. The baselines have none, which also saves most of the
    /// time of a step.
    pub belief: bool,
}

impl Senses {
    /// A filter follows where an input is of the belief, or a shield looks at it.
    pub fn new(inputs: impl Into<Arc<[Input]>>, shielded: bool) -> Self {
        let inputs = inputs.into();
        Self {
            belief: shielded || inputs.iter().any(|input| input.is_of_belief()),
            inputs,
        }
    }

    /// Whether some input is drawn anew at each step.
    pub(super) fn draws(&self) -> bool {
        self.inputs.contains(&Input::RandomEntropy)
    }
}
