//! How far a curve has moved along the joint.

use super::Sample;
use crate::stored::Stored;

/// Shifts up to this share of the range are tried.
const FARTHEST: f64 = 0.1;

/// On each side.
const STEPS: i32 = 40;

/// Halvings of the step around the best one.
const HALVINGS: i32 = 8;

/// Slopes are taken over this share of the range on each side.
const SLOPE_REACH: f64 = 0.0025;

/// Degrees of freedom of the t distribution that residuals are taken from, so that outliers do
/// not decide.
const FREEDOM: f64 = 4.0;

/// −ln of the likelihood of a standardised residual and its sigma, but for a constant.
pub(super) fn cost(residual: f64, sigma: f64) -> f64 {
    let z = residual / sigma;
    0.5 * (FREEDOM + 1.0) * (z * z / FREEDOM).ln_1p() + sigma.ln()
}

/// Cost of samples under the curve moved by `shift`.
pub(super) fn cost_at<'a>(
    stored: &Stored,
    samples: impl Iterator<Item = &'a Sample>,
    shift: f64,
) -> f64 {
    let each = samples.map(|sample| {
        let (mean, sigma) = stored.moments(sample.state - shift);
        cost(sample.value - mean, sigma)
    });
    each.sum()
}

/// The shift with the least cost, found on a grid that is then made finer around it.
pub(super) fn best(stored: &Stored, samples: &[Sample]) -> f64 {
    let cost = |shift: f64| cost_at(stored, samples.iter(), shift);
    let mut step = FARTHEST * stored.range() / f64::from(STEPS);
    let grid = (-STEPS..=STEPS).map(|i| f64::from(i) * step);
    let mut least = (0.0, cost(0.0));
    let better = |least: (f64, f64), shift: f64| {
        let own = cost(shift);
        if own < least.1 { (shift, own) } else { least }
    };
    least = grid.fold(least, better);
    for _ in 0..HALVINGS {
        step /= 2.0;
        let centre = least.0;
        least = [centre - step, centre + step]
            .into_iter()
            .fold(least, better);
    }
    least.0
}

/// Slope of the mean at a state over the sigma there.
pub(super) fn relative_slope(stored: &Stored, state: f64) -> f64 {
    let reach = SLOPE_REACH * stored.range();
    let (ahead, behind) = (
        stored.moments(state + reach).0,
        stored.moments(state - reach).0,
    );
    (ahead - behind) / (2.0 * reach * stored.moments(state).1)
}
