//! What can go wrong with a picture.

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
    /// The drawing library failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
    /// The text given is no SVG.
    #[error("not an SVG that can be rendered: {0}")]
    Svg(String),
    /// A size that no image can have.
    #[error(
        "an image of {width} by {height} pixels cannot be made: choose a scale that leaves 1 to 20000 pixels a side"
    )]
    Size {
        /// Pixels.
        width: String,
        /// Pixels.
        height: String,
    },
    /// The image cannot be written.
    #[error("the image cannot be encoded: {0}")]
    Encoding(String),
}
