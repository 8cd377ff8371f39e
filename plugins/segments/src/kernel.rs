//! The loops of `moments` and `moments_grid`, compiled for each vector unit.
//!
//! No unit fuses a multiplication with an addition, so all of them give the same bits.

use crate::channel::{self, MOTION};
use crate::lattice::Lattice;
use crate::nodes::{LANES, Nodes, Row, UNREAD_LANE};

/// A set of vector instructions that the loops exist for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorUnit {
    /// What every processor of the architecture has.
    Portable,
    /// AVX2.
    Avx2,
    /// AVX-512 F, VL, DQ and BW.
    Avx512,
}

impl VectorUnit {
    /// All units, the plainest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// Whether this processor has the unit.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The widest unit of this processor.
    #[must_use]
    pub fn best() -> Self {
        Self::ALL
            .into_iter()
            .rev()
            .find(|unit| unit.is_available())
            .unwrap_or(Self::Portable)
    }
}

/// Where one call's answers go: mean and sigma, both `[C][N]`.
pub(crate) struct Output<'a> {
    pub(crate) mean: &'a mut [f32],
    pub(crate) sigma: &'a mut [f32],
}

/// First states, before and after the move, of N hypotheses at the particles' spacing.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) before: f32,
    pub(crate) after: f32,
    pub(crate) count: usize,
}

type Scattered = unsafe fn(&Lattice, &Nodes, &[f32], &[f32], Output<'_>) -> bool;
type Gridded = unsafe fn(&Lattice, &Nodes, Grid, Output<'_>);

/// The loops for one vector unit, chosen once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kernel {
    scattered: Scattered,
    gridded: Gridded,
}

impl Kernel {
    /// The loops for `unit`; the portable ones where the processor lacks it.
    pub(crate) fn new(unit: VectorUnit) -> Self {
        match unit {
            #[cfg(target_arch = "x86_64")]
            VectorUnit::Avx512 if unit.is_available() => Self {
                scattered: scattered_avx512,
                gridded: gridded_avx512,
            },
            #[cfg(target_arch = "x86_64")]
            VectorUnit::Avx2 if unit.is_available() => Self {
                scattered: scattered_avx2,
                gridded: gridded_avx2,
            },
            _ => Self {
                scattered: scattered_portable,
                gridded: gridded_portable,
            },
        }
    }

    /// Looks up each state; lengths agree, N at least 1. False where a state is NaN.
    pub(crate) fn scattered(
        &self,
        lattice: &Lattice,
        nodes: &Nodes,
        before: &[f32],
        after: &[f32],
        output: Output<'_>,
    ) -> bool {
        // SAFETY: `new` takes a function only where the processor has the instructions it uses.
        unsafe { (self.scattered)(lattice, nodes, before, after, output) }
    }

    /// Serves hypotheses at the particles' spacing; lengths agree, N at least 1, no NaN.
    pub(crate) fn gridded(&self, lattice: &Lattice, nodes: &Nodes, grid: Grid, output: Output<'_>) {
        // SAFETY: as in `scattered`.
        unsafe { (self.gridded)(lattice, nodes, grid, output) }
    }
}

macro_rules! for_unit {
    ($scattered:ident, $gridded:ident $(, $features:literal)?) => {
        $(#[target_feature(enable = $features)])?
        fn $scattered(lattice: &Lattice, nodes: &Nodes, before: &[f32], after: &[f32], output: Output<'_>) -> bool {
            scattered(lattice, nodes, before, after, output)
        }

        $(#[target_feature(enable = $features)])?
        fn $gridded(lattice: &Lattice, nodes: &Nodes, grid: Grid, output: Output<'_>) {
            gridded(lattice, nodes, grid, output);
        }
    };
}

for_unit!(scattered_portable, gridded_portable);
#[cfg(target_arch = "x86_64")]
for_unit!(scattered_avx2, gridded_avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
for_unit!(
    scattered_avx512,
    gridded_avx512,
    "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma"
);

/// Hypotheses that go through [`scattered`] together: one vector per lane.
const BLOCK: usize = 8;

#[inline(always)]
fn scattered(
    lattice: &Lattice,
    nodes: &Nodes,
    before: &[f32],
    after: &[f32],
    output: Output<'_>,
) -> bool {
    let Output { mean, sigma } = output;
    let count = after.len();
    let mut all_numbers = true;
    let blocks = count / BLOCK * BLOCK;
    for start in (0..blocks).step_by(BLOCK) {
        let states = |list: &[f32]| -> [f32; BLOCK] { std::array::from_fn(|i| list[start + i]) };
        let (before, after) = (states(before), states(after));
        all_numbers &=
            !(0..BLOCK).fold(false, |nan, i| nan | before[i].is_nan() | after[i].is_nan());
        let block = look_up_block(lattice, &nodes.rows, before, after);
        for c in 0..channel::COUNT {
            mean[c * count + start..][..BLOCK].copy_from_slice(&block[c]);
            sigma[c * count + start..][..BLOCK].copy_from_slice(&block[channel::COUNT + c]);
        }
    }
    for i in blocks..count {
        all_numbers &= !(before[i].is_nan() | after[i].is_nan());
        let row = look_up(lattice, &nodes.rows, before[i], after[i]);
        for c in 0..channel::COUNT {
            mean[c * count + i] = row[c];
            sigma[c * count + i] = row[channel::COUNT + c];
        }
    }
    all_numbers
}

/// [`BLOCK`] look-ups, transposed: lane by lane.
#[inline(always)]
fn look_up_block(
    lattice: &Lattice,
    rows: &[Row],
    before: [f32; BLOCK],
    after: [f32; BLOCK],
) -> [[f32; BLOCK]; LANES] {
    let looked_up: [Row; BLOCK] =
        std::array::from_fn(|i| look_up(lattice, rows, before[i], after[i]));
    std::array::from_fn(|lane| std::array::from_fn(|i| looked_up[i][lane]))
}

/// Forces at the state after the move, m_p at the one before it.
#[inline(always)]
fn look_up(lattice: &Lattice, rows: &[Row], before: f32, after: f32) -> Row {
    let (node, fraction) = lattice.locate(after);
    let pair = &rows[node as usize..][..2];
    let mut row: Row = std::array::from_fn(|lane| between(pair[0][lane], pair[1][lane], fraction));
    let (node, fraction) = lattice.locate(before);
    let pair = &rows[node as usize..][..2];
    row[MOTION] = between(pair[0][MOTION], pair[1][MOTION], fraction);
    row
}

#[inline(always)]
fn gridded(lattice: &Lattice, nodes: &Nodes, grid: Grid, output: Output<'_>) {
    let Output { mean, sigma } = output;
    let count = grid.count;
    let before = lattice.span(grid.before, count);
    let after = lattice.span(grid.after, count);
    let lanes = mean
        .chunks_exact_mut(count)
        .chain(sigma.chunks_exact_mut(count));
    for (lane, out) in lanes.enumerate() {
        if lane == UNREAD_LANE {
            out.fill(nodes.rows[0][lane]);
            continue;
        }
        let span = if lane == MOTION { before } else { after };
        let (left, rest) = out.split_at_mut(span.left);
        let (inside, right) = rest.split_at_mut(span.inside);
        left.fill(nodes.rows[0][lane]);
        right.fill(nodes.rows[lattice.last][lane]);
        if span.inside > 0 {
            let low = nodes.every_mth(lane, span.node, span.inside);
            let high = nodes.every_mth(lane, span.node + 1, span.inside);
            for ((out, &low), &high) in inside.iter_mut().zip(low).zip(high) {
                *out = between(low, high, span.fraction);
            }
        }
    }
}

#[inline(always)]
fn between(low: f32, high: f32, fraction: f32) -> f32 {
    low + fraction * (high - low)
}
