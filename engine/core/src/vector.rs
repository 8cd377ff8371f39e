//! Vector units and the few elementary functions that are computed many at a time.
//!
//! Kernels are plain loops over [`Lanes`], compiled once for each unit and chosen at run time.
//! Units differ in the last bit, because only some fuse multiply and add; on one unit a result is
//! the same on every machine.

use std::fmt;
use std::sync::OnceLock;

/// Numbers handled at once: one AVX-512 register.
pub const LANES: usize = 16;

/// A group of neighbouring numbers.
pub type Lanes = [f32; LANES];

/// A set of vector instructions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorUnit {
    /// AVX-512 F, VL, DQ and BW with FMA.
    Avx512,
    /// AVX2 with FMA.
    Avx2,
    /// What every processor of this architecture has.
    Portable,
}

impl VectorUnit {
    /// The widest unit this processor has.
    pub fn detect() -> Self {
        static DETECTED: OnceLock<VectorUnit> = OnceLock::new();
        *DETECTED.get_or_init(|| *Self::available().first().unwrap_or(&Self::Portable))
    }

    /// Every unit this processor has, widest first.
    pub fn available() -> Vec<Self> {
        let mut units = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let wide = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw");
            if wide && is_x86_feature_detected!("fma") {
                units.push(Self::Avx512);
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                units.push(Self::Avx2);
            }
        }
        units.push(Self::Portable);
        units
    }
}

impl fmt::Display for VectorUnit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Portable => "portable",
        })
    }
}

/// Compiles a kernel body for every unit. The body is a function generic over `const FUSED: bool`,
/// which says whether the unit fuses multiply and add.
#[macro_export]
macro_rules! for_each_vector_unit {
    ($(#[$docs:meta])* $visible:vis fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? = $body:ident) => {
        $(#[$docs])*
        $visible fn $name(unit: $crate::vector::VectorUnit, $($argument: $kind),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma")]
                fn avx512($($argument: $kind),*) $(-> $result)? { $body::<true>($($argument),*) }
                #[target_feature(enable = "avx2,fma")]
                fn avx2($($argument: $kind),*) $(-> $result)? { $body::<true>($($argument),*) }
                match unit {
                    // SAFETY: a unit other than `Portable` comes from `VectorUnit::available`,
                    // which found its instructions on this processor.
                    $crate::vector::VectorUnit::Avx512 => return unsafe { avx512($($argument),*) },
                    // SAFETY: as above.
                    $crate::vector::VectorUnit::Avx2 => return unsafe { avx2($($argument),*) },
                    $crate::vector::VectorUnit::Portable => {}
                }
            }
            let _ = unit;
            $body::<false>($($argument),*)
        }
    };
}

/// a·b + c, rounded once where the unit can.
#[inline(always)]
pub fn multiply_add<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Below this e^x counts as 0; f32 could not hold it as a normal number.
const LEAST_EXPONENT: f32 = -87.0;

/// e^x for x ≤ 88, relative error below 2e-7; 0 below −87.
///
/// x = n·ln 2 + r with |r| ≤ ln 2 / 2, and a polynomial of degree 6 in r (the minimax one of
/// Moshier's Cephes library).
#[inline(always)]
pub fn exp<const FUSED: bool>(x: f32) -> f32 {
    // Adding 1.5·2^23 rounds to the nearest whole number and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let clamped = x.max(LEAST_EXPONENT);
    let shifted = multiply_add::<FUSED>(clamped, std::f32::consts::LOG2_E, ROUND);
    let whole = shifted - ROUND;
    let rest = multiply_add::<FUSED>(whole, -0.693_359_4, clamped);
    let rest = multiply_add::<FUSED>(whole, 2.121_944_4e-4, rest);
    let mut series = 1.987_569_1e-4;
    for coefficient in [
        1.398_199_9e-3,
        8.333_452e-3,
        4.166_579_6e-2,
        1.666_666_5e-1,
        0.5,
    ] {
        series = multiply_add::<FUSED>(series, rest, coefficient);
    }
    let fraction = multiply_add::<FUSED>(series * rest, rest, rest) + 1.0;
    let exponent = shifted
        .to_bits()
        .wrapping_sub(ROUND.to_bits())
        .wrapping_add(127)
        << 23;
    if x < LEAST_EXPONENT {
        0.0
    } else {
        fraction * f32::from_bits(exponent)
    }
}

/// ln x for normal x > 0, absolute error below 1e-6 of max(1, |ln x|) (Cephes).
#[inline(always)]
pub fn ln<const FUSED: bool>(x: f32) -> f32 {
    // Split so that the mantissa lies in [√½, √2).
    const ROOT_HALF_BITS: u32 = 0x3f35_04f3;
    let offset = x.to_bits().wrapping_sub(ROOT_HALF_BITS);
    let exponent = ((offset as i32) >> 23) as f32;
    let mantissa = f32::from_bits((offset & 0x007f_ffff).wrapping_add(ROOT_HALF_BITS)) - 1.0;
    let mut series = 7.037_683_6e-2;
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
        series = multiply_add::<FUSED>(series, mantissa, coefficient);
    }
    let square = mantissa * mantissa;
    let correction = multiply_add::<FUSED>(exponent, -2.121_944_4e-4, series * mantissa * square);
    let correction = multiply_add::<FUSED>(square, -0.5, correction);
    multiply_add::<FUSED>(exponent, 0.693_359_4, mantissa + correction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[inline(always)]
    fn map_body<const FUSED: bool>(which: bool, values: &mut [f32]) {
        for value in values {
            *value = if which {
                exp::<FUSED>(*value)
            } else {
                ln::<FUSED>(*value)
            };
        }
    }
    for_each_vector_unit! { fn map(which: bool, values: &mut [f32]) = map_body }

    #[test]
    fn exp_and_ln_agree_with_double_precision_on_every_unit() {
        for unit in VectorUnit::available() {
            let xs: Vec<f32> = (0..200_000).map(|i| -86.9 + i as f32 * 8.5e-4).collect();
            let mut results = xs.clone();
            map(unit, true, &mut results);
            for (&x, &found) in xs.iter().zip(&results) {
                let expected = f64::from(x).exp();
                let error = (f64::from(found) / expected - 1.0).abs();
                assert!(
                    error < 3e-7,
                    "{unit}: exp({x}) = {found}, relative error {error:e}"
                );
            }
            let xs: Vec<f32> = (0..200_000).map(|i| 1e-6 * 1.000_15_f32.powi(i)).collect();
            let mut results = xs.clone();
            map(unit, false, &mut results);
            for (&x, &found) in xs.iter().zip(&results) {
                let expected = f64::from(x).ln();
                let error = (f64::from(found) - expected).abs() / expected.abs().max(1.0);
                assert!(error < 1e-6, "{unit}: ln({x}) = {found}, error {error:e}");
            }
        }
    }

    #[test]
    fn exp_far_below_is_zero() {
        for unit in VectorUnit::available() {
            let mut values = [-88.0, -1e4, f32::NEG_INFINITY, 0.0];
            map(unit, true, &mut values);
            assert_eq!(values, [0.0, 0.0, 0.0, 1.0], "{unit}");
        }
    }
}
