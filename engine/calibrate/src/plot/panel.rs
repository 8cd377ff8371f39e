//! One channel of one action, drawn.

use pubs_draw::style::{FRAME, GRID, INK, THIN_WIDTH, TICK_SIZE, ZERO};
use pubs_draw::{Axis, CHARACTER_WIDTH, DrawError, HPos, Lettering, Pen, WHITE};

use crate::segment::Channel;

use super::curve::{Curve, curves, inside, pressed};
use super::style::{
    BAND, BAND_EDGE, BOUNDARY, BOUNDARY_LENGTH, HATCH, MEAN, MEAN_WIDTH, SAMPLE, SAMPLE_OPACITY,
    SAMPLE_RADIUS, THRESHOLD,
};
use super::thin::thinned;
use super::{Panel, Sample};

/// What a panel says of stretches without demonstrations.
pub(super) const LEFT_OUT: &str = "left out: treated as blocked";

/// Height of the stripes in which the zeros and ones of m_p are strewn.
const STREWN: f64 = 0.07;

/// Half the width of the arrowhead for samples beyond the frame.
const HEAD: i32 = 7;

/// Where a panel stands, and its scales: joint states in SI, values in N or from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub x: Axis,
    pub y: Axis,
    pub limits: [f64; 2],
    pub threshold_n: Option<f64>,
}

impl Place {
    fn at(&self, point: [f64; 2]) -> [i32; 2] {
        [self.x.at(point[0]), self.y.at(point[1])]
    }

    fn line(&self, points: &[[f64; 2]]) -> Vec<[i32; 2]> {
        points.iter().map(|&point| self.at(point)).collect()
    }

    fn upper_left(&self) -> [i32; 2] {
        [self.x.start, self.y.end]
    }

    fn lower_right(&self) -> [i32; 2] {
        [self.x.end, self.y.start]
    }
}

/// Draws a panel, all but the figures on its axes.
pub(super) fn draw(
    pen: &mut Pen,
    panel: &Panel,
    place: &Place,
    y_ticks: &[f64],
) -> Result<(), DrawError> {
    let range = place.limits[1] - place.limits[0];
    let curves = curves(&panel.segments, range);
    ground(pen, place, y_ticks)?;
    for curve in &curves {
        band(pen, curve, place)?;
    }
    samples(pen, panel, place)?;
    for stretch in &panel.left_out {
        left_out(pen, *stretch, place)?;
    }
    for curve in &curves {
        for side in [-1.0, 1.0]
            .into_iter()
            .filter(|_| panel.channel != Channel::Moves)
        {
            for part in inside(&curve.line(side), &place.y) {
                pen.line(&place.line(&part), BAND_EDGE, THIN_WIDTH)?;
            }
        }
        for part in inside(&curve.mean(), &place.y) {
            pen.line(&place.line(&part), MEAN, MEAN_WIDTH)?;
        }
    }
    boundaries(pen, panel, place)?;
    if let Some(threshold) = place.threshold_n.filter(|&force| place.y.contains(force)) {
        let from = [place.x.start, place.y.at(threshold)];
        pen.dashes(from, place.x.end, THRESHOLD, THIN_WIDTH + 2)?;
    }
    pen.rectangle(place.upper_left(), place.lower_right(), FRAME, false)
}

/// Grid, zero and the limits of the joint.
fn ground(pen: &mut Pen, place: &Place, y_ticks: &[f64]) -> Result<(), DrawError> {
    for &tick in y_ticks {
        let color = if tick == 0.0 { ZERO } else { GRID };
        let y = place.y.at(tick);
        pen.line(&[[place.x.start, y], [place.x.end, y]], color, THIN_WIDTH)?;
    }
    for limit in place.limits {
        let x = place.x.at(limit);
        pen.line(&[[x, place.y.start], [x, place.y.end]], ZERO, THIN_WIDTH)?;
    }
    Ok(())
}

fn band(pen: &mut Pen, curve: &Curve, place: &Place) -> Result<(), DrawError> {
    if curve.points.iter().all(|point| point[2] == 0.0) {
        return Ok(());
    }
    let mut outline = place.line(&pressed(&curve.line(1.0), &place.y));
    let below = place.line(&pressed(&curve.line(-1.0), &place.y));
    outline.extend(below.into_iter().rev());
    pen.area(&outline, BAND)
}

fn samples(pen: &mut Pen, panel: &Panel, place: &Place) -> Result<(), DrawError> {
    let shown = panel
        .samples
        .iter()
        .filter(|sample| place.x.contains(sample.state));
    let (within, beyond): (Vec<_>, Vec<_>) = if panel.channel == Channel::Moves {
        (shown.enumerate().map(strewn).collect(), Vec::new())
    } else {
        shown
            .map(|sample| [sample.state, sample.value])
            .partition(|point| place.y.contains(point[1]))
    };
    for dot in thinned(&place.line(&within)) {
        pen.dot(dot, SAMPLE_RADIUS, SAMPLE, SAMPLE_OPACITY)?;
    }
    let pointing = |point: &[f64; 2]| {
        let above = point[1] > place.y.to;
        [
            place.x.at(point[0]),
            if above { place.y.end } else { place.y.start },
        ]
    };
    for tip in thinned(&beyond.iter().map(pointing).collect::<Vec<_>>()) {
        let inwards = if tip[1] == place.y.end { HEAD } else { -HEAD };
        let foot = tip[1] + 2 * inwards;
        let head = [tip, [tip[0] - HEAD, foot], [tip[0] + HEAD, foot]];
        pen.area(&head, SAMPLE)?;
    }
    Ok(())
}

/// Zeros and ones lie on one another: the golden ratio strews them over a narrow stripe.
fn strewn((index, sample): (usize, &Sample)) -> [f64; 2] {
    let part = (index as f64 * 0.618_033_988_749_895).fract();
    let inwards = if sample.value > 0.5 { -1.0 } else { 1.0 };
    [sample.state, sample.value + inwards * STREWN * part]
}

fn boundaries(pen: &mut Pen, panel: &Panel, place: &Place) -> Result<(), DrawError> {
    let starts = panel.segments.iter().skip(1).map(|segment| segment.from);
    let mut last = None;
    for x in starts.map(|state| place.x.at(state)) {
        if last != Some(x) {
            let end = place.y.start - BOUNDARY_LENGTH;
            pen.line(&[[x, place.y.start], [x, end]], BOUNDARY, THIN_WIDTH + 1)?;
        }
        last = Some(x);
    }
    Ok(())
}

/// Hatched; named where the name fits, and in the legend.
fn left_out(pen: &mut Pen, stretch: [f64; 2], place: &Place) -> Result<(), DrawError> {
    let [from, to] = stretch.map(|state| place.x.at(state.clamp(place.x.from, place.x.to)));
    pen.hatching([from, place.y.end], [to, place.y.start], HATCH)?;
    let length = (CHARACTER_WIDTH * TICK_SIZE * LEFT_OUT.len() as f64) as i32;
    if to - from < length + 40 {
        return Ok(());
    }
    let middle = [(from + to) / 2, (place.y.start + place.y.end) / 2];
    let half = [length / 2 + 10, (0.7 * TICK_SIZE) as i32];
    pen.rectangle(
        [middle[0] - half[0], middle[1] - half[1]],
        [middle[0] + half[0], middle[1] + half[1]],
        WHITE,
        true,
    )?;
    let lettering = Lettering::new(TICK_SIZE, INK, HPos::Center);
    pen.text(LEFT_OUT, middle, lettering)
}
