//! The activation function and its derivative.

use pubs_core::vector::{Arithmetic, LANES, dispatched};

/// tanh x is within 1e-7 of ±1 from here on.
const SATURATED: f32 = 8.4;

/// tanh x ≈ x · P(x²) / Q(x²), a minimax fit of the relative error (1.1e-8) on [0, 8.4];
/// highest power first.
const P: [f32; 5] = [
    1.445_848_5e-8,
    2.138_025e-5,
    3.541_647_5e-3,
    0.134_196_05,
    1.0,
];
const Q: [f32; 5] = [
    8.220_226e-7,
    3.361_475_6e-4,
    2.605_155_5e-2,
    0.467_529_3,
    1.0,
];

/// tanh x, relative error below 4e-7; NaN stays NaN.
#[inline(always)]
pub(crate) fn tanh<A: Arithmetic>(x: f32) -> f32 {
    let x = x.clamp(-SATURATED, SATURATED);
    let t = x * x;
    let (mut p, mut q) = (P[0], Q[0]);
    for power in 1..P.len() {
        p = A::multiply_add(p, t, P[power]);
        q = A::multiply_add(q, t, Q[power]);
    }
    x * p / q
}

/// 1 / (1 + e^−x) = (1 + tanh(x/2)) / 2, absolute error below 2e-7.
#[inline(always)]
pub(crate) fn sigmoid<A: Arithmetic>(x: f32) -> f32 {
    A::multiply_add(0.5, tanh::<A>(0.5 * x), 0.5)
}

dispatched! {
    /// Each value becomes its tanh.
    pub(crate) fn apply_tanh(values: &mut [f32]) = apply_tanh_body
}

#[inline(always)]
fn apply_tanh_body<A: Arithmetic>(values: &mut [f32]) {
    for value in values {
        *value = tanh::<A>(*value);
    }
}

dispatched! {
    /// Takes gradients `[n][width]` back through tanh, whose results `[n][width]` were `outputs`,
    /// and adds their sums over n to `bias_gradients` `[width]`.
    pub(crate) fn backward_tanh(outputs: &[f32], gradients: &mut [f32], bias_gradients: &mut [f32]) = backward_tanh_body
}

#[inline(always)]
fn backward_tanh_body<A: Arithmetic>(
    outputs: &[f32],
    gradients: &mut [f32],
    bias_gradients: &mut [f32],
) {
    let width = bias_gradients.len();
    // Panels so narrow that their sums stay in registers from the first sample to the last.
    const WIDE: usize = 4 * LANES;
    let wide = width - width % WIDE;
    for first in (0..wide).step_by(WIDE) {
        backward_panel::<A, WIDE>(first, outputs, gradients, bias_gradients);
    }
    for first in (wide..width).step_by(LANES) {
        backward_panel::<A, LANES>(first, outputs, gradients, bias_gradients);
    }
}

#[inline(always)]
fn backward_panel<A: Arithmetic, const N: usize>(
    first: usize,
    outputs: &[f32],
    gradients: &mut [f32],
    bias_gradients: &mut [f32],
) {
    let width = bias_gradients.len();
    let mut sums = [0.0; N];
    let rows = outputs
        .chunks_exact(width)
        .zip(gradients.chunks_exact_mut(width));
    for (outputs, gradients) in rows {
        let (outputs, gradients) = (&outputs[first..][..N], &mut gradients[first..][..N]);
        for n in 0..N {
            let slope = A::multiply_add(-outputs[n], outputs[n], 1.0);
            gradients[n] *= slope;
            sums[n] += gradients[n];
        }
    }
    for (gradient, sum) in bias_gradients[first..][..N].iter_mut().zip(sums) {
        *gradient += sum;
    }
}
