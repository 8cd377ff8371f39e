//! Strokes on the sheet, through the drawing library.

use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle,
};

use crate::DrawError;
use crate::font::FAMILIES;
use crate::style::{DASH, HATCH_STEP, THIN_WIDTH};

/// The library writes a font's size divided by this.
const SIZE_FACTOR: f64 = 1.24;

/// How a text stands to its place.
#[derive(Clone, Copy)]
pub struct Lettering {
    /// Height of the type.
    pub size: f64,
    /// Heavier.
    pub bold: bool,
    /// Of the letters.
    pub color: RGBColor,
    /// Which end of the text stands at its place.
    pub anchor: HPos,
    /// Read from below.
    pub upright: bool,
}

impl Lettering {
    /// Neither bold nor upright.
    pub fn new(size: f64, color: RGBColor, anchor: HPos) -> Self {
        Self {
            size,
            bold: false,
            color,
            anchor,
            upright: false,
        }
    }
}

/// Draws; every place is `[x, y]` in 1/300 inch from the upper left.
pub struct Pen<'a> {
    backend: SVGBackend<'a>,
}

type Drawn = Result<(), DrawError>;

impl<'a> Pen<'a> {
    /// An empty sheet whose SVG goes to `buffer`.
    pub fn on(buffer: &'a mut String, size: [i32; 2]) -> Self {
        let size = size.map(i32::unsigned_abs);
        Self {
            backend: SVGBackend::with_string(buffer, size.into()),
        }
    }

    /// Closes the SVG.
    ///
    /// # Errors
    /// [`DrawError::Drawing`], as all strokes.
    pub fn finish(mut self) -> Drawn {
        self.backend.present().map_err(drawing)
    }

    /// A stroke through the points.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn line(&mut self, points: &[[i32; 2]], color: RGBColor, width: u32) -> Drawn {
        let style = ShapeStyle {
            color: color.to_rgba(),
            filled: false,
            stroke_width: width,
        };
        let points = points.iter().map(|&point| point.into());
        self.backend.draw_path(points, &style).map_err(drawing)
    }

    /// A filled polygon.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn area(&mut self, points: &[[i32; 2]], color: RGBColor) -> Drawn {
        let points = points.iter().map(|&point| point.into());
        self.backend
            .fill_polygon(points, &color.filled())
            .map_err(drawing)
    }

    /// A filled disc.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn dot(&mut self, at: [i32; 2], radius: u32, color: RGBColor, opacity: f64) -> Drawn {
        let style = color.mix(opacity).filled();
        self.backend
            .draw_circle(at.into(), radius, &style, true)
            .map_err(drawing)
    }

    /// Filled, or its outline.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn rectangle(
        &mut self,
        from: [i32; 2],
        to: [i32; 2],
        color: RGBColor,
        fill: bool,
    ) -> Drawn {
        let style = ShapeStyle {
            color: color.to_rgba(),
            filled: fill,
            stroke_width: THIN_WIDTH,
        };
        self.backend
            .draw_rect(from.into(), to.into(), &style, fill)
            .map_err(drawing)
    }

    /// A dashed level line.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn dashes(&mut self, from: [i32; 2], to_x: i32, color: RGBColor, width: u32) -> Drawn {
        let [stroke, gap] = DASH;
        let mut x = from[0];
        while x < to_x {
            let end = (x + stroke).min(to_x);
            self.line(&[[x, from[1]], [end, from[1]]], color, width)?;
            x += stroke + gap;
        }
        Ok(())
    }

    /// Lines rising to the right over a rectangle.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn hatching(&mut self, from: [i32; 2], to: [i32; 2], color: RGBColor) -> Drawn {
        let height = to[1] - from[1];
        let mut foot = from[0] - height;
        while foot < to[0] {
            // The line x = foot + t, y = to.y - t.
            let start = (from[0] - foot).max(0);
            let end = (to[0] - foot).min(height);
            if start < end {
                let at = |t: i32| [foot + t, to[1] - t];
                self.line(&[at(start), at(end)], color, THIN_WIDTH)?;
            }
            foot += HATCH_STEP;
        }
        Ok(())
    }

    /// `at` is the middle of the letters' height.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn text(&mut self, text: &str, at: [i32; 2], lettering: Lettering) -> Drawn {
        let style = if lettering.bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        let font = FontDesc::new(
            FontFamily::Name(FAMILIES),
            lettering.size * SIZE_FACTOR,
            style,
        );
        let font = if lettering.upright {
            font.transform(FontTransform::Rotate270)
        } else {
            font
        };
        let style = TextStyle {
            font,
            color: lettering.color.to_backend_color(),
            pos: Pos::new(lettering.anchor, VPos::Center),
        };
        self.backend
            .draw_text(text, &style, at.into())
            .map_err(drawing)
    }
}

fn drawing(error: impl std::fmt::Display) -> DrawError {
    DrawError::Drawing(error.to_string())
}
