//! Vector units and the few elementary functions that are computed many at a time.
//!
//! Kernels are plain loops, generic over [`Arithmetic`], that [`dispatched!`] compiles once for
//! each unit; which one runs is chosen by a [`VectorUnit`] value. On one unit a result is the same
//! on every machine.

mod elementary;
mod unit;

pub use crate::dispatched;
pub use elementary::{exp, ln};
pub use unit::{Arithmetic, Instructions, Portable, VectorUnit};
#[cfg(target_arch = "x86_64")]
pub use unit::{Avx2, Avx512};

/// Numbers handled at once: one AVX-512 register.
pub const LANES: usize = 16;

/// A group of neighbouring numbers.
pub type Lanes = [f32; LANES];
