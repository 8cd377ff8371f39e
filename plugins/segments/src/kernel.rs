//! `moments` and `moments_grid` over the tables, with inner loops for each vector unit.
//!
//! No unit fuses a multiplication with an addition, so all of them give the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

use crate::channel::MOTION;
use crate::lattice::{Lattice, Span};
use crate::nodes::{Nodes, UNREAD_LANE};

/// A set of vector instructions that the loops exist for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorUnit {
    /// What every processor of the architecture has.
    Portable,
    /// AVX2. Wider vectors gain nothing: the tables do not fit the first-level cache, and reading
    /// them is what takes the time.
    Avx2,
}

impl VectorUnit {
    /// All units, the plainest first.
    pub const ALL: [Self; 2] = [Self::Portable, Self::Avx2];

    /// Whether this processor has the unit.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
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

/// States of N hypotheses before and after the move; both of length N.
#[derive(Clone, Copy)]
pub(crate) struct States<'a> {
    pub(crate) before: &'a [f32],
    pub(crate) after: &'a [f32],
}

/// First states, before and after the move, of N hypotheses at the particles' spacing.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) before: f32,
    pub(crate) after: f32,
    pub(crate) count: usize,
}

/// Looks up each state; false where one is NaN.
type Scattered = unsafe fn(&Lattice, &Nodes, States<'_>, &mut Output<'_>) -> bool;
/// `out` = `low` + `fraction` · (`high` − `low`), element by element; all of one length.
type BetweenEach = unsafe fn(low: &[f32], high: &[f32], fraction: f32, out: &mut [f32]);

/// The loops for one vector unit, chosen once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kernel {
    scattered: Scattered,
    between_each: BetweenEach,
}

impl Kernel {
    /// The loops for `unit`; the portable ones where the processor lacks it.
    pub(crate) fn new(unit: VectorUnit) -> Self {
        match unit {
            #[cfg(target_arch = "x86_64")]
            VectorUnit::Avx2 if unit.is_available() => Self {
                scattered: avx2::scattered,
                between_each: avx2::between_each,
            },
            _ => Self {
                scattered: portable::scattered,
                between_each: portable::between_each,
            },
        }
    }

    /// Looks up each state; false where one is NaN. The output is `[C][N]`.
    #[inline]
    pub(crate) fn scattered(
        &self,
        lattice: &Lattice,
        nodes: &Nodes,
        states: States<'_>,
        mut output: Output<'_>,
    ) -> bool {
        if states.after.len() < FEW {
            return portable::scattered(lattice, nodes, states, &mut output);
        }
        // SAFETY: `new` takes a function only where the processor has the instructions it uses.
        unsafe { (self.scattered)(lattice, nodes, states, &mut output) }
    }

    /// Serves hypotheses at the particles' spacing, of which there is one at least. The output is
    /// `[C][N]`.
    pub(crate) fn gridded(&self, lattice: &Lattice, nodes: &Nodes, grid: Grid, output: Output<'_>) {
        let Output { mean, sigma } = output;
        let count = grid.count;
        let before = lattice.span(grid.before, count);
        let after = lattice.span(grid.after, count);
        let lists = mean
            .chunks_exact_mut(count)
            .chain(sigma.chunks_exact_mut(count));
        for (lane, list) in lists.enumerate() {
            match lane {
                MOTION => self.grid_lane(nodes, lane, &before, list),
                UNREAD_LANE => list.fill(nodes.first(lane)),
                _ => self.grid_lane(nodes, lane, &after, list),
            }
        }
    }

    fn grid_lane(&self, nodes: &Nodes, lane: usize, span: &Span, out: &mut [f32]) {
        let (left, rest) = out.split_at_mut(span.left);
        let (inside, right) = rest.split_at_mut(span.inside);
        left.fill(nodes.first(lane));
        right.fill(nodes.last(lane));
        if inside.is_empty() {
            return;
        }
        let (low, high) = nodes.around(lane, span);
        // SAFETY: as in `scattered`.
        unsafe { (self.between_each)(low, high, span.fraction, inside) }
    }
}

/// Fewer states than this are not worth a vector.
const FEW: usize = 8;
