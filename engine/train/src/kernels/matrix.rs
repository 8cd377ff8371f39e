//! Dense matrix products of the sizes a small network needs.
//!
//! Every product has the form C[m][n] (+)= Σ_k A(m, k) · B[k][n], vectorised along n, with A read
//! one number at a time: so A may as well be transposed, and no operand is ever packed.

use pubs_core::vector::{Arithmetic, LANES, dispatched};

use super::tile::{Tile, Tiled};

/// `width` rounded up to a whole number of vectors, as rows of parameters and activations are.
pub(crate) fn padded(width: usize) -> usize {
    width.next_multiple_of(LANES)
}

/// The left operand.
#[derive(Clone, Copy)]
pub(crate) enum Left<'a> {
    /// A(m, k) = values[m · stride + k].
    Rows {
        /// The numbers.
        values: &'a [f32],
        /// From one m to the next.
        stride: usize,
    },
    /// A(m, k) = values[k · stride + m].
    Columns {
        /// The numbers.
        values: &'a [f32],
        /// From one k to the next.
        stride: usize,
    },
}

/// What the sums start from.
#[derive(Clone, Copy)]
pub(crate) enum Start<'a> {
    /// From 0.
    Zero,
    /// From one row for all m, `[n]`.
    Row(&'a [f32]),
    /// From what C holds.
    Sum,
}

/// Sizes of a product; `columns` is a multiple of [`LANES`] and the stride of B and C.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    /// Number of m.
    pub(crate) rows: usize,
    /// Number of k.
    pub(crate) depth: usize,
    /// Number of n.
    pub(crate) columns: usize,
}

dispatched! {
    /// C[m][n] = start + Σ_k A(m, k) · B[k][n].
    pub(crate) fn multiply(shape: Shape, left: Left<'_>, right: &[f32], start: Start<'_>, product: &mut [f32]) = multiply_body
}

#[inline(always)]
fn multiply_body<A: Tiled>(
    shape: Shape,
    left: Left<'_>,
    right: &[f32],
    start: Start<'_>,
    product: &mut [f32],
) {
    debug_assert!(shape.columns.is_multiple_of(LANES));
    let mut column = 0;
    while column < shape.columns {
        let remaining = shape.columns - column;
        let at = Panel { shape, column };
        column += match A::TILE {
            #[cfg(target_arch = "x86_64")]
            Tile::Large if remaining >= 64 => panel::<A, 4, 64>(at, left, right, start, product),
            #[cfg(target_arch = "x86_64")]
            Tile::Large if remaining >= 32 => panel::<A, 8, 32>(at, left, right, start, product),
            #[cfg(target_arch = "x86_64")]
            Tile::Large => panel::<A, 8, 16>(at, left, right, start, product),
            #[cfg(target_arch = "x86_64")]
            Tile::Medium => panel::<A, 4, 16>(at, left, right, start, product),
            Tile::Small => panel::<A, 4, 8>(at, left, right, start, product),
        };
    }
}

/// Some columns of a product.
#[derive(Clone, Copy)]
struct Panel {
    shape: Shape,
    /// The first.
    column: usize,
}

/// Does N columns, M rows at a time, and returns N.
#[inline(always)]
fn panel<A: Arithmetic, const M: usize, const N: usize>(
    at: Panel,
    left: Left<'_>,
    right: &[f32],
    start: Start<'_>,
    product: &mut [f32],
) -> usize {
    let rows = at.shape.rows;
    let whole = rows - rows % M;
    for row in (0..whole).step_by(M) {
        tile::<A, M, N>(at, row, left, right, start, product);
    }
    for row in whole..rows {
        tile::<A, 1, N>(at, row, left, right, start, product);
    }
    N
}

/// M × N sums held in registers.
#[inline(always)]
fn tile<A: Arithmetic, const M: usize, const N: usize>(
    at: Panel,
    row: usize,
    left: Left<'_>,
    right: &[f32],
    start: Start<'_>,
    product: &mut [f32],
) {
    let Shape { depth, columns, .. } = at.shape;
    let mut sums = [[0.0; N]; M];
    for (m, sum) in sums.iter_mut().enumerate() {
        match start {
            Start::Zero => {}
            Start::Row(values) => sum.copy_from_slice(&values[at.column..][..N]),
            Start::Sum => sum.copy_from_slice(&product[(row + m) * columns + at.column..][..N]),
        }
    }
    match left {
        Left::Rows { values, stride } => {
            let rows: [&[f32]; M] = std::array::from_fn(|m| &values[(row + m) * stride..][..depth]);
            for k in 0..depth {
                let right = &right[k * columns + at.column..][..N];
                add_products::<A, M, N>(|m| rows[m][k], right, &mut sums);
            }
        }
        Left::Columns { values, stride } => {
            for k in 0..depth {
                let right = &right[k * columns + at.column..][..N];
                let factors = &values[k * stride + row..][..M];
                add_products::<A, M, N>(|m| factors[m], right, &mut sums);
            }
        }
    }
    for (m, sum) in sums.iter().enumerate() {
        product[(row + m) * columns + at.column..][..N].copy_from_slice(sum);
    }
}

/// sums[m][n] += left(m) · right[n], right being N long.
#[inline(always)]
fn add_products<A: Arithmetic, const M: usize, const N: usize>(
    left: impl Fn(usize) -> f32,
    right: &[f32],
    sums: &mut [[f32; N]; M],
) {
    for (m, sum) in sums.iter_mut().enumerate() {
        let factor = left(m);
        for n in 0..N {
            sum[n] = A::multiply_add(factor, right[n], sum[n]);
        }
    }
}
