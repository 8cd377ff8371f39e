//! An evaluation in pictures: a lane for each policy.

use pubs_draw::chart::{Chart, Key, Mark, ends};
use pubs_draw::document::Figure;
use pubs_draw::style::{ALARM, BAND_EDGE, BELIEF, FRAME, GOAL, GOAL_LINE, TRUTH};
use pubs_draw::{DrawError, Panel, Pen, RGBColor};

use super::judged::Judged;
use super::tables::factor_of;
use crate::goal_errors::GoalErrors;
use crate::statistics::{NORMAL_95, wilson_95};

/// Height of a lane, and of the least panel.
const LANE: i32 = 110;
const LEAST: i32 = 200;

/// A point and the interval around it.
type Whisker = (f64, [f64; 2]);

/// How many trials ended in one way, where the JSON says so.
type Count = fn(&Judged) -> Option<u64>;

pub(super) fn figures(judged: &[Judged]) -> Result<Vec<Figure>, DrawError> {
    let mut figures = Vec::new();
    if judged.iter().any(|one| one.success_rate.is_some()) {
        figures.push(success(judged)?);
    }
    figures.push(rewards(judged)?);
    if judged.iter().any(|one| one.safety_violations.is_some()) {
        figures.push(endings(judged)?);
    }
    for (number, one) in (1..).zip(judged) {
        if let Some(errors) = &one.goal_errors {
            figures.push(goal_errors(number, one, errors)?);
        }
    }
    Ok(figures)
}

fn figure(svg: String, caption: &str) -> Figure {
    Figure {
        file: String::new(),
        svg,
        caption: caption.to_owned(),
    }
}

/// A chart with a lane for each policy, numbered as in the tables.
fn lanes<'a>(judged: &[Judged], title: &'a str, x_title: &'a str, x: [f64; 2]) -> Chart<'a> {
    let name = |(index, one): (usize, &Judged)| {
        let label = format!("{} {}", index + 1, one.name());
        (middle(judged, index), shortened(&label))
    };
    Chart {
        title,
        height: (LANE * judged.len() as i32).max(LEAST),
        x_title,
        y_title: "",
        x,
        y: [0.0, judged.len() as f64],
        x_names: None,
        y_names: Some(judged.iter().enumerate().map(name).collect()),
        key: Vec::new(),
    }
}

fn middle(judged: &[Judged], index: usize) -> f64 {
    judged.len() as f64 - index as f64 - 0.5
}

fn shortened(name: &str) -> String {
    const LONGEST: usize = 15;
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    let short: String = name.chars().take(LONGEST - 1).collect();
    format!("{short}…")
}

fn whisker(
    pen: &mut Pen,
    panel: &Panel,
    y: i32,
    (value, [from, to]): Whisker,
    color: RGBColor,
) -> Result<(), DrawError> {
    const CAP: i32 = 14;
    let [start, end] = [from, to].map(|end| panel.x.at(end));
    pen.line(&[[start, y], [end, y]], color, 5)?;
    for x in [start, end] {
        pen.line(&[[x, y - CAP], [x, y + CAP]], color, 5)?;
    }
    pen.dot([panel.x.at(value), y], 13, color, 1.0)
}

fn success(judged: &[Judged]) -> Result<Figure, DrawError> {
    let whiskers: Vec<Option<Whisker>> = judged
        .iter()
        .map(|one| {
            let interval = wilson_95(one.successes()?, one.trials);
            Some((100.0 * one.success_rate?, interval.map(|end| 100.0 * end)))
        })
        .collect();
    let values = whiskers
        .iter()
        .flatten()
        .flat_map(|(_, interval)| *interval);
    let least = values.clone().fold(100.0, f64::min).floor().min(98.0);
    let x = ends(values, [least, 100.0]);
    let chart = lanes(
        judged,
        "Success",
        "trials that stopped in the goal region, %",
        x,
    );
    let svg = chart.svg(|pen, panel| {
        for (index, found) in whiskers.iter().enumerate() {
            if let Some(found) = found {
                whisker(
                    pen,
                    panel,
                    panel.y.at(middle(judged, index)),
                    *found,
                    BELIEF,
                )?;
            }
        }
        Ok(())
    })?;
    let caption =
        "Share of successes with its 95 % interval (Wilson). The axis need not begin at zero.";
    Ok(figure(svg, caption))
}

fn rewards(judged: &[Judged]) -> Result<Figure, DrawError> {
    /// Of the two marks from the middle of a lane.
    const APART: f64 = 0.18;
    let whisker_of = |mean: f64, se: f64| {
        let interval = [-1.0, 1.0].map(|side| mean + side * NORMAL_95 * se);
        (mean, interval)
    };
    let found: Vec<[Whisker; 2]> = judged
        .iter()
        .map(|one| {
            [
                whisker_of(one.mean_reward, one.mean_reward_se),
                whisker_of(one.mean_discounted_reward, one.mean_discounted_reward_se),
            ]
        })
        .collect();
    let values = found.iter().flatten().flat_map(|(_, interval)| *interval);
    let first = values.clone().next().unwrap_or(0.0);
    let x = ends(values, [first, first]);
    let mut chart = lanes(judged, "Reward", "mean reward of a trial", x);
    chart.key = vec![
        Key::new("reward", Mark::Dot, BELIEF),
        Key::new("discounted reward", Mark::Dot, TRUTH),
    ];
    let svg = chart.svg(|pen, panel| {
        for (index, [plain, discounted]) in found.into_iter().enumerate() {
            let y = |side: f64| panel.y.at(middle(judged, index) + side * APART);
            whisker(pen, panel, y(1.0), plain, BELIEF)?;
            whisker(pen, panel, y(-1.0), discounted, TRUTH)?;
        }
        Ok(())
    })?;
    let caption = "Means with their 95 % intervals, 1.96 standard errors to each side.";
    Ok(figure(svg, caption))
}

fn endings(judged: &[Judged]) -> Result<Figure, DrawError> {
    /// Share of a lane that is filled.
    const FILLED: f64 = 0.6;
    let kinds: [(&str, RGBColor, Count); 4] = [
        ("in the goal region", GOAL_LINE, Judged::successes),
        ("stopped elsewhere", TRUTH, |one| one.failed_stops),
        ("safety violation", ALARM, |one| one.safety_violations),
        ("timed out", FRAME, |one| one.time_outs),
    ];
    let mut chart = lanes(judged, "How trials ended", "trials, %", [0.0, 100.0]);
    let key = kinds
        .iter()
        .map(|(text, color, _)| Key::new(*text, Mark::Area, *color));
    chart.key = key.collect();
    let svg = chart.svg(|pen, panel| {
        for (index, one) in judged.iter().enumerate() {
            let [below, above] =
                [-0.5, 0.5].map(|side| panel.y.at(middle(judged, index) + side * FILLED));
            let mut from = 0.0;
            for (_, color, count) in &kinds {
                let count = count(one).unwrap_or(0);
                if count == 0 {
                    continue;
                }
                let to = from + 100.0 * count as f64 / one.trials as f64;
                // A single trial of thousands is seen as well.
                let [start, end] = [from, to].map(|end| panel.x.at(end));
                let start = start.min(panel.x.end - 4);
                pen.rectangle([start, above], [end.max(start + 4), below], *color, true)?;
                from = to;
            }
        }
        Ok(())
    })?;
    Ok(figure(
        svg,
        "Each trial ends in one of four ways; numbers are in the table.",
    ))
}

fn goal_errors(number: usize, one: &Judged, errors: &GoalErrors) -> Result<Figure, DrawError> {
    let (unit, factor) = factor_of(one);
    let bin = errors.bin * factor;
    let last = errors.counts.len() - 1;
    let shares: Vec<f64> = errors
        .counts
        .iter()
        .map(|&count| 100.0 * count as f64 / one.trials as f64)
        .collect();
    let mut key = vec![Key::new("trials that stopped", Mark::Area, BAND_EDGE)];
    if errors.counts[last] > 0 {
        key.push(Key::new("farther off than shown", Mark::Area, ALARM));
    }
    if errors.tolerance > 0.0 {
        key.push(Key::new("goal region", Mark::Area, GOAL));
    }
    let title = format!("Goal error of {number} {}", one.name());
    let x_title = match unit {
        "" => "distance from the goal at the stop".to_owned(),
        unit => format!("distance from the goal at the stop, {unit}"),
    };
    let chart = Chart {
        title: &title,
        height: 400,
        x_title: &x_title,
        y_title: "trials, %",
        x: [0.0, bin * (last + 1) as f64],
        y: [0.0, ends(shares.iter().copied(), [0.0, 1.0])[1]],
        x_names: None,
        y_names: None,
        key,
    };
    let svg = chart.svg(|pen, panel| {
        if errors.tolerance > 0.0 {
            let end = panel.x.at(errors.tolerance * factor).min(panel.x.end);
            pen.rectangle(
                [panel.x.start, panel.y.end],
                [end, panel.y.start],
                GOAL,
                true,
            )?;
        }
        for (index, share) in shares.iter().enumerate() {
            let [start, end] = [index, index + 1].map(|edge| panel.x.at(edge as f64 * bin));
            let color = if index == last { ALARM } else { BAND_EDGE };
            if *share > 0.0 {
                let upper_left = [start + 1, panel.y.at(*share).min(panel.y.at(0.0) - 3)];
                pen.rectangle(upper_left, [end - 1, panel.y.at(0.0)], color, true)?;
            }
        }
        Ok(())
    })?;
    let caption = "Shares of all trials; those that ended without a stop are not among them.";
    Ok(figure(svg, caption))
}
