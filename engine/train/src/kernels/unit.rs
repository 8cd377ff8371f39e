//! Which vector unit the kernels use, chosen when the program runs.

use std::fmt;

/// A vector unit that this machine has. Values can only be had from the functions here, so
/// holding one is the proof that its instructions may be executed.
///
/// Results are the same for a seed on one unit; between units they differ in the last bits,
/// so every output that should be repeatable names its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VectorUnit(pub(crate) Instructions);

/// The instruction sets for which kernels are compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Instructions {
    /// 16 lanes, fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// 8 lanes, fused multiply-add.
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
            let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            if avx2 && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
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
}

impl fmt::Display for VectorUnit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// What differs between the units inside a kernel's source.
pub(crate) trait Arithmetic: Copy {
    /// a · b + c, rounded once where the unit has a fused multiply-add.
    fn multiply_add(a: f32, b: f32, c: f32) -> f32;

    /// Shape of the register tile of the matrix product.
    const TILE: Tile;
}

/// Shapes of the register tile: as many accumulators as the unit's registers hold, and at least
/// the eight that hide the latency of a multiply-add.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tile {
    /// 32 registers of 16 lanes.
    #[cfg(target_arch = "x86_64")]
    Large,
    /// 16 registers of 8 lanes.
    #[cfg(target_arch = "x86_64")]
    Medium,
    /// 16 registers of 4 lanes.
    Small,
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(crate) struct Avx512;
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(crate) struct Avx2;
#[derive(Clone, Copy)]
pub(crate) struct Portable;

#[cfg(target_arch = "x86_64")]
impl Arithmetic for Avx512 {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }

    const TILE: Tile = Tile::Large;
}

#[cfg(target_arch = "x86_64")]
impl Arithmetic for Avx2 {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }

    const TILE: Tile = Tile::Medium;
}

impl Arithmetic for Portable {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a * b + c
    }

    const TILE: Tile = Tile::Small;
}

/// Defines a function that runs a generic kernel body compiled for the given [`VectorUnit`].
///
/// `fn name(unit, arguments…) = body` calls `body::<A>(arguments…)` with `A: Arithmetic`. The
/// body is marked `#[inline(always)]`, so that its loops are vectorised inside a function that
/// has the unit's features.
macro_rules! dispatched {
    ($(#[$attribute:meta])* fn $name:ident ( $($argument:ident : $type:ty),* $(,)? ) = $body:ident) => {
        $(#[$attribute])*
        #[allow(clippy::too_many_arguments)]
        pub(crate) fn $name(unit: $crate::kernels::unit::VectorUnit, $($argument: $type),*) {
            use $crate::kernels::unit::{Instructions, Portable};
            #[cfg(target_arch = "x86_64")]
            use $crate::kernels::unit::{Avx2, Avx512};

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
            fn avx512($($argument: $type),*) {
                $body::<Avx512>($($argument),*);
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($argument: $type),*) {
                $body::<Avx2>($($argument),*);
            }

            match unit.0 {
                // SAFETY: a `VectorUnit` of this kind is only made after the machine was asked
                // for these features.
                #[cfg(target_arch = "x86_64")]
                Instructions::Avx512 => unsafe { avx512($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                Instructions::Avx2 => unsafe { avx2($($argument),*) },
                Instructions::Portable => $body::<Portable>($($argument),*),
            }
        }
    };
}
pub(crate) use dispatched;
