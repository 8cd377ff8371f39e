//! Light-Dark against the frequency of the belief, Fig. 4 bottom.

use pubs_draw::style::{INK, TEXT_SIZE};
use pubs_draw::{Axis, DrawError, HPos, Lettering, Panel, Pen, sheet, ticks_below, ticks_beside};

use super::palette::LINES;
use crate::reproduce::frequency::{Line, Point};
use crate::reproduce::paper::{Estimate, FREQUENCIES};
use crate::statistics::NORMAL_95;

const SIZE: [i32; 2] = [2600, 1100];
const PANELS: [[i32; 2]; 2] = [[230, 1250], [1520, 2540]];
const TOP: i32 = 290;
const BOTTOM: i32 = SIZE[1] - 190;
const LEGEND_Y: i32 = 150;

const MARGIN: f64 = 0.08;

/// Two panels, reward and success; a line per method. A frequency that has not been run has no
/// point.
pub(in crate::reproduce) fn lines(lines: &[Line]) -> Result<String, DrawError> {
    sheet(SIZE, "Light-Dark and the frequency of the belief", |pen| {
        legend(pen, lines)?;
        let heads = ["mean reward", "success, %"];
        let measures: [fn(&Point) -> Estimate; 2] = [
            |point| point.reward,
            |point| Estimate {
                mean: 100.0 * point.success.mean,
                se: 100.0 * point.success.se,
            },
        ];
        for ((head, measure), span) in heads.into_iter().zip(measures).zip(PANELS) {
            let panel = panel(lines, measure, span);
            let ticks = panel.y.ticks(7);
            panel.grid(pen, &ticks)?;
            ticks_beside(pen, &panel.y, &ticks, panel.x.start)?;
            let ticks = FREQUENCIES.map(|frequency| (f64::from(frequency), frequency.to_string()));
            ticks_below(pen, &panel.x, &ticks, BOTTOM)?;
            for (line, color) in lines.iter().zip(LINES) {
                draw(pen, &panel, line, measure, color)?;
            }
            panel.frame(pen)?;
            panel.head(pen, head)?;
            let middle = [(span[0] + span[1]) / 2, BOTTOM + 110];
            let below = Lettering::new(TEXT_SIZE, INK, HPos::Center);
            pen.text("filter updates per large move", middle, below)?;
        }
        Ok(())
    })
}

fn panel(lines: &[Line], measure: fn(&Point) -> Estimate, [start, end]: [i32; 2]) -> Panel {
    let points = lines.iter().flat_map(|line| line.points.iter().flatten());
    let intervals = points.map(|point| interval(measure(point)));
    let [least, greatest] = intervals.fold([f64::INFINITY, f64::NEG_INFINITY], |ends, interval| {
        [ends[0].min(interval[0]), ends[1].max(interval[1])]
    });
    let [least, greatest] = if least <= greatest {
        [least, greatest]
    } else {
        [0.0, 100.0]
    };
    let margin = MARGIN * (greatest - least).max(1.0);
    Panel {
        x: Axis {
            from: 0.5,
            to: 10.5,
            start,
            end,
            knee: None,
        },
        y: Axis {
            from: least - margin,
            to: greatest + margin,
            start: BOTTOM,
            end: TOP,
            knee: None,
        },
    }
}

/// With 95 % confidence.
fn interval(value: Estimate) -> [f64; 2] {
    [-1.0, 1.0].map(|side| value.mean + side * NORMAL_95 * value.se)
}

fn draw(
    pen: &mut Pen,
    panel: &Panel,
    line: &Line,
    measure: fn(&Point) -> Estimate,
    color: pubs_draw::RGBColor,
) -> Result<(), DrawError> {
    let run = FREQUENCIES.iter().zip(&line.points);
    let run = run.filter_map(|(&frequency, point)| {
        Some((panel.x.at(f64::from(frequency)), measure(point.as_ref()?)))
    });
    let run: Vec<_> = run.collect();
    let stroke: Vec<_> = run
        .iter()
        .map(|(x, value)| [*x, panel.y.at(value.mean)])
        .collect();
    if stroke.len() > 1 {
        pen.line(&stroke, color, 6)?;
    }
    for (x, value) in run {
        pen.line(&interval(value).map(|end| [x, panel.y.at(end)]), color, 4)?;
        pen.dot([x, panel.y.at(value.mean)], 12, color, 1.0)?;
    }
    Ok(())
}

fn legend(pen: &mut Pen, lines: &[Line]) -> Result<(), DrawError> {
    let lettering = Lettering::new(TEXT_SIZE, INK, HPos::Left);
    for (index, (line, color)) in lines.iter().zip(LINES).enumerate() {
        let x = PANELS[0][0] + 450 * index as i32;
        pen.line(&[[x, LEGEND_Y], [x + 84, LEGEND_Y]], color, 6)?;
        pen.dot([x + 42, LEGEND_Y], 12, color, 1.0)?;
        let missing = line.points.iter().all(Option::is_none);
        let note = if missing { " (not run)" } else { "" };
        let text = format!("{}{note}", line.label);
        pen.text(&text, [x + 102, LEGEND_Y], lettering)?;
    }
    Ok(())
}
