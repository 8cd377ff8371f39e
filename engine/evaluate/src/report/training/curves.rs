//! Learning curves of all seeds, the kept one emphasised.

use pubs_draw::chart::{Chart, Key, Mark, ends, trace};
use pubs_draw::document::Figure;
use pubs_draw::style::{BELIEF, FRAME};
use pubs_draw::{DrawError, RGBColor};

use super::figure;
use crate::learning::{LearningCurves, SeedCurve};

const KEPT: (RGBColor, u32) = (BELIEF, 7);
const OTHER: (RGBColor, u32) = (FRAME, 3);

/// Values of a curve, and how many of the shown units are in one.
type Measure = (fn(&SeedCurve) -> &[Option<f32>], f64);

/// Return, success and violations.
pub(super) fn figures(curves: &LearningCurves) -> Result<Vec<Figure>, DrawError> {
    let mean_return: Measure = (|curve| &curve.mean_return, 1.0);
    let success: Measure = (|curve| &curve.success_rate, 100.0);
    let violations: Measure = (|curve| &curve.violation_rate, 100.0);
    let window = "over the latest 1,000 episodes of training, whose actions are drawn at random from the policy";
    let pictures = [
        (
            chart(curves, mean_return, "Return", "mean return", None),
            mean_return,
            format!("Mean undiscounted return {window}."),
        ),
        (
            chart(curves, success, "Success", "success, %", Some([0.0, 100.0])),
            success,
            format!("Share of episodes that stopped in the goal region, {window}."),
        ),
        (
            chart(
                curves,
                violations,
                "Safety violations",
                "violations, %",
                Some([0.0, 1.0]),
            ),
            violations,
            format!("Share of episodes with a safety violation, {window}."),
        ),
    ];
    let drawn = pictures
        .into_iter()
        .map(|(chart, measure, caption)| Ok(figure(svg(&chart, curves, measure)?, caption)));
    drawn.collect()
}

fn chart<'a>(
    curves: &LearningCurves,
    (values, factor): Measure,
    title: &'a str,
    y_title: &'a str,
    least: Option<[f64; 2]>,
) -> Chart<'a> {
    let all = || {
        let values = curves.seeds.iter().flat_map(values);
        values
            .flatten()
            .map(move |&value| f64::from(value) * factor)
    };
    let first = all().next().unwrap_or(0.0);
    let last = curves.seeds.iter().filter_map(|curve| curve.steps.last());
    let kept = format!("seed {} (kept)", curves.best);
    let mut key = vec![Key::new(kept, Mark::Line(KEPT.1), KEPT.0)];
    if curves.seeds.len() > 1 {
        key.push(Key::new("the other seeds", Mark::Line(OTHER.1), OTHER.0));
    }
    Chart {
        title,
        height: 430,
        x_title: "steps of the surrogate, thousands",
        y_title,
        x: [
            0.0,
            last.max().map_or(1.0, |&last| thousands(last).max(1.0)),
        ],
        y: ends(all(), least.unwrap_or([first, first])),
        x_names: None,
        y_names: None,
        key,
    }
}

fn svg(
    chart: &Chart<'_>,
    curves: &LearningCurves,
    (values, factor): Measure,
) -> Result<String, DrawError> {
    chart.svg(|pen, panel| {
        let is_kept = |curve: &&SeedCurve| curve.seed == curves.best;
        let (kept, others): (Vec<_>, Vec<_>) = curves.seeds.iter().partition(is_kept);
        let others = others.into_iter().map(|curve| (curve, OTHER));
        let kept = kept.into_iter().map(|curve| (curve, KEPT));
        for (curve, (color, width)) in others.chain(kept) {
            let steps = curve.steps.iter().map(|&steps| thousands(steps));
            let values = values(curve)
                .iter()
                .map(|value| value.map(|value| f64::from(value) * factor));
            trace(pen, panel, steps.zip(values), color, width)?;
        }
        Ok(())
    })
}

fn thousands(steps: usize) -> f64 {
    steps as f64 / 1000.0
}
