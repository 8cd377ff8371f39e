//! Transposed copies of weights.

use super::matrix::LANES;
use super::unit::{Arithmetic, dispatched};

type Block = [[f32; LANES]; LANES];

dispatched! {
    /// transposed[c][r] = matrix[r][c]. `columns` is a multiple of [`LANES`]; the rows of the
    /// result are `padded(rows)` long, zero beyond `rows`.
    fn transpose(rows: usize, columns: usize, matrix: &[f32], transposed: &mut [f32]) = transpose_body
}

#[inline(always)]
fn transpose_body<A: Arithmetic>(
    rows: usize,
    columns: usize,
    matrix: &[f32],
    transposed: &mut [f32],
) {
    let stride = super::matrix::padded(rows);
    for row in (0..rows).step_by(LANES) {
        for column in (0..columns).step_by(LANES) {
            let mut block: Block = [[0.0; LANES]; LANES];
            for (r, line) in block.iter_mut().enumerate().take(rows - row) {
                line.copy_from_slice(&matrix[(row + r) * columns + column..][..LANES]);
            }
            // Interleaving row i with row i + 8 rotates the bits of an element's index by one;
            // four times swaps the bits of row and column.
            block = interleave(interleave(interleave(interleave(block))));
            for (c, line) in block.iter().enumerate() {
                transposed[(column + c) * stride + row..][..LANES].copy_from_slice(line);
            }
        }
    }
}

#[inline(always)]
fn interleave(block: Block) -> Block {
    const HALF: usize = LANES / 2;
    let mut result = [[0.0; LANES]; LANES];
    for i in 0..HALF {
        for lane in 0..HALF {
            result[2 * i][2 * lane] = block[i][lane];
            result[2 * i][2 * lane + 1] = block[i + HALF][lane];
            result[2 * i + 1][2 * lane] = block[i][lane + HALF];
            result[2 * i + 1][2 * lane + 1] = block[i + HALF][lane + HALF];
        }
    }
    result
}
