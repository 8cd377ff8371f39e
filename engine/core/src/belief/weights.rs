//! Log weights: normalising them, eq. (8), and sums over them, eq. (9) and (10).

use crate::vector::{Arithmetic, LANES, Lanes, dispatched, exp};

/// The least log weight that is kept; e to it is 0 in any precision, and −∞ would make NaN.
pub const LEAST_LOG_WEIGHT: f32 = -1e4;

/// What one pass over the weights gives, with e_i = exp(l_i − max l).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums {
    /// ln Σ exp(l_i): how likely the observation was.
    pub log_total: f64,
    /// Σ w_i y_i of eq. (9).
    pub mean: f64,
    /// −Σ w_i ln w_i of eq. (10), nats.
    pub entropy: f64,
}

#[inline(always)]
fn lanes_of(values: &[f32], padding: f32) -> Lanes {
    let mut lanes = [padding; LANES];
    lanes[..values.len()].copy_from_slice(values);
    lanes
}

#[inline(always)]
fn accumulate<A: Arithmetic>(log_weights: &Lanes, states: &Lanes, max: f32, sums: &mut [Lanes; 3]) {
    for lane in 0..LANES {
        let log = log_weights[lane] - max;
        let weight = exp::<A>(log);
        sums[0][lane] += weight;
        sums[1][lane] = A::multiply_add(weight, states[lane], sums[1][lane]);
        // exp is 0 below −87, where the product with a large log must be 0 as well.
        sums[2][lane] = A::multiply_add(weight, log, sums[2][lane]);
    }
}

#[inline(always)]
fn greatest(values: &[f32]) -> f32 {
    let mut best = [f32::NEG_INFINITY; LANES];
    let (groups, rest) = values.as_chunks::<LANES>();
    for group in groups {
        for lane in 0..LANES {
            best[lane] = best[lane].max(group[lane]);
        }
    }
    let best = best.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    rest.iter().copied().fold(best, f32::max)
}

#[inline(always)]
fn normalise_body<A: Arithmetic>(log_weights: &mut [f32], states: &[f32]) -> Sums {
    let max = greatest(log_weights);
    let mut sums = [[0.0; LANES]; 3];
    let (log_groups, log_rest) = log_weights.as_chunks::<LANES>();
    let (state_groups, state_rest) = states.as_chunks::<LANES>();
    for (log_group, state_group) in log_groups.iter().zip(state_groups) {
        accumulate::<A>(log_group, state_group, max, &mut sums);
    }
    let padding = max + LEAST_LOG_WEIGHT;
    accumulate::<A>(
        &lanes_of(log_rest, padding),
        &lanes_of(state_rest, 0.0),
        max,
        &mut sums,
    );

    let [total, states_total, logs_total] =
        sums.map(|lanes| lanes.iter().map(|&sum| f64::from(sum)).sum::<f64>());
    let log_total = total.ln();
    let shift = max + log_total as f32;
    for log_weight in log_weights.iter_mut() {
        *log_weight = (*log_weight - shift).max(LEAST_LOG_WEIGHT);
    }
    Sums {
        log_total: f64::from(max) + log_total,
        mean: states_total / total,
        entropy: (log_total - logs_total / total).max(0.0),
    }
}

dispatched! {
    /// Normalises log weights in place and sums over them; `states` has the same length. Not a
    /// number comes out as not a number.
    pub fn normalise(log_weights: &mut [f32], states: &[f32]) -> Sums = normalise_body
}

#[inline(always)]
fn entropy_of_gathering_body<A: Arithmetic>(log_weights: &[f32]) -> f32 {
    let mut sums = [[0.0; LANES]; 2];
    let mut add = |logs: &Lanes| {
        for lane in 0..LANES {
            let weight = exp::<A>(logs[lane]);
            sums[0][lane] += weight;
            sums[1][lane] = A::multiply_add(weight, logs[lane], sums[1][lane]);
        }
    };
    let (groups, rest) = log_weights.as_chunks::<LANES>();
    groups.iter().for_each(&mut add);
    add(&lanes_of(rest, LEAST_LOG_WEIGHT));
    let [mass, logs] = sums.map(|lanes| lanes.iter().sum::<f32>());
    if mass > 0.0 {
        mass * mass.ln() - logs
    } else {
        0.0
    }
}

dispatched! {
    /// How much of −Σ w_i ln w_i goes when these particles count as one: W ln W − Σ w_i ln w_i, nats,
    /// with W = Σ w_i. The log weights are those of [`normalise`].
    pub fn entropy_of_gathering(log_weights: &[f32]) -> f32 = entropy_of_gathering_body
}

#[inline(always)]
fn flattened_body<A: Arithmetic>(
    log_weights: &[f32],
    states: &[f32],
    exponent: f32,
    from: f32,
    to: f32,
) -> f32 {
    let max = greatest(log_weights);
    let mut inside = [0.0; LANES];
    let mut total = [0.0; LANES];
    let mut add = |logs: &Lanes, places: &Lanes| {
        for lane in 0..LANES {
            let weight = exp::<A>((logs[lane] - max) * exponent);
            total[lane] += weight;
            inside[lane] += if places[lane] >= from && places[lane] <= to {
                weight
            } else {
                0.0
            };
        }
    };
    let (log_groups, log_rest) = log_weights.as_chunks::<LANES>();
    let (state_groups, state_rest) = states.as_chunks::<LANES>();
    for (logs, places) in log_groups.iter().zip(state_groups) {
        add(logs, places);
    }
    add(
        &lanes_of(log_rest, f32::NEG_INFINITY),
        &lanes_of(state_rest, f32::NAN),
    );
    inside.iter().sum::<f32>() / total.iter().sum::<f32>()
}

dispatched! {
    /// Share of the mass of weights^exponent whose state lies in [from, to].
    pub fn flattened_mass(log_weights: &[f32], states: &[f32], exponent: f32, from: f32, to: f32) -> f32 = flattened_body
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::VectorUnit;

    #[test]
    fn sums_agree_with_a_plain_sum_in_double_precision() {
        for unit in VectorUnit::available() {
            for count in [1, 15, 16, 17, 100, 300] {
                let logs: Vec<f32> = (0..count)
                    .map(|i| -((i * 37 % 101) as f32) * 0.11 + 3.0)
                    .collect();
                let states: Vec<f32> = (0..count).map(|i| (i as f32 * 0.37).sin()).collect();
                let weights: Vec<f64> = logs.iter().map(|&log| f64::from(log).exp()).collect();
                let total: f64 = weights.iter().sum();
                let mean: f64 = weights
                    .iter()
                    .zip(&states)
                    .map(|(w, &y)| w / total * f64::from(y))
                    .sum();
                let entropy: f64 = weights
                    .iter()
                    .map(|w| -(w / total) * (w / total).ln())
                    .sum();

                let mut normalised = logs.clone();
                let found = normalise(unit, &mut normalised, &states);
                for (name, found, expected) in [
                    ("log total", found.log_total, total.ln()),
                    ("mean", found.mean, mean),
                    ("entropy", found.entropy, entropy),
                ] {
                    assert!(
                        (found - expected).abs() < 2e-6,
                        "{unit}, N = {count}: {name} {found}, expected {expected}"
                    );
                }
                let sum: f64 = normalised.iter().map(|&log| f64::from(log).exp()).sum();
                assert!(
                    (sum - 1.0).abs() < 2e-6,
                    "{unit}, N = {count}: weights sum to {sum}"
                );

                let part = count / 2;
                let together: f64 = weights[..part].iter().map(|w| w / total).sum();
                let apart: f64 = weights[..part]
                    .iter()
                    .map(|w| w / total * (w / total).ln())
                    .sum();
                let gathered = if part == 0 {
                    0.0
                } else {
                    together * together.ln() - apart
                };
                let gone = f64::from(entropy_of_gathering(unit, &normalised[..part]));
                assert!(
                    (gone - gathered).abs() < 1e-5,
                    "{unit}, N = {count}: {gone} goes, expected {gathered}"
                );

                let flat: f64 = weights.iter().map(|w| w.powf(0.3)).sum();
                let inside: f64 = weights
                    .iter()
                    .zip(&states)
                    .filter(|&(_, &y)| y >= 0.25)
                    .map(|(w, _)| w.powf(0.3))
                    .sum();
                let mass = f64::from(flattened_mass(
                    unit,
                    &normalised,
                    &states,
                    0.3,
                    0.25,
                    f32::INFINITY,
                ));
                assert!(
                    (mass - inside / flat).abs() < 2e-6,
                    "{unit}, N = {count}: mass {mass}"
                );
            }
        }
    }

    #[test]
    fn one_weight_that_is_not_a_number_makes_every_sum_so() {
        for unit in VectorUnit::available() {
            for place in [0, 20, 36] {
                let mut logs = [0.0; 37];
                logs[place] = f32::NAN;
                let sums = normalise(unit, &mut logs, &[1.0; 37]);
                assert!(sums.log_total.is_nan(), "{unit}, {place}: {sums:?}");
                assert!(sums.mean.is_nan(), "{unit}, {place}: {sums:?}");
            }
        }
    }
}
