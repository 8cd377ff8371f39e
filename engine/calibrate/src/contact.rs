//! Where a limit is: the place at which the tool begins to press, not where it ends pressing.
//!
//! At a stop the grasp gives, and the force rises in proportion to the tool's way until safe mode
//! stops at F_t. The line through that rise, continued to zero force, is where the handle rests at
//! its limit with nothing pressing it. Without this, the zero would be off by F_t over the
//! stiffness of grasp and stop: at 15 N and 3.3 N/mm by 4.5 mm.

/// Share of the threshold from which on the force counts as rising.
const RISE_FROM: f64 = 0.3;

/// And up to which: close to the threshold the arm slows down.
const RISE_TO: f64 = 0.95;

/// A line needs this many readings; with fewer the stiffness must be known.
const FEWEST: usize = 3;

/// The displacement at which pressing begins, from readings `(displacement, force along the
/// motion)` of one approach in the order of time (rad or m, N). `stiffness_n` is the force per unit
/// of displacement that is assumed where the rise has too few readings. `None` where the approach
/// never pressed with `RISE_TO` of the threshold.
pub(crate) fn rest_displacement(
    approach: &[(f64, f64)],
    sign: f64,
    threshold_n: f64,
    stiffness_n: f64,
) -> Option<f64> {
    let top = approach
        .iter()
        .position(|&(_, force)| force >= RISE_TO * threshold_n)?;
    let foot = approach[..top]
        .iter()
        .rposition(|&(_, force)| force < RISE_FROM * threshold_n)
        .map_or(0, |below| below + 1);
    let (pressed, force) = approach[top];
    let assumed = pressed - sign * force / stiffness_n;
    let rise = &approach[foot..=top];
    if rise.len() < FEWEST {
        return Some(assumed);
    }
    let count = rise.len() as f64;
    let mean_x = rise.iter().map(|&(x, _)| x).sum::<f64>() / count;
    let mean_f = rise.iter().map(|&(_, f)| f).sum::<f64>() / count;
    let along = rise
        .iter()
        .map(|&(x, f)| (x - mean_x) * (f - mean_f))
        .sum::<f64>();
    let spread = rise.iter().map(|&(x, _)| (x - mean_x).powi(2)).sum::<f64>();
    let slope = sign * along / spread;
    // A rise much softer than the file's stiffness is a spring before the stop, not the stop.
    if !(slope.is_finite() && slope > 0.25 * stiffness_n) {
        return Some(assumed);
    }
    Some(mean_x - sign * mean_f / slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Free motion with 2 N to 0.1, then a stop of 3000 N per unit from 0.1 on.
    fn approach(sign: f64, step: f64) -> Vec<(f64, f64)> {
        let points = (0..=((0.1049 / step) as usize)).map(|index| index as f64 * step);
        let force = |x: f64| {
            if x < 0.1 {
                2.0
            } else {
                ((x - 0.1) * 3000.0).max(2.0)
            }
        };
        points.map(|x| (sign * x, force(x))).collect()
    }

    #[test]
    fn the_line_through_the_rise_meets_zero_at_the_limit() {
        for (sign, step) in [(1.0, 0.0005), (-1.0, 0.0005), (1.0, 0.0002)] {
            let points = approach(sign, step);
            let found = rest_displacement(&points, sign, 14.0, 5000.0);
            assert!(
                found.is_some_and(|found| (found - sign * 0.1).abs() < 1e-9),
                "sign {sign}, step {step}: {found:?}"
            );
        }
    }

    #[test]
    fn too_steep_a_rise_takes_the_known_stiffness_and_no_rise_is_no_contact() {
        let points = [(0.0, 1.0), (0.1, 1.0), (0.103, 15.0)];
        let found = rest_displacement(&points, 1.0, 15.0, 5000.0);
        assert_eq!(found, Some(0.103 - 15.0 / 5000.0));
        assert_eq!(rest_displacement(&points[..2], 1.0, 15.0, 5000.0), None);
    }
}
