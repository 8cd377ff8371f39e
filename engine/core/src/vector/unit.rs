//! Which vector unit the kernels use, chosen when the program runs.

use std::fmt;

/// A vector unit that this machine has. Values can only be had from the functions here, so
/// holding one is the proof that its instructions may be executed.
///
/// Results are the same for a seed on one unit; between units they differ in the last bits,
/// because only some fuse multiply and add, so every output that should be repeatable names its
/// unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VectorUnit(Instructions);

/// The instruction sets for which kernels are compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instructions {
    /// AVX-512 F, BW, DQ and VL: 16 lanes, fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// AVX2 and FMA: 8 lanes, fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// What every machine of the target architecture has; no fused multiply-add.
    Portable,
}

impl VectorUnit {
    /// The fastest unit of this machine.
    #[must_use]
    pub fn best() -> Self {
        Self::available()[0]
    }

    /// All units of this machine, fastest first; the portable one is always there.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut units = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            // The features that `dispatched!` enables, no fewer.
            let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let avx512 = avx2
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl");
            if avx512 {
                units.push(Self(Instructions::Avx512));
            }
            if avx2 {
                units.push(Self(Instructions::Avx2));
            }
        }
        units.push(Self(Instructions::Portable));
        units
    }

    /// The unit with this [`name`](Self::name), if this machine has it.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::available()
            .into_iter()
            .find(|unit| unit.name() == name)
    }

    /// `avx512`, `avx2` or `portable`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => "avx512",
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => "avx2",
            Instructions::Portable => "portable",
        }
    }

    /// The instructions that this unit executes.
    #[must_use]
    pub fn instructions(self) -> Instructions {
        self.0
    }
}

impl fmt::Display for VectorUnit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// What differs between the units inside a kernel's source.
pub trait Arithmetic: Copy {
    /// a · b + c, rounded once where the unit has a fused multiply-add.
    fn multiply_add(a: f32, b: f32, c: f32) -> f32;
}

/// Arithmetic of [`Instructions::Avx512`].
#[cfg(target_arch = "x86_64")]
#[derive(Debug, Clone, Copy)]
pub struct Avx512;

/// Arithmetic of [`Instructions::Avx2`].
#[cfg(target_arch = "x86_64")]
#[derive(Debug, Clone, Copy)]
pub struct Avx2;

/// Arithmetic of [`Instructions::Portable`].
#[derive(Debug, Clone, Copy)]
pub struct Portable;

#[cfg(target_arch = "x86_64")]
impl Arithmetic for Avx512 {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }
}

#[cfg(target_arch = "x86_64")]
impl Arithmetic for Avx2 {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }
}

impl Arithmetic for Portable {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a * b + c
    }
}

/// Defines a function that runs a generic kernel body compiled for the given
/// [`VectorUnit`](crate::vector::VectorUnit).
///
/// `fn name(arguments…) -> Result = body` becomes `fn name(unit, arguments…) -> Result`, which
/// calls `body::<A>(arguments…)` with `A:` [`Arithmetic`](crate::vector::Arithmetic). The body is
/// marked `#[inline(always)]`, so that its loops are vectorised inside a function that has the
/// unit's features.
#[macro_export]
macro_rules! dispatched {
    ($(#[$attribute:meta])* $visible:vis fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? = $body:ident) => {
        $(#[$attribute])*
        #[allow(clippy::too_many_arguments)]
        $visible fn $name(unit: $crate::vector::VectorUnit, $($argument: $kind),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
            fn avx512($($argument: $kind),*) $(-> $result)? {
                $body::<$crate::vector::Avx512>($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($argument: $kind),*) $(-> $result)? {
                $body::<$crate::vector::Avx2>($($argument),*)
            }

            match unit.instructions() {
                // SAFETY: a `VectorUnit` of this kind is only made after the machine was asked
                // for these features.
                #[cfg(target_arch = "x86_64")]
                $crate::vector::Instructions::Avx512 => unsafe { avx512($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                $crate::vector::Instructions::Avx2 => unsafe { avx2($($argument),*) },
                $crate::vector::Instructions::Portable => {
                    $body::<$crate::vector::Portable>($($argument),*)
                }
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_names_that_find_them() {
        for unit in VectorUnit::available() {
            assert_eq!(VectorUnit::by_name(unit.name()), Some(unit));
        }
        assert!(VectorUnit::by_name("portable").is_some());
        assert_eq!(VectorUnit::by_name("abacus"), None);
    }
}
