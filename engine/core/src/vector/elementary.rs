//! e^x and ln x in `f32`, without branches or look-ups, so that loops over them become vector
//! code. The polynomials are the minimax ones of Moshier's Cephes library.

use super::Arithmetic;

/// Below this e^x counts as 0; f32 could not hold it as a normal number.
const LEAST_EXPONENT: f32 = -87.0;
/// Above this f32 could not hold e^x.
const GREATEST_EXPONENT: f32 = 88.0;
/// 1.5 · 2²³: adding it rounds a number to an integer and leaves that in the lowest bits.
const ROUND: f32 = 12_582_912.0;
/// ln 2 in two parts; the first has few bits, so that its products with integers are exact.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Bits of √½.
const ROOT_HALF: u32 = 0x3f35_04f3;
const MANTISSA_BITS: u32 = 23;
const MANTISSA: u32 = (1 << MANTISSA_BITS) - 1;
const EXPONENT_BIAS: u32 = 127;

/// e^x, relative error below 2e-7; 0 below −87, e^88 above 88, and NaN stays NaN.
#[inline(always)]
pub fn exp<A: Arithmetic>(x: f32) -> f32 {
    // x = n · ln 2 + r with |r| ≤ ln 2 / 2.
    let within = x.clamp(LEAST_EXPONENT, GREATEST_EXPONENT);
    let rounded = A::multiply_add(within, std::f32::consts::LOG2_E, ROUND);
    let n = rounded - ROUND;
    let r = A::multiply_add(n, -LN_2_LOW, A::multiply_add(n, -LN_2_HIGH, within));
    let mut sum = 1.987_569_1e-4;
    for coefficient in [
        1.398_199_9e-3,
        8.333_452e-3,
        4.166_579_6e-2,
        1.666_666_5e-1,
        0.5,
    ] {
        sum = A::multiply_add(sum, r, coefficient);
    }
    let fraction = A::multiply_add(sum * r, r, r) + 1.0;
    let exponent = rounded.to_bits().wrapping_sub(ROUND.to_bits());
    let power = f32::from_bits(exponent.wrapping_add(EXPONENT_BIAS) << MANTISSA_BITS);
    if x < LEAST_EXPONENT {
        0.0
    } else {
        fraction * power
    }
}

/// ln x of a positive normal number, absolute error below 1.2e-7 · max(1, |ln x|).
#[inline(always)]
pub fn ln<A: Arithmetic>(x: f32) -> f32 {
    // x = 2ⁿ · (1 + m) with 1 + m in [√½, √2).
    let offset = x.to_bits().wrapping_sub(ROOT_HALF);
    let n = (offset.cast_signed() >> MANTISSA_BITS) as f32;
    let m = f32::from_bits((offset & MANTISSA).wrapping_add(ROOT_HALF)) - 1.0;
    let mut sum = 7.037_683_6e-2;
    for coefficient in [
        -1.151_461e-1,
        1.167_699_9e-1,
        -1.242_014_1e-1,
        1.424_932_3e-1,
        -1.666_805_8e-1,
        2.000_071_5e-1,
        -2.499_999_4e-1,
        3.333_333e-1,
    ] {
        sum = A::multiply_add(sum, m, coefficient);
    }
    let square = m * m;
    let correction = A::multiply_add(n, LN_2_LOW, sum * m * square);
    let correction = A::multiply_add(square, -0.5, correction);
    A::multiply_add(n, LN_2_HIGH, m + correction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::{VectorUnit, dispatched};

    dispatched! {
        fn apply_exp(values: &mut [f32]) = apply_exp_body
    }

    #[inline(always)]
    fn apply_exp_body<A: Arithmetic>(values: &mut [f32]) {
        for value in values {
            *value = exp::<A>(*value);
        }
    }

    dispatched! {
        fn apply_ln(values: &mut [f32]) = apply_ln_body
    }

    #[inline(always)]
    fn apply_ln_body<A: Arithmetic>(values: &mut [f32]) {
        for value in values {
            *value = ln::<A>(*value);
        }
    }

    /// Name, kernel, truth, arguments, and the error allowed relative to max(floor, |truth|).
    type Case = (
        &'static str,
        fn(VectorUnit, &mut [f32]),
        fn(f64) -> f64,
        Vec<f32>,
        f64,
        f64,
    );

    #[test]
    fn functions_match_f64_over_a_dense_range() {
        const POINTS: i32 = 200_003;
        let even = |from: f64, to: f64| -> Vec<f32> {
            let step = (to - from) / f64::from(POINTS - 1);
            (0..POINTS)
                .map(|i| (from + step * f64::from(i)) as f32)
                .collect()
        };
        let powers = (0..POINTS).map(|i| 1e-6 * 1.000_15_f32.powi(i)).collect();
        let cases: [Case; 3] = [
            ("exp", apply_exp, f64::exp, even(-86.9, 87.9), 2e-7, 0.0),
            ("ln", apply_ln, f64::ln, even(1e-6, 50.0), 1.2e-7, 1.0),
            ("ln", apply_ln, f64::ln, powers, 1.2e-7, 1.0),
        ];
        for unit in VectorUnit::available() {
            for (name, kernel, truth, arguments, allowed, floor) in &cases {
                let mut values = arguments.clone();
                kernel(unit, &mut values);
                for (argument, value) in arguments.iter().zip(&values) {
                    let expected = truth(f64::from(*argument));
                    let error = (f64::from(*value) - expected).abs();
                    assert!(
                        error <= allowed * expected.abs().max(*floor),
                        "{unit}: {name}({argument}) = {value}, not {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn exp_outside_its_range() {
        for unit in VectorUnit::available() {
            let mut values = [-88.0, -1e4, f32::NEG_INFINITY, 0.0, 1e4, f32::NAN];
            apply_exp(unit, &mut values);
            assert_eq!(values[..4], [0.0, 0.0, 0.0, 1.0], "{unit}");
            let greatest = f64::from(values[4]) / 88.0_f64.exp();
            assert!((greatest - 1.0).abs() < 2e-7, "{unit}: e^1e4 = {values:?}");
            assert!(values[5].is_nan(), "{unit}: e^NaN = {}", values[5]);
        }
    }
}
