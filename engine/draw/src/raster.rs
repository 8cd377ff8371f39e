//! From the SVG to pixels.

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::{DrawError, font};

/// Longest side of an image, pixels.
const LONGEST: f32 = 20_000.0;

/// Renders an SVG on white. At `scale` 1 a sheet has 96 pixels to the inch (1123 by 794, for a
/// screen); at 3.125 it has 300, for print.
///
/// # Errors
/// Where `svg` is no SVG, or the image would have no pixels or too many.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, DrawError> {
    let options = Options {
        font_family: "Noto Sans".to_owned(),
        fontdb: font::database(),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|error| DrawError::Svg(error.to_string()))?;
    let size = [tree.size().width(), tree.size().height()].map(|side| (side * scale).round());
    let fits = size.iter().all(|side| (1.0..=LONGEST).contains(side));
    let pixels = fits.then(|| Pixmap::new(size[0] as u32, size[1] as u32));
    let mut pixels = pixels.flatten().ok_or_else(|| DrawError::Size {
        width: size[0].to_string(),
        height: size[1].to_string(),
    })?;
    pixels.fill(Color::WHITE);
    let transform = Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    pixels
        .encode_png()
        .map_err(|error| DrawError::Encoding(error.to_string()))
}
