//! Shapes of the register tile of the matrix product.

use pubs_core::vector::{Arithmetic, Portable};
#[cfg(target_arch = "x86_64")]
use pubs_core::vector::{Avx2, Avx512};

/// As many accumulators as the unit's registers hold, and at least the eight that hide the
/// latency of a multiply-add.
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

/// Arithmetic with the tile that suits its registers.
pub(crate) trait Tiled: Arithmetic {
    /// Shape of the tile.
    const TILE: Tile;
}

#[cfg(target_arch = "x86_64")]
impl Tiled for Avx512 {
    const TILE: Tile = Tile::Large;
}

#[cfg(target_arch = "x86_64")]
impl Tiled for Avx2 {
    const TILE: Tile = Tile::Medium;
}

impl Tiled for Portable {
    const TILE: Tile = Tile::Small;
}
