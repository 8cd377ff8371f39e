//! First weights: orthogonal, as stable-baselines3 has them.

use std::f64::consts::SQRT_2;

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::{Layer, Network};

/// Fills all weights. The networks of PPO start with gain √2 in hidden layers; a small gain in the
/// last makes the first policy nearly uniform.
pub(super) fn orthogonal(network: &mut Network, output_gain: f64, generator: &mut impl Rng) {
    for layer in network.hidden.clone() {
        let weights = orthonormal(layer.inputs, layer.outputs, generator);
        store(network, &layer, layer.inputs, &weights, SQRT_2);
    }
    let layer = network.output.clone();
    let weights = orthonormal(layer.outputs, layer.inputs, generator);
    store(network, &layer, layer.outputs, &weights, output_gain);
}

/// Writes `rows` rows of weights to where the layer keeps them.
fn store(network: &mut Network, layer: &Layer, rows: usize, weights: &[f64], gain: f64) {
    let stored = network.parameters[layer.weights.clone()].chunks_exact_mut(layer.columns);
    for (stored, weights) in stored.zip(weights.chunks_exact(weights.len() / rows)) {
        for (stored, weight) in stored.iter_mut().zip(weights) {
            *stored = (gain * weight) as f32;
        }
    }
}

/// A random matrix `[rows][columns]` whose rows, or columns if those are fewer, are orthonormal.
fn orthonormal(rows: usize, columns: usize, generator: &mut impl Rng) -> Vec<f64> {
    let (count, length) = (rows.min(columns), rows.max(columns));
    let mut vectors: Vec<Vec<f64>> = Vec::with_capacity(count);
    for _ in 0..count {
        let mut vector: Vec<f64> = (0..length)
            .map(|_| generator.sample(StandardNormal))
            .collect();
        // Gram and Schmidt's method; the second pass removes what rounding left of the first.
        for _ in 0..2 {
            for other in &vectors {
                let along = dot(&vector, other);
                vector
                    .iter_mut()
                    .zip(other)
                    .for_each(|(x, y)| *x -= along * y);
            }
        }
        let norm = dot(&vector, &vector).sqrt();
        vector.iter_mut().for_each(|x| *x /= norm);
        vectors.push(vector);
    }
    let at = |r: usize, c: usize| {
        if rows <= columns {
            vectors[r][c]
        } else {
            vectors[c][r]
        }
    };
    (0..rows * columns)
        .map(|i| at(i / columns, i % columns))
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::stream;

    #[test]
    fn the_shorter_side_is_orthonormal() {
        for (rows, columns) in [(3, 64), (64, 3), (64, 64), (1, 5)] {
            let matrix = orthonormal(rows, columns, &mut stream(1, "test"));
            let (count, length) = (rows.min(columns), rows.max(columns));
            let at = |v: usize, i: usize| match rows <= columns {
                true => matrix[v * columns + i],
                false => matrix[i * columns + v],
            };
            for v in 0..count {
                for w in 0..count {
                    let product: f64 = (0..length).map(|i| at(v, i) * at(w, i)).sum();
                    let expected = if v == w { 1.0 } else { 0.0 };
                    assert!(
                        (product - expected).abs() < 1e-12,
                        "{rows}x{columns}: {v}·{w} = {product}"
                    );
                }
            }
        }
    }
}
