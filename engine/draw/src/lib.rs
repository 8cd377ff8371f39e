//! What the project's pictures have in common: strokes and letters on an SVG ([`Pen`]), scales
//! ([`Axis`]), sizes and colours ([`style`]), and the way to pixels ([`png`]).
//!
//! Lengths are in 1/300 inch. The same strokes give the same bytes on any machine: the typeface
//! is carried along.

mod axis;
mod error;
mod font;
mod pen;
mod print;
mod raster;
pub mod style;
mod ticks;

pub use axis::Axis;
pub use error::DrawError;
pub use font::{CHARACTER_WIDTH, FAMILIES};
pub use pen::{Lettering, Pen};
pub use plotters::style::text_anchor::HPos;
pub use plotters::style::{RGBColor, WHITE};
pub use print::printed;
pub use raster::png;
pub use ticks::{ticks_below, ticks_beside};
