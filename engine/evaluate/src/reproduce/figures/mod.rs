//! The paper's figures.

mod bars;
mod heatmap;
mod lines;
mod palette;

pub(super) use bars::bars;
pub(crate) use heatmap::heatmap;
pub(super) use lines::lines;
