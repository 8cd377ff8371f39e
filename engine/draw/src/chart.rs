//! A chart: one panel on a sheet, a key above it, names along its axes.

use crate::style::{INK, TEXT_SIZE};
use crate::{
    Axis, CHARACTER_WIDTH, DrawError, HPos, Lettering, Panel, Pen, RGBColor, sheet, ticks_below,
    ticks_beside,
};

/// Of every chart, so that charts below each other can be compared; narrow enough for a phone.
const WIDTH: i32 = 1500;
const LEFT: i32 = 220;
const RIGHT: i32 = WIDTH - 40;
/// Where the first row of the key stands.
const KEY_Y: i32 = 148;
const KEY_ROW: i32 = 56;
/// Length of a sample in the key, and what parts it from its text.
const KEY_MARK: i32 = 58;
const KEY_GAP: i32 = 16;
/// Between two entries of the key.
const KEY_SPACE: i32 = 36;
/// Above the panel, where marks across it have their numbers.
const HEADROOM: i32 = 62;
/// Below the panel.
const FOOT: i32 = 165;
const X_TITLE: i32 = 118;
const Y_TITLE_X: i32 = 55;
/// Names of lanes stand where the figures would.
const LANE_LEFT: i32 = 330;

/// What a chart shows beside what is drawn into its panel.
#[derive(Debug, Clone)]
pub struct Chart<'a> {
    /// Above it.
    pub title: &'a str,
    /// Of the panel, in 1/300 inch.
    pub height: i32,
    /// Name of the horizontal axis, with its unit.
    pub x_title: &'a str,
    /// Name of the vertical axis, with its unit.
    pub y_title: &'a str,
    /// Ends of the horizontal axis.
    pub x: [f64; 2],
    /// Ends of the vertical axis.
    pub y: [f64; 2],
    /// What stands along the horizontal axis in place of round figures.
    pub x_names: Option<Vec<(f64, String)>>,
    /// What stands along the vertical axis in place of round figures: lanes.
    pub y_names: Option<Vec<(f64, String)>>,
    /// What the marks mean.
    pub key: Vec<Key>,
}

/// An entry of the key.
#[derive(Debug, Clone)]
pub struct Key {
    /// What it is.
    pub text: String,
    /// How it looks.
    pub mark: Mark,
    /// Its colour.
    pub color: RGBColor,
}

/// How something is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A stroke of this width.
    Line(u32),
    /// A filled area.
    Area,
    /// A dot.
    Dot,
    /// A line across the panel.
    Upright,
}

impl Key {
    /// An entry.
    pub fn new(text: impl Into<String>, mark: Mark, color: RGBColor) -> Self {
        Self {
            text: text.into(),
            mark,
            color,
        }
    }

    fn width(&self) -> i32 {
        let text = self.text.chars().count() as f64 * CHARACTER_WIDTH * TEXT_SIZE;
        KEY_MARK + KEY_GAP + text.round() as i32
    }

    fn draw(&self, pen: &mut Pen, [x, y]: [i32; 2]) -> Result<(), DrawError> {
        let middle = x + KEY_MARK / 2;
        match self.mark {
            Mark::Line(width) => pen.line(&[[x, y], [x + KEY_MARK, y]], self.color, width)?,
            Mark::Area => pen.rectangle([x, y - 16], [x + KEY_MARK, y + 16], self.color, true)?,
            Mark::Dot => pen.dot([middle, y], 10, self.color, 1.0)?,
            Mark::Upright => pen.line(&[[middle, y - 20], [middle, y + 20]], self.color, 5)?,
        }
        let lettering = Lettering::new(TEXT_SIZE, INK, HPos::Left);
        pen.text(&self.text, [x + KEY_MARK + KEY_GAP, y], lettering)
    }
}

impl Chart<'_> {
    /// Draws the chart; `draw` fills the panel.
    ///
    /// # Errors
    /// [`DrawError::Drawing`], as all strokes.
    pub fn svg(
        &self,
        draw: impl FnOnce(&mut Pen, &Panel) -> Result<(), DrawError>,
    ) -> Result<String, DrawError> {
        let left = if self.y_names.is_some() {
            LANE_LEFT
        } else {
            LEFT
        };
        let places = self.key_places(left);
        let rows = places.last().map_or(0, |[_, y]| (y - KEY_Y) / KEY_ROW + 1);
        let top = KEY_Y - KEY_ROW / 2 + rows * KEY_ROW + HEADROOM;
        let bottom = top + self.height;
        let panel = Panel {
            x: axis(self.x, [left, RIGHT]),
            y: axis(self.y, [bottom, top]),
        };
        sheet([WIDTH, bottom + FOOT], self.title, |pen| {
            for (entry, place) in self.key.iter().zip(places) {
                entry.draw(pen, place)?;
            }
            let y_ticks = match &self.y_names {
                None => panel.y.ticks((self.height / 90).max(3) as usize),
                Some(names) => names.clone(),
            };
            let x_ticks = match &self.x_names {
                None => panel.x.ticks(7),
                Some(names) => names.clone(),
            };
            match self.y_names {
                None => panel.grid(pen, &y_ticks)?,
                // Lanes are read along the horizontal axis.
                Some(_) => panel.upright_grid(pen, &x_ticks)?,
            }
            draw(pen, &panel)?;
            panel.frame(pen)?;
            ticks_beside(pen, &panel.y, &y_ticks, left)?;
            ticks_below(pen, &panel.x, &x_ticks, bottom)?;
            let across = Lettering::new(TEXT_SIZE, INK, HPos::Center);
            pen.text(self.x_title, [(left + RIGHT) / 2, bottom + X_TITLE], across)?;
            let upright = Lettering {
                upright: true,
                ..across
            };
            pen.text(self.y_title, [Y_TITLE_X, (top + bottom) / 2], upright)
        })
    }

    /// Where each entry of the key begins; they go on in a new row where one is full.
    fn key_places(&self, left: i32) -> Vec<[i32; 2]> {
        let mut at = [left, KEY_Y];
        let place = |entry: &Key| {
            if at[0] > left && at[0] + entry.width() > RIGHT {
                at = [left, at[1] + KEY_ROW];
            }
            let here = at;
            at[0] += entry.width() + KEY_SPACE;
            here
        };
        self.key.iter().map(place).collect()
    }
}

fn axis([from, to]: [f64; 2], [start, end]: [i32; 2]) -> Axis {
    Axis {
        from,
        to,
        start,
        end,
        knee: None,
    }
}

/// Ends of an axis that shows all of `values` and both of `least`, with some room beyond.
pub fn ends(values: impl IntoIterator<Item = f64>, least: [f64; 2]) -> [f64; 2] {
    /// Share of the whole.
    const ROOM: f64 = 0.05;
    let finite = values.into_iter().filter(|value| value.is_finite());
    let [from, to] = finite.fold(least, |[from, to], value| [from.min(value), to.max(value)]);
    let room = ROOM * (to - from).max(f64::MIN_POSITIVE);
    [from - room, to + room]
}

/// A stroke through the points; it is broken where there is no value.
///
/// # Errors
/// [`DrawError::Drawing`].
pub fn trace(
    pen: &mut Pen,
    panel: &Panel,
    points: impl IntoIterator<Item = (f64, Option<f64>)>,
    color: RGBColor,
    width: u32,
) -> Result<(), DrawError> {
    for part in parts(points) {
        let places: Vec<_> = part
            .iter()
            .map(|&(x, y)| [panel.x.at(x), panel.y.at(y)])
            .collect();
        match places.as_slice() {
            [alone] => pen.dot(*alone, width, color, 1.0)?,
            _ => pen.line(&thinned(&places), color, width)?,
        }
    }
    Ok(())
}

/// The area between a lower and an upper value; it is broken where there is none.
///
/// # Errors
/// [`DrawError::Drawing`].
pub fn band(
    pen: &mut Pen,
    panel: &Panel,
    points: impl IntoIterator<Item = (f64, Option<[f64; 2]>)>,
    color: RGBColor,
) -> Result<(), DrawError> {
    for part in parts(points) {
        let edge = |side: usize| {
            let places: Vec<_> = part
                .iter()
                .map(|&(x, value)| [panel.x.at(x), panel.y.at(value[side])])
                .collect();
            thinned(&places)
        };
        let mut outline = edge(1);
        outline.extend(edge(0).into_iter().rev());
        pen.area(&outline, color)?;
    }
    Ok(())
}

/// Stretches of points that have a value.
fn parts<V>(points: impl IntoIterator<Item = (f64, Option<V>)>) -> Vec<Vec<(f64, V)>> {
    let mut parts = vec![Vec::new()];
    for (x, value) in points {
        match (value, parts.last_mut()) {
            (Some(value), Some(part)) => part.push((x, value)),
            _ => parts.push(Vec::new()),
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// Of the points in one column of the sheet the first, the lowest, the highest and the last: more
/// cannot be seen, and an hour's recording stays a small picture.
fn thinned(places: &[[i32; 2]]) -> Vec<[i32; 2]> {
    let mut kept = Vec::new();
    for column in places.chunk_by(|one, other| one[0] == other[0]) {
        let by_height = |place: &&[i32; 2]| place[1];
        let extremes = [
            column.first(),
            column.iter().min_by_key(by_height),
            column.iter().max_by_key(by_height),
            column.last(),
        ];
        let mut places: Vec<_> = extremes.into_iter().flatten().copied().collect();
        places.dedup();
        kept.extend(places);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crowded_column_keeps_what_can_be_seen() {
        let places = [
            [0, 5],
            [1, 5],
            [1, 9],
            [1, 2],
            [1, 4],
            [1, 6],
            [2, 6],
            [3, 6],
        ];
        let kept = [[0, 5], [1, 5], [1, 2], [1, 9], [1, 6], [2, 6], [3, 6]];
        assert_eq!(thinned(&places), kept);
    }

    #[test]
    fn a_trace_stands_where_its_values_say() {
        let chart = Chart {
            title: "",
            height: 400,
            x_title: "",
            y_title: "",
            x: [0.0, 2.0],
            y: [-1.0, 1.0],
            x_names: None,
            y_names: None,
            key: Vec::new(),
        };
        let points = [(0.0, Some(-1.0)), (1.0, Some(0.0)), (2.0, Some(1.0))];
        let svg = chart.svg(|pen, panel| trace(pen, panel, points, INK, 7));
        let [bottom, middle, top] = [582, 382, 182];
        let stroke = format!("points=\"{LEFT},{bottom} 840,{middle} {RIGHT},{top} \"");
        assert!(
            svg.clone().is_ok_and(|svg| svg.contains(&stroke)),
            "{svg:?}"
        );
    }

    #[test]
    fn a_missing_value_breaks_the_stroke() {
        let points = [
            (0.0, None),
            (1.0, Some(1)),
            (2.0, Some(2)),
            (3.0, None),
            (4.0, Some(4)),
        ];
        let expected = [vec![(1.0, 1), (2.0, 2)], vec![(4.0, 4)]];
        assert_eq!(parts(points), expected);
    }

    #[test]
    fn an_axis_has_room_for_all_that_is_finite() {
        let cases: [(&[f64], [f64; 2], [f64; 2]); 3] = [
            (&[], [0.0, 1.0], [-0.05, 1.05]),
            (&[-1.0, f64::NAN, 3.0], [0.0, 0.0], [-1.2, 3.2]),
            (&[f64::INFINITY], [0.0, 2.0], [-0.1, 2.1]),
        ];
        for (values, least, expected) in cases {
            let found = ends(values.iter().copied(), least);
            let near = found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(near, "{values:?}: {found:?} in place of {expected:?}");
        }
    }
}
