//! Laying one segment over others that tile the range.

use crate::curve::Piece;
use crate::segment::{Segment, Values};

/// Lays a stretch over segments that tile the range: what it covers gives way.
pub fn with_stretch(segments: Vec<Segment>, stretch: Segment) -> Vec<Segment> {
    let mut laid = Vec::with_capacity(segments.len() + 2);
    for segment in segments {
        if segment.from < stretch.from {
            laid.extend(clipped(
                &segment,
                segment.from,
                segment.to.min(stretch.from),
            ));
        }
        if segment.to > stretch.to {
            laid.extend(clipped(&segment, segment.from.max(stretch.to), segment.to));
        }
    }
    laid.push(stretch);
    laid.sort_by(|a, b| a.from.total_cmp(&b.from));
    laid
}

/// The part of a segment between two states, its curve the same there.
fn clipped(segment: &Segment, from: f64, to: f64) -> Option<Segment> {
    if to <= from {
        return None;
    }
    let values = match &segment.values {
        Values::Moves { .. } => segment.values.clone(),
        Values::Force {
            position,
            mean_n,
            sigma_n,
        } => {
            let whole = |values: &[f64]| Piece {
                from: segment.from,
                to: segment.to,
                position: position.clone(),
                mean_n: if values.len() == 1 {
                    vec![values[0]; position.len()]
                } else {
                    values.to_vec()
                },
                sigma_n: 0.0,
                readings: 0,
            };
            let (mean, sigma) = (whole(mean_n), whole(sigma_n));
            let mut kept: Vec<f64> = position
                .iter()
                .copied()
                .filter(|at| (from..=to).contains(at))
                .collect();
            for end in [from, to] {
                let inside = position[0] < end && end < position[position.len() - 1];
                if inside && !kept.contains(&end) {
                    kept.push(end);
                }
            }
            if kept.is_empty() {
                kept.push(0.5 * (from + to));
            }
            kept.sort_by(f64::total_cmp);
            let at = |curve: &Piece| {
                kept.iter()
                    .map(|&state| curve.mean_at(state))
                    .collect::<Vec<f64>>()
            };
            Values::Force {
                mean_n: at(&mean),
                sigma_n: if sigma_n.len() == 1 {
                    sigma_n.clone()
                } else {
                    at(&sigma)
                },
                position: kept,
            }
        }
    };
    Some(Segment {
        from,
        to,
        values,
        ..segment.clone()
    })
}
