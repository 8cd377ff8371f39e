//! Marks and figures along axes.

use crate::style::{FRAME, INK, THIN_WIDTH, TICK_LENGTH, TICK_SIZE};
use crate::{Axis, DrawError, HPos, Lettering, Pen};

/// Space between a mark and its figure.
const BESIDE: i32 = 12;
const BELOW: i32 = 28;

/// Marks to the left of `x`, with their figures.
///
/// # Errors
/// [`DrawError::Drawing`].
pub fn ticks_beside(
    pen: &mut Pen,
    axis: &Axis,
    ticks: &[(f64, String)],
    x: i32,
) -> Result<(), DrawError> {
    let figure = Lettering::new(TICK_SIZE, INK, HPos::Right);
    for (tick, label) in ticks {
        let y = axis.at(*tick);
        pen.text(label, [x - TICK_LENGTH - BESIDE, y], figure)?;
        pen.line(&[[x - TICK_LENGTH, y], [x, y]], FRAME, THIN_WIDTH)?;
    }
    Ok(())
}

/// Marks below `y`; their figures where the labels are not empty.
///
/// # Errors
/// [`DrawError::Drawing`].
pub fn ticks_below(
    pen: &mut Pen,
    axis: &Axis,
    ticks: &[(f64, String)],
    y: i32,
) -> Result<(), DrawError> {
    let figure = Lettering::new(TICK_SIZE, INK, HPos::Center);
    for (tick, label) in ticks {
        let x = axis.at(*tick);
        pen.line(&[[x, y], [x, y + TICK_LENGTH]], FRAME, THIN_WIDTH)?;
        if !label.is_empty() {
            pen.text(label, [x, y + TICK_LENGTH + BELOW], figure)?;
        }
    }
    Ok(())
}
