//! Loops for every processor, and the arithmetic that all units share.

use crate::channel::{self, MOTION};
use crate::kernel::{Output, States};
use crate::lattice::Lattice;
use crate::nodes::{LANES, Nodes, Row};

/// See [`Kernel::scattered`](super::Kernel::scattered).
pub(super) fn scattered(
    lattice: &Lattice,
    nodes: &Nodes,
    states: States<'_>,
    output: &mut Output<'_>,
) -> bool {
    scattered_from(0, lattice, nodes, states, output)
}

/// The same for the hypotheses from number `start` on.
#[inline(always)]
pub(super) fn scattered_from(
    start: usize,
    lattice: &Lattice,
    nodes: &Nodes,
    states: States<'_>,
    output: &mut Output<'_>,
) -> bool {
    let count = states.after.len();
    let pairs = states.before.iter().zip(states.after);
    let mut any_nan = false;
    for (i, (&before, &after)) in pairs.enumerate().skip(start) {
        any_nan |= before.is_nan() | after.is_nan();
        let mut row = look_up(&nodes.rows, lattice.locate(after));
        row[MOTION] = look_up_motion(&nodes.rows, lattice.locate(before));
        for lane in 0..channel::COUNT {
            output.mean[lane * count + i] = row[lane];
            output.sigma[lane * count + i] = row[channel::COUNT + lane];
        }
    }
    !any_nan
}

#[inline(always)]
fn look_up(rows: &[Row], (node, fraction): (u32, f32)) -> Row {
    let pair = &rows[node as usize..][..2];
    let mut row = [0.0; LANES];
    for lane in 0..LANES {
        row[lane] = between(pair[0][lane], pair[1][lane], fraction);
    }
    row
}

/// The probability of m_p alone.
#[inline(always)]
pub(super) fn look_up_motion(rows: &[Row], (node, fraction): (u32, f32)) -> f32 {
    let pair = &rows[node as usize..][..2];
    between(pair[0][MOTION], pair[1][MOTION], fraction)
}

/// See [`BetweenEach`](super::BetweenEach).
pub(super) fn between_each(low: &[f32], high: &[f32], fraction: f32, out: &mut [f32]) {
    for ((out, &low), &high) in out.iter_mut().zip(low).zip(high) {
        *out = between(low, high, fraction);
    }
}

#[inline(always)]
pub(super) fn between(low: f32, high: f32, fraction: f32) -> f32 {
    low + fraction * (high - low)
}
