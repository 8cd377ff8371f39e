//! A sheet with a title, and the panels on it.

use crate::style::{FRAME, GRID, HEAD_SIZE, INK, THIN_WIDTH, TITLE_SIZE};
use crate::{Axis, DrawError, HPos, Lettering, Pen, WHITE, printed};

/// Where the title stands.
const TITLE: [i32; 2] = [70, 70];

/// Draws on a white sheet with a title; the SVG.
///
/// # Errors
/// [`DrawError::Drawing`], as all strokes.
pub fn sheet(
    size: [i32; 2],
    title: &str,
    draw: impl FnOnce(&mut Pen) -> Result<(), DrawError>,
) -> Result<String, DrawError> {
    let mut text = String::new();
    let mut pen = Pen::on(&mut text, size);
    pen.rectangle([0, 0], size, WHITE, true)?;
    let head = Lettering {
        bold: true,
        ..Lettering::new(TITLE_SIZE, INK, HPos::Left)
    };
    pen.text(title, TITLE, head)?;
    draw(&mut pen)?;
    pen.finish()?;
    Ok(printed(&text, size))
}

/// A panel's two scales.
#[derive(Debug, Clone, Copy)]
pub struct Panel {
    /// From left to right.
    pub x: Axis,
    /// From below.
    pub y: Axis,
}

impl Panel {
    /// Level lines at the ticks.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn grid(&self, pen: &mut Pen, ticks: &[(f64, String)]) -> Result<(), DrawError> {
        for (tick, _) in ticks {
            let y = self.y.at(*tick);
            pen.line(&[[self.x.start, y], [self.x.end, y]], GRID, THIN_WIDTH)?;
        }
        Ok(())
    }

    /// Upright lines at the ticks.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn upright_grid(&self, pen: &mut Pen, ticks: &[(f64, String)]) -> Result<(), DrawError> {
        for (tick, _) in ticks {
            let x = self.x.at(*tick);
            pen.line(&[[x, self.y.start], [x, self.y.end]], GRID, THIN_WIDTH)?;
        }
        Ok(())
    }

    /// Its outline.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn frame(&self, pen: &mut Pen) -> Result<(), DrawError> {
        let corners = [[self.x.start, self.y.end], [self.x.end, self.y.start]];
        pen.rectangle(corners[0], corners[1], FRAME, false)
    }

    /// What stands above it.
    ///
    /// # Errors
    /// [`DrawError::Drawing`].
    pub fn head(&self, pen: &mut Pen, text: &str) -> Result<(), DrawError> {
        let head = Lettering {
            bold: true,
            ..Lettering::new(HEAD_SIZE, INK, HPos::Center)
        };
        let middle = (self.x.start + self.x.end) / 2;
        pen.text(text, [middle, self.y.end - 40], head)
    }
}
