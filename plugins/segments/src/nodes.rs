//! One action's model, tabulated at the nodes of a lattice.

use crate::channel::{self, MOTION, MOTION_PROBABILITY};
use crate::lattice::{Lattice, Span};
use crate::piecewise::{Piecewise, Segment};

/// Lanes of a [`Row`]: the mean of each channel, then the sigma of each.
pub(crate) const LANES: usize = 2 * channel::COUNT;
/// Lane of sigma of m_p, which nobody reads: 1 everywhere, so it is not interpolated.
pub(crate) const UNREAD_LANE: usize = channel::COUNT + MOTION;

/// All values at one node, side by side: a look-up touches one cache line.
pub(crate) type Row = [f32; LANES];

/// Mean and sigma of an action that stops: the handle does not move, and no force is expected or
/// excluded. Its observations say next to nothing of the state, and the engine never updates on it.
const AT_REST: Row = {
    let mut row = [0.0; LANES];
    row[MOTION] = MOTION_PROBABILITY.0 as f32;
    let mut lane = channel::COUNT;
    while lane < LANES {
        row[lane] = 100.0;
        lane += 1;
    }
    row[UNREAD_LANE] = 1.0;
    row
};

/// The values in two layouts.
#[derive(Debug, Clone)]
pub(crate) struct Nodes {
    /// Row k is node k; one row more than nodes, equal to the last, ends every interpolation.
    pub(crate) rows: Vec<Row>,
    /// For each phase 0 .. m, for each lane but the unread one, a run of `stride` values: entry j of
    /// phase r is node m·j + r, so neighbouring particles are neighbours in memory.
    by_phase: Vec<f32>,
    phases: usize,
    stride: usize,
}

impl Nodes {
    /// Tabulates a movement action; its segments tile the range.
    pub(crate) fn of_movement(lattice: &Lattice, segments: &[Segment], action: usize) -> Self {
        let pieces: [Piecewise<'_>; channel::COUNT] =
            std::array::from_fn(|c| Piecewise::new(segments, action, c));
        Self::new(lattice, |node| {
            let mut row = [0.0; LANES];
            for (c, piece) in pieces.iter().enumerate() {
                let (mean, sigma) = piece.at(lattice.state(node));
                row[c] = mean as f32;
                row[channel::COUNT + c] = sigma as f32;
            }
            row[MOTION] =
                row[MOTION].clamp(MOTION_PROBABILITY.0 as f32, MOTION_PROBABILITY.1 as f32);
            row
        })
    }

    /// The same answer everywhere, for an action that stops.
    pub(crate) fn of_stop(lattice: &Lattice) -> Self {
        Self::new(lattice, |_| AT_REST)
    }

    fn new(lattice: &Lattice, row_at: impl Fn(usize) -> Row) -> Self {
        let mut rows: Vec<Row> = (0..=lattice.last).map(row_at).collect();
        rows.push(rows[lattice.last]);
        let phases = lattice.refinement;
        let stride = rows.len().div_ceil(phases);
        let mut by_phase = vec![0.0; UNREAD_LANE * phases * stride];
        for (i, value) in by_phase.iter_mut().enumerate() {
            let (phase, lane, j) = (
                i / (UNREAD_LANE * stride),
                i / stride % UNREAD_LANE,
                i % stride,
            );
            *value = rows[(phases * j + phase).min(lattice.last)][lane];
        }
        Self {
            rows,
            by_phase,
            phases,
            stride,
        }
    }

    /// Value of `lane` at the lower limit.
    #[inline(always)]
    pub(crate) fn first(&self, lane: usize) -> f32 {
        self.rows[0][lane]
    }

    /// Value of `lane` at the upper limit.
    #[inline(always)]
    pub(crate) fn last(&self, lane: usize) -> f32 {
        self.rows[self.rows.len() - 1][lane]
    }

    /// Values of `lane` at the nodes below and above each hypothesis inside the table.
    #[inline(always)]
    pub(crate) fn around(&self, lane: usize, span: &Span) -> (&[f32], &[f32]) {
        let run = |phase: usize, entry: usize| (phase * UNREAD_LANE + lane) * self.stride + entry;
        let low = run(span.phase, span.entry);
        // The node after the last phase of a particle is the first phase of the next.
        let wraps = span.phase + 1 == self.phases;
        let high = if wraps {
            run(0, span.entry + 1)
        } else {
            run(span.phase + 1, span.entry)
        };
        (
            &self.by_phase[low..][..span.inside],
            &self.by_phase[high..][..span.inside],
        )
    }
}
