//! What a model says along the joint, as lines.

use pubs_draw::Axis;

use crate::segment::{Segment, Values};

/// Mean and twice sigma over a stretch that segments cover without a gap.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Curve {
    /// Joint state (SI), mean, two sigma (0 for a probability).
    pub points: Vec<[f64; 3]>,
}

impl Curve {
    pub(super) fn mean(&self) -> Vec<[f64; 2]> {
        self.line(0.0)
    }

    /// `mean + side · 2σ`.
    pub(super) fn line(&self, side: f64) -> Vec<[f64; 2]> {
        let point = |&[state, mean, spread]: &[f64; 3]| [state, mean + side * spread];
        self.points.iter().map(point).collect()
    }
}

/// Curves of segments that are in order; a gap in between starts another one.
pub(super) fn curves(segments: &[&Segment], range: f64) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut end = f64::NAN;
    for segment in segments {
        let goes_on = (segment.from - end).abs() < 1e-6 * range;
        match curves.last_mut() {
            Some(curve) if goes_on => curve.points.extend(points(segment)),
            _ => curves.push(Curve {
                points: points(segment),
            }),
        }
        end = segment.to;
    }
    curves.retain(|curve| curve.points.len() > 1);
    curves
}

fn points(segment: &Segment) -> Vec<[f64; 3]> {
    match &segment.values {
        Values::Moves { probability } => {
            vec![
                [segment.from, *probability, 0.0],
                [segment.to, *probability, 0.0],
            ]
        }
        Values::Force {
            position,
            mean_n,
            sigma_n,
        } => {
            let sigma = |index: usize| sigma_n.get(index).or(sigma_n.first()).copied();
            let at = |(index, (&state, &mean)): (usize, (&f64, &f64))| {
                [state, mean, 2.0 * sigma(index).unwrap_or(0.0)]
            };
            let mut points: Vec<_> = position.iter().zip(mean_n).enumerate().map(at).collect();
            // The first and last value hold up to the ends of the segment.
            if let (Some(&first), Some(&last)) = (points.first(), points.last()) {
                if first[0] > segment.from {
                    points.insert(0, [segment.from, first[1], first[2]]);
                }
                if last[0] < segment.to {
                    points.push([segment.to, last[1], last[2]]);
                }
            }
            points
        }
    }
}

/// The parts of a line that are within the axis, cut at its ends.
pub(super) fn inside(line: &[[f64; 2]], y: &Axis) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    for pair in cut(line, y).windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let middle = 0.5 * (a[1] + b[1]);
        match parts.last_mut() {
            Some(part) if y.contains(middle) => {
                if part.is_empty() {
                    part.push(a);
                }
                part.push(b);
            }
            Some(part) if part.is_empty() => {}
            _ => parts.push(Vec::new()),
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// The line pressed into the axis: outside, it runs along the axis' end.
pub(super) fn pressed(line: &[[f64; 2]], y: &Axis) -> Vec<[f64; 2]> {
    cut(line, y)
        .into_iter()
        .map(|[state, value]| [state, value.clamp(y.from, y.to)])
        .collect()
}

/// The line with a point wherever it crosses an end of the axis.
fn cut(line: &[[f64; 2]], y: &Axis) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = line.iter().take(1).copied().collect();
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let mut crossings: Vec<_> = [y.from, y.to]
            .into_iter()
            .filter(|end| (a[1] < *end) != (b[1] < *end) && a[1] != *end && b[1] != *end)
            .map(|end| (end - a[1]) / (b[1] - a[1]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        points.extend(crossings.into_iter().map(|part| {
            let between = |index: usize| a[index] + part * (b[index] - a[index]);
            [between(0), between(1)]
        }));
        points.push(b);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const Y: Axis = Axis {
        from: 0.0,
        to: 10.0,
        start: 100,
        end: 0,
        knee: None,
    };

    #[test]
    fn spike_is_cut_where_it_leaves() {
        let line = [[0.0, 5.0], [1.0, 15.0], [2.0, 5.0], [3.0, -5.0]];
        let parts = inside(&line, &Y);
        assert_eq!(parts.len(), 2, "{parts:?}");
        assert_eq!(parts[0], [[0.0, 5.0], [0.5, 10.0]]);
        assert_eq!(parts[1][1..], [[2.0, 5.0], [2.5, 0.0]]);
        let along = pressed(&line, &Y);
        assert!(
            along.contains(&[1.0, 10.0]) && along.contains(&[3.0, 0.0]),
            "{along:?}"
        );
    }

    #[test]
    fn line_through_both_ends_crosses_twice() {
        let parts = inside(&[[0.0, -10.0], [3.0, 20.0]], &Y);
        assert_eq!(parts, [[[1.0, 0.0], [2.0, 10.0]]]);
    }
}
