//! Sizes and colours of a sheet, beside those that all pictures share.
//!
//! Lengths are in 1/300 inch. Colours differ in lightness, so that they survive greyscale print
//! and any colour vision: the band is light, samples are in the middle, the mean is dark.

use pubs_draw::RGBColor;

/// A4 landscape.
pub(super) const SHEET: [i32; 2] = [3508, 2480];

pub(super) const BAND: RGBColor = RGBColor(0xc6, 0xdb, 0xef);
pub(super) const BAND_EDGE: RGBColor = RGBColor(0x42, 0x92, 0xc6);
pub(super) const SAMPLE: RGBColor = RGBColor(0x8a, 0x8a, 0x8a);
pub(super) const MEAN: RGBColor = RGBColor(0x08, 0x30, 0x6b);
pub(super) const BOUNDARY: RGBColor = RGBColor(0xb3, 0x4a, 0x00);
pub(super) const THRESHOLD: RGBColor = RGBColor(0xa5, 0x0f, 0x15);
pub(super) const HATCH: RGBColor = RGBColor(0x9a, 0x9a, 0x9a);

pub(super) const MEAN_WIDTH: u32 = 6;
pub(super) const SAMPLE_RADIUS: u32 = 4;
pub(super) const SAMPLE_OPACITY: f64 = 0.5;

/// Length of the mark of a segment boundary.
pub(super) const BOUNDARY_LENGTH: i32 = 26;
