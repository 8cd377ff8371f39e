//! How far the scale of a row reaches.

use crate::segment::{Channel, Segment, Values};

use super::Panel;

/// Share of the samples that may lie beyond the frame at either end.
const BEYOND: f64 = 0.002;

/// Free space above and below what is drawn, as a share of it.
const MARGIN: f64 = 0.06;

/// A band this many times wider than half of the row's are says little; it is cut.
const WIDE: f64 = 4.0;

/// Share of the joint's range that is near a limit.
const NEAR: f64 = 0.1;

/// Forces that reach this many times farther near the limits than away from them would press
/// everything else flat: the scale is logarithmic beyond its knee.
const STEEP: f64 = 2.5;

/// The scale of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    pub from: f64,
    pub to: f64,
    /// See [`super::axis::Axis`].
    pub knee: Option<f64>,
}

/// One scale for all panels of a row: every mean, nearly every sample, zero, the threshold, and
/// the band but for where it is very wide for a moment.
pub(super) fn scale(
    channel: Channel,
    panels: &[&Panel],
    limits: [f64; 2],
    threshold_n: Option<f64>,
) -> Scale {
    if channel == Channel::Moves {
        return Scale {
            from: -0.12,
            to: 1.12,
            knee: None,
        };
    }
    let segments: Vec<_> = panels.iter().flat_map(|panel| &panel.segments).collect();
    let points: Vec<_> = segments
        .iter()
        .flat_map(|segment| points(segment))
        .collect();
    let mut values = vec![0.0];
    values.extend(threshold_n.filter(|_| channel == Channel::Along));
    values.extend(points.iter().map(|point| point[1]));
    let typical = median(segments.iter().flat_map(|segment| sigmas(segment)));
    let shown = points.iter().filter(|point| point[2] <= WIDE * typical);
    values.extend(shown.flat_map(|point| [point[1] - 2.0 * point[2], point[1] + 2.0 * point[2]]));
    for panel in panels {
        values.extend(nearly_all(panel.samples.iter().map(|sample| sample.value)));
    }
    let (from, to) = ends(values.into_iter());
    if from == to {
        return Scale {
            from: -1.0,
            to: 1.0,
            knee: None,
        };
    }
    let near = NEAR * (limits[1] - limits[0]);
    let inner = limits[0] + near..limits[1] - near;
    let steady = points.iter().filter(|point| inner.contains(&point[0]));
    let steady = steady
        .map(|point| point[1].abs() + 2.0 * point[2])
        .fold(0.0, f64::max);
    let reach = from.abs().max(to.abs());
    let knee = (steady > 0.0 && reach > STEEP * steady).then(|| round_below(steady));
    with_margin(from, to, knee)
}

fn with_margin(from: f64, to: f64, knee: Option<f64>) -> Scale {
    let margin = match knee {
        None => [MARGIN * (to - from); 2],
        // The same length on the sheet takes more newtons there.
        Some(_) => [from, to].map(|end| 2.0 * MARGIN * end.abs()),
    };
    Scale {
        from: from - margin[0],
        to: to + margin[1],
        knee,
    }
}

/// Joint state, mean, sigma.
fn points(segment: &Segment) -> Vec<[f64; 3]> {
    match &segment.values {
        Values::Moves { .. } => Vec::new(),
        Values::Force {
            position,
            mean_n,
            sigma_n,
        } => {
            let sigma = |index: usize| sigma_n.get(index).or(sigma_n.first()).copied();
            let point = |(index, (&state, &mean)): (usize, (&f64, &f64))| {
                [state, mean, sigma(index).unwrap_or(0.0)]
            };
            position.iter().zip(mean_n).enumerate().map(point).collect()
        }
    }
}

fn sigmas(segment: &Segment) -> Vec<f64> {
    points(segment).iter().map(|point| point[2]).collect()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The ends of the values without the outermost few.
fn nearly_all(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<_> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let beyond = (BEYOND * values.len() as f64) as usize;
    let ends = [Some(beyond), values.len().checked_sub(beyond + 1)];
    ends.into_iter()
        .flatten()
        .filter_map(|index| values.get(index).copied())
        .collect()
}

fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.filter(|value| value.is_finite()).fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, greatest), value| (least.min(value), greatest.max(value)),
    )
}

/// The greatest of 1, 2, 5 · 10^k that is not above `value`.
fn round_below(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let digit = [5.0, 2.0].into_iter().find(|digit| digit * decade <= value);
    digit.unwrap_or(1.0) * decade
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(mean_n: &[f64], sigma_n: f64) -> Scale {
        let last = (mean_n.len() - 1) as f64;
        let segment = Segment {
            action: "a".to_owned(),
            channel: Channel::Along,
            from: 0.0,
            to: 1.0,
            values: Values::Force {
                position: (0..mean_n.len()).map(|index| index as f64 / last).collect(),
                mean_n: mean_n.to_vec(),
                sigma_n: vec![sigma_n],
            },
            note: None,
        };
        let panel = Panel {
            action: "a",
            channel: Channel::Along,
            segments: vec![&segment],
            samples: &[],
            left_out: Vec::new(),
        };
        scale(Channel::Along, &[&panel], [0.0, 1.0], None)
    }

    #[test]
    fn even_forces_have_a_linear_scale() {
        let scale = of(&[1.0, 2.0, 3.0], 0.5);
        // From zero to 3 + 2 · 0.5, and 6 % of that.
        assert_eq!((scale.from, scale.to, scale.knee), (-0.24, 4.24, None));
    }

    #[test]
    fn spikes_at_the_limits_bend_the_scale_at_what_is_steady() {
        let scale = of(&[0.0, 6.0, 3.0, 2.5, 30.0], 0.5);
        assert_eq!(
            scale.knee,
            Some(5.0),
            "7 N is the greatest away from the limits"
        );
        assert!(scale.to > 31.0 && scale.from < -1.0, "{scale:?}");
    }
}
