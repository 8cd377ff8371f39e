//! Transposed copies of weights.

use pubs_core::vector::{Arithmetic, LANES, dispatched};

use super::matrix::padded;

/// Lines of a square block, each in a cache line of its own.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Block([[f32; LANES]; LANES]);

dispatched! {
    /// transposed[c][r] = matrix[r][c]. `columns` is a multiple of [`LANES`]; the rows of the
    /// result are `padded(rows)` long, zero beyond `rows`.
    pub(crate) fn transpose(rows: usize, columns: usize, matrix: &[f32], transposed: &mut [f32]) = transpose_body
}

#[inline(always)]
#[allow(
    clippy::extra_unused_type_parameters,
    reason = "every body that is dispatched takes the unit's arithmetic; this one needs none"
)]
fn transpose_body<A: Arithmetic>(
    rows: usize,
    columns: usize,
    matrix: &[f32],
    transposed: &mut [f32],
) {
    let stride = padded(rows);
    let mut block = Block([[0.0; LANES]; LANES]);
    let mut other = block;
    for row in (0..rows).step_by(LANES) {
        let height = LANES.min(rows - row);
        for column in (0..columns).step_by(LANES) {
            block.0[height..].fill([0.0; LANES]);
            let lines = matrix[row * columns + column..].chunks(columns);
            for (line, to) in lines.zip(&mut block.0[..height]) {
                to.copy_from_slice(&line[..LANES]);
            }
            // Interleaving row i with row i + 8 rotates the bits of an element's index by one;
            // four times swaps the bits of row and column.
            interleave(&block, &mut other);
            interleave(&other, &mut block);
            interleave(&block, &mut other);
            interleave(&other, &mut block);
            let lines = transposed[column * stride + row..].chunks_mut(stride);
            for (from, line) in block.0.iter().zip(lines) {
                line[..LANES].copy_from_slice(from);
            }
        }
    }
}

#[inline(always)]
fn interleave(from: &Block, to: &mut Block) {
    const HALF: usize = LANES / 2;
    for i in 0..HALF {
        for lane in 0..HALF {
            to.0[2 * i][2 * lane] = from.0[i][lane];
            to.0[2 * i][2 * lane + 1] = from.0[i + HALF][lane];
            to.0[2 * i + 1][2 * lane] = from.0[i][lane + HALF];
            to.0[2 * i + 1][2 * lane + 1] = from.0[i + HALF][lane + HALF];
        }
    }
}
