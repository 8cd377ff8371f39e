//! What the project's pictures and pages have in common: strokes and letters on an SVG ([`Pen`]),
//! scales ([`Axis`]), sheets and panels ([`sheet()`], [`Panel`]), sizes and colours ([`style`]),
//! and the way to pixels ([`png`]); [`chart`]s are put together of them. Pages that show them are
//! made of [`document`]s, written by [`html()`].
//!
//! Lengths are in 1/300 inch. The same strokes give the same bytes on any machine: the typeface
//! is carried along.

mod axis;
pub mod chart;
pub mod document;
mod error;
mod font;
mod html;
mod palette;
mod pen;
mod print;
mod raster;
mod sheet;
pub mod style;
mod ticks;

pub use axis::Axis;
pub use error::DrawError;
pub use font::{CHARACTER_WIDTH, FAMILIES};
pub use html::html;
pub use palette::action;
pub use pen::{Lettering, Pen};
pub use plotters::style::text_anchor::HPos;
pub use plotters::style::{RGBColor, WHITE};
pub use print::printed;
pub use raster::png;
pub use sheet::{Panel, sheet};
pub use ticks::{ticks_below, ticks_beside};
