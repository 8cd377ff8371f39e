//! e^x and ln x in `f32`, without branches or look-ups, so that loops over them vectorise.

use super::unit::Arithmetic;

/// 1.5 · 2²³: adding it rounds a number to an integer and leaves that in the lowest bits.
const ROUND: f32 = 12_582_912.0;
/// ln 2 in two parts; the first has few bits, so that its products with integers are exact.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Bits of √½.
const SQRT_HALF: i32 = 0x3f35_04f3;
const MANTISSA_BITS: i32 = 23;

/// e^x, relative error below 2e-7; x is held within [−87, 88].
#[inline(always)]
pub(crate) fn exp<A: Arithmetic>(x: f32) -> f32 {
    let x = x.clamp(-87.0, 88.0);
    let rounded = A::multiply_add(x, std::f32::consts::LOG2_E, ROUND);
    let n = rounded - ROUND;
    let r = A::multiply_add(n, -LN_2_LOW, A::multiply_add(n, -LN_2_HIGH, x));
    // Taylor's series; |r| ≤ ln 2 / 2, so the first term left out is below 6e-9.
    let mut sum = 1.0 / 5040.0;
    for coefficient in [
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = A::multiply_add(sum, r, coefficient);
    }
    let exponent = (rounded.to_bits() as i32).wrapping_sub(ROUND.to_bits() as i32);
    sum * f32::from_bits(((exponent + 127) << MANTISSA_BITS) as u32)
}

/// ln x of a positive normal number, absolute error below 1e-7 · max(1, |ln x|).
#[inline(always)]
pub(crate) fn ln<A: Arithmetic>(x: f32) -> f32 {
    let bits = x.to_bits() as i32;
    let exponent = (bits - SQRT_HALF) >> MANTISSA_BITS;
    let m = f32::from_bits((bits - (exponent << MANTISSA_BITS)) as u32);
    // ln m = 2 artanh s with |s| ≤ 0.172; the first term left out is below 1e-9.
    let s = (m - 1.0) / (m + 1.0);
    let t = s * s;
    let mut sum = 2.0 / 9.0;
    for coefficient in [2.0 / 7.0, 2.0 / 5.0, 2.0 / 3.0, 2.0] {
        sum = A::multiply_add(sum, t, coefficient);
    }
    let n = exponent as f32;
    A::multiply_add(n, LN_2_HIGH, A::multiply_add(n, LN_2_LOW, s * sum))
}
