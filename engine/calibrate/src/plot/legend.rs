//! What the marks mean, once for the sheet.

use pubs_draw::style::{INK, TEXT_SIZE, THIN_WIDTH};
use pubs_draw::{CHARACTER_WIDTH, HPos, Lettering, Pen};

use crate::segment::Channel;

use super::panel::LEFT_OUT;
use super::style::{
    BAND, BAND_EDGE, BOUNDARY, BOUNDARY_LENGTH, HATCH, MEAN, MEAN_WIDTH, SAMPLE, SAMPLE_RADIUS,
    THRESHOLD,
};
use super::{Picture, PlotError};

/// Width of the sign before a text, and the space after each.
const SIGN: i32 = 84;
const AFTER_SIGN: i32 = 18;
const AFTER_TEXT: i32 = 60;

/// Half the height of a sign.
const HALF: i32 = 16;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    Samples,
    Mean,
    Band,
    Boundary,
    Threshold,
    LeftOut,
}

/// Draws it in one row that starts at `from`: what the picture has, and no more.
pub(super) fn draw(pen: &mut Pen, picture: &Picture, from: [i32; 2]) -> Result<(), PlotError> {
    let [mut x, y] = from;
    for (sign, text) in entries(picture) {
        sign.draw(pen, [x, y])?;
        x += SIGN + AFTER_SIGN;
        let lettering = Lettering::new(TEXT_SIZE, INK, HPos::Left);
        pen.text(&text, [x, y], lettering)?;
        x += (text.chars().count() as f64 * CHARACTER_WIDTH * TEXT_SIZE) as i32 + AFTER_TEXT;
    }
    Ok(())
}

fn entries(picture: &Picture) -> Vec<(Sign, String)> {
    let panels = &picture.panels;
    let mut entries = Vec::new();
    if panels.iter().any(|panel| !panel.samples.is_empty()) {
        entries.push((Sign::Samples, "recorded".to_owned()));
    }
    if panels.iter().any(|panel| !panel.segments.is_empty()) {
        entries.push((Sign::Mean, "mean (m_p: probability)".to_owned()));
        entries.push((Sign::Band, "\u{b1}2\u{3c3}".to_owned()));
        entries.push((Sign::Boundary, "segment starts".to_owned()));
    }
    let along = panels.iter().any(|panel| panel.channel == Channel::Along);
    if let Some(threshold) = picture.force_threshold_n.filter(|_| along) {
        let text = format!("F_t = {threshold} N, where safe mode stops");
        entries.push((Sign::Threshold, text));
    }
    if panels.iter().any(|panel| !panel.left_out.is_empty()) {
        entries.push((Sign::LeftOut, LEFT_OUT.to_owned()));
    }
    entries
}

impl Sign {
    fn draw(self, pen: &mut Pen, [x, y]: [i32; 2]) -> Result<(), PlotError> {
        let end = x + SIGN;
        match self {
            Self::Samples => {
                for (index, lift) in [4, -9, 7, -3, 10].into_iter().enumerate() {
                    let at = [x + 8 + 17 * index as i32, y + lift];
                    pen.dot(at, SAMPLE_RADIUS + 1, SAMPLE, 1.0)?;
                }
                Ok(())
            }
            Self::Mean => Ok(pen.line(&[[x, y], [end, y]], MEAN, MEAN_WIDTH)?),
            Self::Band => {
                let (above, below) = (y - HALF, y + HALF);
                let corners = [[x, above], [end, above], [end, below], [x, below]];
                pen.area(&corners, BAND)?;
                pen.line(&[[x, above], [end, above]], BAND_EDGE, THIN_WIDTH)?;
                Ok(pen.line(&[[x, below], [end, below]], BAND_EDGE, THIN_WIDTH)?)
            }
            Self::Boundary => {
                let middle = x + SIGN - 14;
                let half = BOUNDARY_LENGTH / 2;
                let mark = [[middle, y - half], [middle, y + half]];
                Ok(pen.line(&mark, BOUNDARY, THIN_WIDTH + 1)?)
            }
            Self::Threshold => Ok(pen.dashes([x, y], end, THRESHOLD, THIN_WIDTH + 2)?),
            Self::LeftOut => Ok(pen.hatching([x, y - HALF], [end, y + HALF], HATCH)?),
        }
    }
}
