//! Sizes and colours that all pictures share.

use plotters::style::RGBColor;

/// 1 point of type.
pub const POINT: f64 = 300.0 / 72.0;

/// Type of a picture's first line.
pub const TITLE_SIZE: f64 = 14.0 * POINT;
/// Type of axis titles and legends.
pub const TEXT_SIZE: f64 = 9.0 * POINT;
/// Type above a panel.
pub const HEAD_SIZE: f64 = 10.0 * POINT;
/// Type of the figures on axes.
pub const TICK_SIZE: f64 = 8.0 * POINT;

/// Letters.
pub const INK: RGBColor = RGBColor(0x1a, 0x1a, 0x1a);
/// Around a panel.
pub const FRAME: RGBColor = RGBColor(0x66, 0x66, 0x66);
/// At round values.
pub const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
/// At zero.
pub const ZERO: RGBColor = RGBColor(0xb0, 0xb0, 0xb0);

/// Width of a thin line.
pub const THIN_WIDTH: u32 = 2;

/// Length of the mark of a tick.
pub const TICK_LENGTH: i32 = 12;

/// Stroke and gap of a dashed line.
pub const DASH: [i32; 2] = [26, 16];

/// Distance of the lines of a hatching, along x.
pub const HATCH_STEP: i32 = 24;
