//! Why training stopped without a policy.

/// E is the environments' own error.
#[derive(Debug, thiserror::Error)]
pub enum TrainError<E: std::error::Error + 'static> {
    /// Settings that cannot work.
    #[error("these settings cannot train anything: {0}")]
    Settings(String),
    /// The environments and the settings do not fit together.
    #[error("the environments do not fit the settings: {0}")]
    Mismatch(String),
    /// A step of an environment failed.
    #[error("an environment failed at step {steps}: {source}")]
    Environment {
        /// Steps done before.
        steps: usize,
        /// What it said.
        source: E,
    },
    /// An environment gave something that nothing can be learned from.
    #[error("environment {index} gave {what} at step {steps}")]
    BadObservation {
        /// Which copy.
        index: usize,
        /// The bad thing.
        what: &'static str,
        /// Steps done before.
        steps: usize,
    },
    /// The numbers ran away.
    #[error(
        "training diverged after {steps} steps: the gradient is {norm} long; a lower learning \
         rate or smaller rewards may help"
    )]
    Diverged {
        /// Steps collected so far.
        steps: usize,
        /// The length of the gradient, not finite.
        norm: f32,
    },
    /// The progress callback asked for it.
    #[error("training was cancelled after {steps} steps")]
    Cancelled {
        /// Steps done.
        steps: usize,
    },
}
