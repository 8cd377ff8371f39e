//! Segments as `[[observation.segment]]` tables.

use super::StateUnit;
use crate::segment::{Segment, Values};

/// Each segment as text. States are rounded in one way everywhere, so that neighbours still meet;
/// a segment that rounding leaves without width is left out.
pub(super) fn tiled(segments: &[Segment], unit: StateUnit) -> Vec<String> {
    segments
        .iter()
        .filter(|segment| rounded(segment.from, unit) < rounded(segment.to, unit))
        .map(|segment| table(segment, unit))
        .collect()
}

fn rounded(state: f64, unit: StateUnit) -> f64 {
    let scale = 10f64.powi(unit.decimals() as i32);
    (state * unit.per_si() * scale).round() / scale
}

fn table(segment: &Segment, unit: StateUnit) -> String {
    let suffix = unit.suffix();
    let state = |state: f64| number(state * unit.per_si(), unit.decimals());
    let mut text = segment
        .note
        .as_ref()
        .map_or_else(String::new, |note| format!("# {note}\n"));
    text += &format!(
        "[[observation.segment]]\naction = \"{}\"\nchannel = \"{}\"\nfrom_{suffix} = {}\nto_{suffix} = {}\n",
        segment.action,
        segment.channel.name(),
        state(segment.from),
        state(segment.to)
    );
    match &segment.values {
        Values::Moves { probability } => {
            text += &format!("probability = {}\n", number(*probability, 3));
        }
        Values::Force {
            position,
            mean_n,
            sigma_n,
        } => {
            let kept = distinct(position, segment, unit);
            let pick = |values: &[f64], write: fn(f64) -> String| {
                let chosen: Vec<String> = kept.iter().map(|&index| write(values[index])).collect();
                format!("[{}]", chosen.join(", "))
            };
            text += &match sigma_n.as_slice() {
                [sigma] => format!("sigma_n = {}\n", sigma_text(*sigma)),
                sigmas => format!("sigma_n = {}\n", pick(sigmas, sigma_text)),
            };
            let positions: Vec<String> = kept.iter().map(|&index| state(position[index])).collect();
            text += &format!("position_{suffix} = [{}]\n", positions.join(", "));
            text += &format!("mean_n = {}\n", pick(mean_n, |mean| number(mean, 2)));
        }
    }
    text
}

/// Positions that stay inside the segment and strictly increasing when rounded.
fn distinct(position: &[f64], segment: &Segment, unit: StateUnit) -> Vec<usize> {
    let (from, to) = (rounded(segment.from, unit), rounded(segment.to, unit));
    let mut kept: Vec<usize> = Vec::new();
    for (index, &at) in position.iter().enumerate() {
        let at = rounded(at, unit);
        let after = kept
            .last()
            .is_none_or(|&last| rounded(position[last], unit) < at);
        if after && (from..=to).contains(&at) {
            kept.push(index);
        }
    }
    kept
}

/// Never 0: a model must be able to divide by it.
fn sigma_text(sigma: f64) -> String {
    number(sigma.max(0.01), 2)
}

/// Rounded, without trailing zeros but always with a decimal, never -0.0.
fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0');
    let text = if text.ends_with('.') {
        format!("{text}0")
    } else {
        text.to_owned()
    };
    if text == "-0.0" {
        "0.0".to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segment::Channel;

    #[test]
    fn numbers_as_a_person_writes_them() {
        let cases = [
            (1.0, "1.0"),
            (-0.001, "0.0"),
            (15.875, "15.88"),
            (0.1, "0.1"),
            (-2.5, "-2.5"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value, 2), expected);
        }
        assert_eq!(sigma_text(0.0001), "0.01");
    }

    #[test]
    fn rounding_keeps_positions_increasing_and_drops_what_has_no_width() {
        let segment = |from: f64, to: f64, position: Vec<f64>| Segment {
            action: "safe_open".to_owned(),
            channel: Channel::Along,
            from,
            to,
            values: Values::Force {
                mean_n: vec![1.0; position.len()],
                sigma_n: vec![0.5],
                position,
            },
            note: Some("a remark".to_owned()),
        };
        let narrow = segment(0.100001, 0.100002, vec![0.1000015]);
        let wide = segment(0.100002, 0.2, vec![0.100003, 0.100004, 0.15, 0.2]);
        let written = tiled(&[narrow, wide], StateUnit::Metres);
        let expected = "# a remark\n[[observation.segment]]\naction = \"safe_open\"\nchannel = \"f_d\"\n\
                        from_m = 0.1\nto_m = 0.2\nsigma_n = 0.5\nposition_m = [0.1, 0.15, 0.2]\nmean_n = [1.0, 1.0, 1.0]\n";
        assert_eq!(written, [expected]);
    }
}
