//! Boundaries at their likeliest sample.

/// Each boundary where two normal distributions, one for each side, fit the samples between its
/// neighbours best: the split that minimises n₁ ln σ₁ + n₂ ln σ₂. No side is shorter than
/// `shortest`. Samples are drawn in by asinh, or the best place to part a region would be at an
/// outlier.
pub(super) fn refined(signal: &[f64], mut changes: Vec<usize>, shortest: usize) -> Vec<usize> {
    let sums = Sums::of(signal);
    for boundary in 0..changes.len() {
        let from = if boundary == 0 {
            0
        } else {
            changes[boundary - 1]
        };
        let to = changes.get(boundary + 1).copied().unwrap_or(signal.len());
        let cost = |split: usize| sums.cost(from, split) + sums.cost(split, to);
        let splits = from + shortest..=to - shortest;
        let best = splits.min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        changes[boundary] = best.unwrap_or(changes[boundary]);
    }
    changes
}

/// A variance is never taken as smaller (the whole signal's is about 1).
const SMALLEST_VARIANCE: f64 = 1e-6;

/// Sums of the first samples, and of their squares.
struct Sums(Vec<(f64, f64)>);

impl Sums {
    fn of(signal: &[f64]) -> Self {
        let mut sums = vec![(0.0, 0.0)];
        let (mut sum, mut squares) = (0.0, 0.0);
        for x in signal {
            let x = x.asinh();
            sum += x;
            squares += x * x;
            sums.push((sum, squares));
        }
        Self(sums)
    }

    /// n ln σ of the samples `from..to`.
    fn cost(&self, from: usize, to: usize) -> f64 {
        let count = (to - from) as f64;
        let sum = self.0[to].0 - self.0[from].0;
        let squares = self.0[to].1 - self.0[from].1;
        let variance = squares / count - (sum / count).powi(2);
        0.5 * count * variance.max(SMALLEST_VARIANCE).ln()
    }
}
