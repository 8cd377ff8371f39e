//! One number for each sample of a block.

/// Samples that go through the networks together; their activations stay in the nearest caches.
pub(crate) const BLOCK: usize = 64;

/// One number for each sample of a block. Where a block holds fewer samples, the rest are finite
/// numbers that nobody reads.
pub(crate) type Column = [f32; BLOCK];
