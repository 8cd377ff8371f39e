//! Normalising the advantages of a minibatch.

use crate::rollout::Rollout;

/// Keeps the division by a spread of 0 finite, as stable-baselines3 has it.
const DEVIATION_FLOOR: f32 = 1e-8;

/// Brings numbers to mean 0 and standard deviation 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Normal {
    mean: f32,
    factor: f32,
}

impl Normal {
    /// Of the advantages of these samples.
    pub(crate) fn of_samples(rollout: &Rollout, samples: &[u32]) -> Self {
        Self::of(samples.iter().map(|&i| rollout.advantages[i as usize]))
    }

    /// A single number has no spread and stays as it is.
    fn of(numbers: impl ExactSizeIterator<Item = f32> + Clone) -> Self {
        let count = numbers.len() as f32;
        if count < 2.0 {
            return Self {
                mean: 0.0,
                factor: 1.0,
            };
        }
        let mean = numbers.clone().sum::<f32>() / count;
        let variance = numbers.map(|x| (x - mean) * (x - mean)).sum::<f32>() / (count - 1.0);
        Self {
            mean,
            factor: 1.0 / (variance.sqrt() + DEVIATION_FLOOR),
        }
    }

    pub(crate) fn apply(self, number: f32) -> f32 {
        (number - self.mean) * self.factor
    }
}
