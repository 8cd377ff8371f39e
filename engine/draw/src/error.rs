//! What can go wrong with a drawing.

/// Why there is no drawing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DrawError {
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
