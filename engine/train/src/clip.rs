//! Clipping the length of a gradient.

use pubs_core::vector::VectorUnit;

use crate::kernels::sum::sum_of_squares;

/// Keeps the division by a length of 0 finite, as PyTorch has it.
const NORM_FLOOR: f32 = 1e-6;

/// The factor that makes a gradient, given in parts, no longer than `longest`; an error is the
/// length of one that is not finite.
pub(crate) fn clip_factor(unit: VectorUnit, parts: &[&[f32]], longest: f32) -> Result<f32, f32> {
    let square = |part: &&[f32]| {
        let mut sum = 0.0;
        sum_of_squares(unit, part, &mut sum);
        sum
    };
    let norm = parts.iter().map(square).sum::<f32>().sqrt();
    if norm.is_finite() {
        Ok((longest / (norm + NORM_FLOOR)).min(1.0))
    } else {
        Err(norm)
    }
}
