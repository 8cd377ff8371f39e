//! Sums over all parameters.

use pubs_core::vector::{Arithmetic, dispatched};

/// Partial sums, enough to hide the latency of an addition on every unit.
const PARTS: usize = 64;

dispatched! {
    /// Σ values².
    pub(crate) fn sum_of_squares(values: &[f32], sum: &mut f32) = sum_of_squares_body
}

#[inline(always)]
fn sum_of_squares_body<A: Arithmetic>(values: &[f32], sum: &mut f32) {
    let mut parts = [0.0; PARTS];
    let (chunks, rest) = values.as_chunks::<PARTS>();
    for chunk in chunks {
        for (part, value) in parts.iter_mut().zip(chunk) {
            *part = A::multiply_add(*value, *value, *part);
        }
    }
    *sum = parts.iter().sum::<f32>() + rest.iter().map(|value| value * value).sum::<f32>();
}
