//! The sheet: panels in rows and columns, and what is written around them.

use pubs_draw::style::{HEAD_SIZE, INK, TEXT_SIZE, TICK_SIZE, TITLE_SIZE};
use pubs_draw::{Axis, HPos, Lettering, Pen, WHITE, printed, ticks_below, ticks_beside};

use crate::segment::Channel;

use super::legend;
use super::panel::{self, Place};
use super::scale::scale;
use super::style::SHEET;
use super::{Panel, Picture, PlotError};

/// Left of the panels: figures and the name of the channel.
const LEFT: i32 = 250;
const RIGHT: i32 = SHEET[0] - 60;
const TITLE_Y: i32 = 75;
const SUBTITLE_Y: i32 = 142;
const LEGEND_Y: i32 = 212;
const HEAD_Y: i32 = 288;
const TOP: i32 = 325;
const BOTTOM: i32 = SHEET[1] - 155;
const GAP: [i32; 2] = [40, 36];

/// Share of the range that is shown beyond each limit, so that what happens at a limit is not on
/// the frame.
const BEYOND: f64 = 0.025;

const ROWS: [(Channel, &str, f64); 4] = [
    (Channel::Along, "f_d along the motion, N", 2.2),
    (Channel::Up, "f_z upwards, N", 1.0),
    (Channel::Normal, "f_n sideways, N", 1.0),
    (Channel::Moves, "m_p moves", 0.75),
];

/// Draws the sheet; the same picture gives the same bytes.
///
/// # Errors
/// Where there is no panel, or limits that cannot be drawn.
pub fn svg(picture: &Picture) -> Result<String, PlotError> {
    let [lower, upper] = picture.limits;
    let drawable = lower < upper && (upper - lower).is_finite();
    if !drawable {
        return Err(PlotError::Limits {
            lower: lower.to_string(),
            upper: upper.to_string(),
        });
    }
    if picture.panels.is_empty() {
        return Err(PlotError::Empty);
    }
    let mut text = String::new();
    let mut pen = Pen::on(&mut text, SHEET);
    let [width, height] = SHEET;
    pen.rectangle([0, 0], [width, height], WHITE, true)?;
    headings(&mut pen, picture)?;
    legend::draw(&mut pen, picture, [LEFT, LEGEND_Y])?;
    grid(&mut pen, picture)?;
    pen.finish()?;
    Ok(printed(&text, SHEET))
}

fn headings(pen: &mut Pen, picture: &Picture) -> Result<(), PlotError> {
    let title = Lettering {
        bold: true,
        ..Lettering::new(TITLE_SIZE, INK, HPos::Left)
    };
    pen.text(&picture.title, [LEFT, TITLE_Y], title)?;
    let subtitle = Lettering::new(TEXT_SIZE, INK, HPos::Left);
    Ok(pen.text(&picture.subtitle, [LEFT, SUBTITLE_Y], subtitle)?)
}

fn grid(pen: &mut Pen, picture: &Picture) -> Result<(), PlotError> {
    let actions = actions(picture);
    let rows: Vec<_> = ROWS
        .iter()
        .filter(|(channel, ..)| picture.panels.iter().any(|panel| panel.channel == *channel))
        .collect();
    let heights: f64 = rows.iter().map(|(.., height)| height).sum();
    let free = f64::from(BOTTOM - TOP - GAP[1] * (rows.len() as i32 - 1));
    let columns = spans([LEFT, RIGHT], GAP[0], actions.len());
    for (action, span) in actions.iter().zip(&columns) {
        let head = Lettering {
            bold: true,
            ..Lettering::new(HEAD_SIZE, INK, HPos::Center)
        };
        pen.text(action, [(span[0] + span[1]) / 2, HEAD_Y], head)?;
    }
    let mut top = TOP;
    for (index, (channel, name, height)) in rows.iter().enumerate() {
        let bottom = top + (free * height / heights).round() as i32;
        let row = Row {
            channel: *channel,
            name,
            span: [top, bottom],
            last: index + 1 == rows.len(),
        };
        row.draw(pen, picture, &actions, &columns)?;
        top = bottom + GAP[1];
    }
    let middle = [(LEFT + RIGHT) / 2, SHEET[1] - 50];
    let below = Lettering::new(TEXT_SIZE, INK, HPos::Center);
    Ok(pen.text(picture.unit.axis_title(), middle, below)?)
}

/// Names, in the order in which they come.
fn actions<'a>(picture: &Picture<'a>) -> Vec<&'a str> {
    let mut actions = Vec::new();
    for panel in &picture.panels {
        if !actions.contains(&panel.action) {
            actions.push(panel.action);
        }
    }
    actions
}

/// `count` spans of one width, side by side.
fn spans([start, end]: [i32; 2], gap: i32, count: usize) -> Vec<[i32; 2]> {
    let count = count as i32;
    let width = (end - start - gap * (count - 1)) / count;
    (0..count)
        .map(|index| {
            let from = start + index * (width + gap);
            [from, from + width]
        })
        .collect()
}

struct Row<'a> {
    channel: Channel,
    name: &'a str,
    span: [i32; 2],
    last: bool,
}

impl Row<'_> {
    fn draw(
        &self,
        pen: &mut Pen,
        picture: &Picture,
        actions: &[&str],
        columns: &[[i32; 2]],
    ) -> Result<(), PlotError> {
        let [top, bottom] = self.span;
        let panels: Vec<_> = picture
            .panels
            .iter()
            .filter(|panel| panel.channel == self.channel)
            .collect();
        let scale = scale(
            self.channel,
            &panels,
            picture.limits,
            picture.force_threshold_n,
        );
        let y = Axis {
            from: scale.from,
            to: scale.to,
            start: bottom,
            end: top,
            knee: scale.knee,
        };
        let ticks = if self.channel == Channel::Moves {
            vec![(0.0, "0".to_owned()), (1.0, "1".to_owned())]
        } else {
            y.ticks(((bottom - top) / 75).max(3) as usize)
        };
        let name = Lettering {
            upright: true,
            ..Lettering::new(TEXT_SIZE, INK, HPos::Center)
        };
        let middle = (top + bottom) / 2;
        pen.text(self.name, [LEFT - 205, middle], name)?;
        if let Some(knee) = scale.knee {
            let note = Lettering {
                size: TICK_SIZE,
                ..name
            };
            let text = format!("logarithmic beyond \u{b1}{knee}");
            pen.text(&text, [LEFT - 150, middle], note)?;
        }
        ticks_beside(pen, &y, &ticks, LEFT)?;
        let ticks: Vec<_> = ticks.into_iter().map(|(tick, _)| tick).collect();
        for (action, &[start, end]) in actions.iter().zip(columns) {
            let margin = BEYOND * (picture.limits[1] - picture.limits[0]);
            let place = Place {
                x: Axis {
                    from: picture.limits[0] - margin,
                    to: picture.limits[1] + margin,
                    start,
                    end,
                    knee: None,
                },
                y,
                limits: picture.limits,
                threshold_n: picture
                    .force_threshold_n
                    .filter(|_| self.channel == Channel::Along),
            };
            let empty = Panel {
                action,
                channel: self.channel,
                segments: Vec::new(),
                samples: &[],
                left_out: Vec::new(),
            };
            let panel = panels.iter().find(|panel| panel.action == *action);
            panel::draw(pen, panel.unwrap_or(&&empty), &place, &ticks)?;
            self.states(pen, picture, &place)?;
        }
        Ok(())
    }

    /// Ticks along the joint; their figures below the last row alone.
    fn states(&self, pen: &mut Pen, picture: &Picture, place: &Place) -> Result<(), PlotError> {
        let x = place.x;
        let axis = Axis {
            from: picture.unit.of_si(x.from),
            to: picture.unit.of_si(x.to),
            ..x
        };
        let most = ((x.end - x.start) / 120).max(2) as usize;
        let mut ticks = axis.ticks(most);
        for (_, label) in ticks.iter_mut().filter(|_| !self.last) {
            label.clear();
        }
        Ok(ticks_below(pen, &axis, &ticks, self.span[1])?)
    }
}
