//! What can go wrong with a picture.

use pubs_draw::DrawError;

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlotError {
    /// Limits that are not finite or not in order.
    #[error(
        "a joint from {lower} to {upper} cannot be drawn: limits must be finite, closed below open"
    )]
    Limits {
        /// SI.
        lower: String,
        /// SI.
        upper: String,
    },
    /// Nothing to draw.
    #[error("a picture needs at least one panel")]
    Empty,
    /// Drawing failed.
    #[error(transparent)]
    Draw(#[from] DrawError),
}
