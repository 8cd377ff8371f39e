//! Beliefs over the few states that are possible.

/// Probabilities of the possible states, in ascending order of the states.
#[derive(Clone)]
pub(super) struct SparseBelief {
    states: Box<[u32]>,
    weights: Box<[f64]>,
}

impl SparseBelief {
    /// Scales weights in ascending order of states to a belief. Weights that rounding alone could
    /// have left are dropped.
    pub fn scaled(entries: impl Iterator<Item = (u32, f64)>, mass: f64) -> Self {
        let (states, weights): (Vec<u32>, Vec<f64>) = entries
            .map(|(state, weight)| (state, weight / mass))
            .filter(|entry| entry.1 > 1e-14)
            .unzip();
        Self {
            states: states.into_boxed_slice(),
            weights: weights.into_boxed_slice(),
        }
    }

    pub fn states(&self) -> &[u32] {
        &self.states
    }

    pub fn entries(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let weights = self.weights.iter().copied();
        self.states.iter().copied().zip(weights)
    }

    #[inline]
    pub fn dot(&self, vector: &[f64]) -> f64 {
        self.entries()
            .map(|(state, weight)| weight * vector[state as usize])
            .sum()
    }

    /// Shannon's, as a share of its greatest value over `states` states.
    pub fn entropy(&self, states: usize) -> f64 {
        let bits = self.weights.iter().map(|&weight| -weight * weight.ln());
        bits.sum::<f64>() / (states.max(2) as f64).ln()
    }

    /// Equal but for rounding.
    pub fn is_close_to(&self, other: &Self) -> bool {
        let near = |(one, other): (&f64, &f64)| (one - other).abs() < 1e-11;
        self.states == other.states && self.weights.iter().zip(&other.weights).all(near)
    }
}
