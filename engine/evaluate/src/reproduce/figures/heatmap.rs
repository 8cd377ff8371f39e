//! What a policy does over mean and entropy, Fig. 5.

use pubs_draw::style::{INK, TEXT_SIZE};
use pubs_draw::{
    Axis, DrawError, HPos, Lettering, Panel, Pen, WHITE, action, sheet, ticks_below, ticks_beside,
};

use crate::reproduce::heatmap::Heatmap;

const SIZE: [i32; 2] = [2060, 1300];
const LEFT: i32 = 230;
const RIGHT: i32 = 1470;
const TOP: i32 = 160;
const BOTTOM: i32 = SIZE[1] - 190;

/// Half the length of the goal's marks.
const MARK: i32 = 24;

/// How far a rectangle reaches under its right and upper neighbours, which are drawn later: the
/// sheet does not shine through between them at any scale.
const UNDER: i32 = 8;

/// A rectangle per run of one action, the goal as marks at the edges, and a legend that says which
/// actions are never chosen.
pub(crate) fn heatmap(heatmap: &Heatmap) -> Result<String, DrawError> {
    let columns = edges(&heatmap.mean);
    let rows = edges(&heatmap.entropy);
    let panel = Panel {
        x: axis(&columns, [LEFT, RIGHT]),
        y: axis(&rows, [BOTTOM, TOP]),
    };
    sheet(SIZE, &heatmap.title, |pen| {
        for (row, actions) in heatmap.action.iter().enumerate() {
            let [below, above] = [rows[row], rows[row + 1]].map(|edge| panel.y.at(edge));
            for (first, last, chosen) in runs(actions) {
                let [start, end] = [columns[first], columns[last + 1]].map(|edge| panel.x.at(edge));
                let upper_right = [(end + UNDER).min(RIGHT), (above - UNDER).max(TOP)];
                pen.rectangle(
                    [start, upper_right[1]],
                    [upper_right[0], below],
                    action(chosen),
                    true,
                )?;
            }
        }
        goal(pen, &panel, heatmap.goal)?;
        panel.frame(pen)?;
        ticks_beside(pen, &panel.y, &panel.y.ticks(6), LEFT)?;
        ticks_below(pen, &panel.x, &panel.x.ticks(8), BOTTOM)?;
        titles(pen, heatmap)?;
        legend(pen, heatmap)
    })
}

/// Half-way between neighbours, and as far beyond the ends.
fn edges(centres: &[f64]) -> Vec<f64> {
    let last = centres.len() - 1;
    let inner = centres.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
    let first = (3.0 * centres[0] - centres[1]) / 2.0;
    let beyond = (3.0 * centres[last] - centres[last - 1]) / 2.0;
    let ends = [first].into_iter().chain(inner).chain([beyond]);
    ends.collect()
}

fn axis(edges: &[f64], [start, end]: [i32; 2]) -> Axis {
    Axis {
        from: edges[0],
        to: edges[edges.len() - 1],
        start,
        end,
        knee: None,
    }
}

/// First and last column and action of each stretch with one action.
fn runs(actions: &[usize]) -> Vec<(usize, usize, usize)> {
    let mut runs: Vec<(usize, usize, usize)> = Vec::new();
    for (column, &chosen) in actions.iter().enumerate() {
        match runs.last_mut() {
            Some((_, last, same)) if *same == chosen => *last = column,
            _ => runs.push((column, column, chosen)),
        }
    }
    runs
}

/// Marks above and below the picture: a line across it would hide the one column where a policy
/// stops on whole states.
fn goal(pen: &mut Pen, panel: &Panel, goal: f64) -> Result<(), DrawError> {
    let x = panel.x.at(goal);
    for edge in [panel.y.end, panel.y.start] {
        pen.line(&[[x, edge - MARK], [x, edge + MARK]], WHITE, 13)?;
        pen.line(&[[x, edge - MARK], [x, edge + MARK]], INK, 7)?;
    }
    Ok(())
}

fn titles(pen: &mut Pen, heatmap: &Heatmap) -> Result<(), DrawError> {
    let across = Lettering::new(TEXT_SIZE, INK, HPos::Center);
    let upright = Lettering {
        upright: true,
        ..across
    };
    let mean = match heatmap.unit.as_str() {
        "" => "mean of the belief".to_owned(),
        unit => format!("mean of the belief, {unit}"),
    };
    pen.text(&mean, [(LEFT + RIGHT) / 2, BOTTOM + 110], across)?;
    pen.text("entropy", [80, (TOP + BOTTOM) / 2], upright)
}

fn legend(pen: &mut Pen, heatmap: &Heatmap) -> Result<(), DrawError> {
    let lettering = Lettering::new(TEXT_SIZE, INK, HPos::Left);
    let x = RIGHT + 50;
    let mut y = TOP + 30;
    for (index, name) in heatmap.actions.iter().enumerate() {
        pen.rectangle([x, y - 18], [x + 50, y + 18], action(index), true)?;
        let chosen = heatmap.action.iter().flatten().any(|&one| one == index);
        let note = if chosen { "" } else { " (never)" };
        pen.text(&format!("{name}{note}"), [x + 68, y], lettering)?;
        y += 62;
    }
    pen.line(&[[x + 25, y - 22], [x + 25, y + 22]], INK, 3)?;
    pen.text("goal", [x + 68, y], lettering)
}
