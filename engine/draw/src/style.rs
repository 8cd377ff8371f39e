//! Sizes and colours that all pictures share.

use plotters::style::{RGBColor, WHITE};

/// 1 point of type.
pub const POINT: f64 = 300.0 / 72.0;

/// Type of a picture's first line.
pub const TITLE_SIZE: f64 = 12.0 * POINT;
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

/// What the robot believes: lines, its spread, and the spread's inner half.
pub const BELIEF: RGBColor = RGBColor(0x08, 0x30, 0x6b);
/// Light.
pub const BAND: RGBColor = RGBColor(0xc6, 0xdb, 0xef);
/// Between the two.
pub const BAND_INNER: RGBColor = RGBColor(0x92, 0xc0, 0xe2);
/// Edges of a band.
pub const BAND_EDGE: RGBColor = RGBColor(0x42, 0x92, 0xc6);
/// What is true, or was measured.
pub const TRUTH: RGBColor = RGBColor(0xb3, 0x4a, 0x00);
/// Where a goal is met.
pub const GOAL: RGBColor = RGBColor(0xd5, 0xee, 0xd0);
/// The middle of it.
pub const GOAL_LINE: RGBColor = RGBColor(0x23, 0x8b, 0x45);
/// What must not be passed, and what has gone wrong.
pub const ALARM: RGBColor = RGBColor(0xa5, 0x0f, 0x15);

/// On a dark ground these colours would be too dark or too bright; each stands beside its
/// counterpart there.
pub(crate) const DARK: [(RGBColor, RGBColor); 14] = [
    (WHITE, RGBColor(0x1b, 0x1e, 0x22)),
    (INK, RGBColor(0xe4, 0xe6, 0xe8)),
    (FRAME, RGBColor(0x9a, 0xa0, 0xa6)),
    (GRID, RGBColor(0x2e, 0x33, 0x38)),
    (ZERO, RGBColor(0x5a, 0x61, 0x68)),
    (BELIEF, RGBColor(0x9e, 0xca, 0xf5)),
    (BAND, RGBColor(0x1f, 0x3a, 0x55)),
    (BAND_INNER, RGBColor(0x2f, 0x57, 0x7d)),
    (TRUTH, RGBColor(0xff, 0x9d, 0x52)),
    (GOAL, RGBColor(0x1d, 0x3b, 0x27)),
    (GOAL_LINE, RGBColor(0x6c, 0xc9, 0x85)),
    (ALARM, RGBColor(0xff, 0x7b, 0x72)),
    // The action `stop`.
    (RGBColor(0x25, 0x25, 0x25), RGBColor(0xc9, 0xcd, 0xd2)),
    // Readings.
    (RGBColor(0x8a, 0x8a, 0x8a), RGBColor(0xa0, 0xa6, 0xac)),
];
