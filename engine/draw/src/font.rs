//! The typeface of pictures, carried along, so that a machine without fonts draws the same.

use std::sync::Arc;

use resvg::usvg::fontdb::Database;

/// For viewers of the SVG: the typeface itself, then those of about its width.
pub const FAMILIES: &str = "Noto Sans, Open Sans, Segoe UI, DejaVu Sans, sans-serif";

/// About the width of a character, in font sizes; used to lay out what stands in a row.
pub const CHARACTER_WIDTH: f64 = 0.53;

/// Noto Sans alone, for every family that is asked for.
pub(super) fn database() -> Arc<Database> {
    let mut fonts = Database::new();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    fonts.load_font_data(notosans::BOLD_TTF.to_vec());
    fonts.set_sans_serif_family("Noto Sans");
    Arc::new(fonts)
}
