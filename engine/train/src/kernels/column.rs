//! One number for each sample of a block.

/// Samples that go through the networks together; their activations stay in the nearest caches.
pub(crate) const BLOCK: usize = 64;

/// One number for each sample of a block. Where a block holds fewer samples, the rest are finite
/// numbers that nobody reads.
pub(crate) type Column = [f32; BLOCK];

/// Writes columns as rows `[sample][column]`, as many samples as there is room for.
pub(crate) fn to_rows(columns: &[Column], rows: &mut [f32]) {
    for (sample, row) in rows.chunks_exact_mut(columns.len()).enumerate() {
        for (number, column) in row.iter_mut().zip(columns) {
            *number = column[sample];
        }
    }
}
