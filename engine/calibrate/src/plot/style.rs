//! Sizes and colours of a sheet.
//!
//! Lengths are in 1/300 inch. Colours differ in lightness, so that they survive greyscale print
//! and any colour vision: the band is light, samples are in the middle, the mean is dark.

use plotters::style::RGBColor;

/// A4 landscape.
pub(super) const SHEET: [i32; 2] = [3508, 2480];

/// The same in millimetres, for the head of the SVG.
pub(super) const SHEET_MM: [u32; 2] = [297, 210];

/// 1 point of type.
pub(super) const POINT: f64 = 300.0 / 72.0;

pub(super) const TITLE_SIZE: f64 = 14.0 * POINT;
pub(super) const TEXT_SIZE: f64 = 9.0 * POINT;
pub(super) const HEAD_SIZE: f64 = 10.0 * POINT;
pub(super) const TICK_SIZE: f64 = 8.0 * POINT;

pub(super) const INK: RGBColor = RGBColor(0x1a, 0x1a, 0x1a);
pub(super) const FRAME: RGBColor = RGBColor(0x66, 0x66, 0x66);
pub(super) const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
pub(super) const ZERO: RGBColor = RGBColor(0xb0, 0xb0, 0xb0);
pub(super) const BAND: RGBColor = RGBColor(0xc6, 0xdb, 0xef);
pub(super) const BAND_EDGE: RGBColor = RGBColor(0x42, 0x92, 0xc6);
pub(super) const SAMPLE: RGBColor = RGBColor(0x8a, 0x8a, 0x8a);
pub(super) const MEAN: RGBColor = RGBColor(0x08, 0x30, 0x6b);
pub(super) const BOUNDARY: RGBColor = RGBColor(0xb3, 0x4a, 0x00);
pub(super) const THRESHOLD: RGBColor = RGBColor(0xa5, 0x0f, 0x15);
pub(super) const HATCH: RGBColor = RGBColor(0x9a, 0x9a, 0x9a);

pub(super) const MEAN_WIDTH: u32 = 6;
pub(super) const THIN_WIDTH: u32 = 2;
pub(super) const SAMPLE_RADIUS: u32 = 4;
pub(super) const SAMPLE_OPACITY: f64 = 0.5;

/// Length of the mark of a segment boundary.
pub(super) const BOUNDARY_LENGTH: i32 = 26;

/// Stroke and gap of a dashed line.
pub(super) const DASH: [i32; 2] = [26, 16];

/// Distance of the lines of a hatching, along x.
pub(super) const HATCH_STEP: i32 = 24;
