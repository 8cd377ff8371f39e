//! How observations are scaled before the network sees them.

/// x' = (x − offset) · scale, input by input. Part of the policy: an exported graph does the same.
#[derive(Debug, Clone, PartialEq)]
pub struct InputScaling {
    /// Taken off first, in the input's own unit.
    pub offset: Vec<f32>,
    /// Multiplied then, per the input's own unit.
    pub scale: Vec<f32>,
}

impl InputScaling {
    /// Leaves `features` inputs as they are.
    #[must_use]
    pub fn identity(features: usize) -> Self {
        Self {
            offset: vec![0.0; features],
            scale: vec![1.0; features],
        }
    }

    /// Scales observations `[n][features]`.
    pub(crate) fn apply(&self, features: &[f32], scaled: &mut [f32]) {
        let width = self.offset.len();
        for (from, to) in features
            .chunks_exact(width)
            .zip(scaled.chunks_exact_mut(width))
        {
            for i in 0..width {
                to[i] = (from[i] - self.offset[i]) * self.scale[i];
            }
        }
    }
}
