//! Safety violations per goal, Fig. 4 top.

use pubs_draw::style::{INK, TEXT_SIZE, TICK_SIZE};
use pubs_draw::{
    Axis, CHARACTER_WIDTH, DrawError, HPos, Lettering, Panel, Pen, sheet, ticks_beside,
};

use super::palette::METHODS;
use crate::reproduce::numbers::{NOT_RUN, decimal};
use crate::reproduce::paper;
use crate::reproduce::violations::Violations;

const SIZE: [i32; 2] = [2600, 1150];
const LEFT: i32 = 280;
const RIGHT: i32 = SIZE[0] - 60;
const TOP: i32 = 290;
const BOTTOM: i32 = SIZE[1] - 90;
const LEGEND_Y: i32 = 150;
const GAP: i32 = 60;

/// Up to so many violations the scale is linear, beyond logarithmic.
const KNEE: f64 = 10.0;

/// Above the highest bar, for its number.
const HEADROOM: f64 = 3.0;

/// Share of a slot that its bar fills.
const FILLED: f64 = 0.7;

/// A panel per goal, a bar per method: best seeds, with a dot at the mean over all.
pub(in crate::reproduce) fn bars(goals: &[(&str, Vec<Violations>)]) -> Result<String, DrawError> {
    sheet(SIZE, &title(goals), |pen| {
        if let Some((_, rows)) = goals.first() {
            legend(pen, rows)?;
        }
        let counts = goals.iter().flat_map(|(_, rows)| rows);
        let highest = counts
            .flat_map(|row| [row.best().map(|best| best as f64), row.mean()])
            .flatten()
            .fold(2.0 * KNEE, f64::max);
        let width = (RIGHT - LEFT - GAP * (goals.len() as i32 - 1)) / goals.len().max(1) as i32;
        for (index, (goal, rows)) in goals.iter().enumerate() {
            let start = LEFT + index as i32 * (width + GAP);
            let panel = Panel {
                x: linear(0.0, rows.len() as f64, [start, start + width]),
                y: Axis {
                    knee: Some(KNEE),
                    ..linear(0.0, HEADROOM * highest, [BOTTOM, TOP])
                },
            };
            let ticks = panel.y.ticks(8);
            panel.grid(pen, &ticks)?;
            if index == 0 {
                ticks_beside(pen, &panel.y, &ticks, start)?;
            }
            for (slot, row) in rows.iter().enumerate() {
                bar(pen, &panel, slot, row)?;
            }
            panel.frame(pen)?;
            panel.head(pen, goal)?;
        }
        let upright = Lettering {
            upright: true,
            ..Lettering::new(TEXT_SIZE, INK, HPos::Center)
        };
        pen.text(
            "violations, summed over tasks",
            [70, (TOP + BOTTOM) / 2],
            upright,
        )?;
        let note = format!("logarithmic above {KNEE}");
        let small = Lettering {
            size: TICK_SIZE,
            ..upright
        };
        pen.text(&note, [125, (TOP + BOTTOM) / 2], small)
    })
}

/// With the number of trials, where something has been run.
fn title(goals: &[(&str, Vec<Violations>)]) -> String {
    let rows = goals.iter().flat_map(|(_, rows)| rows);
    let count = rows.flat_map(|row| row.objects.iter().flatten()).next();
    let trials = count.map_or_else(String::new, |count| {
        format!(" in {} trials per task", count.trials)
    });
    format!("Safety violations{trials}")
}

fn linear(from: f64, to: f64, [start, end]: [i32; 2]) -> Axis {
    Axis {
        from,
        to,
        start,
        end,
        knee: None,
    }
}

fn bar(pen: &mut Pen, panel: &Panel, slot: usize, row: &Violations) -> Result<(), DrawError> {
    let slot_middle = slot as f64 + 0.5;
    let middle = panel.x.at(slot_middle);
    let lettering = Lettering::new(TICK_SIZE, INK, HPos::Center);
    let Some((best, mean)) = row.best().zip(row.mean()) else {
        let upright = Lettering {
            upright: true,
            anchor: HPos::Left,
            ..lettering
        };
        return pen.text(NOT_RUN, [middle, BOTTOM - 20], upright);
    };
    let [left, right] = [-0.5, 0.5].map(|side| panel.x.at(slot_middle + side * FILLED));
    let top = panel.y.at(best as f64);
    pen.rectangle(
        [left, top],
        [right, BOTTOM],
        METHODS[slot % METHODS.len()],
        true,
    )?;
    let mean_at = panel.y.at(mean);
    pen.dot([middle, mean_at], 11, pubs_draw::WHITE, 1.0)?;
    pen.dot([middle, mean_at], 8, INK, 1.0)?;
    let label = top.min(mean_at) - 30;
    pen.text(&decimal(best as f64, 0), [middle, label], lettering)?;
    let run = row.run();
    if run < paper::OBJECTS.len() {
        let part = format!("{run} of {}", paper::OBJECTS.len());
        pen.text(&part, [middle, BOTTOM + 30], lettering)?;
    }
    Ok(())
}

fn legend(pen: &mut Pen, rows: &[Violations]) -> Result<(), DrawError> {
    let mut x = LEFT;
    let lettering = Lettering::new(TEXT_SIZE, INK, HPos::Left);
    for (row, color) in rows.iter().zip(METHODS) {
        pen.rectangle([x, LEGEND_Y - 16], [x + 44, LEGEND_Y + 16], color, true)?;
        x = after(pen, &row.label, [x + 60, LEGEND_Y], lettering)?;
    }
    pen.dot([x + 20, LEGEND_Y], 8, INK, 1.0)?;
    after(pen, "mean over all seeds", [x + 44, LEGEND_Y], lettering)?;
    Ok(())
}

/// Writes a text and says where the next may begin.
fn after(pen: &mut Pen, text: &str, at: [i32; 2], lettering: Lettering) -> Result<i32, DrawError> {
    pen.text(text, at, lettering)?;
    let length = CHARACTER_WIDTH * lettering.size * text.chars().count() as f64;
    Ok(at[0] + length as i32 + 60)
}
