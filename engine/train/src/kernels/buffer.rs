//! Memory that starts at a cache line.

use std::ops::{Deref, DerefMut};

/// Numbers in a cache line; a vector that straddles two lines loads at half the speed.
const LINE: usize = 16;

/// A fixed number of `f32` that begin at a cache line, all zero at first.
#[derive(Debug)]
pub(crate) struct Buffer {
    memory: Vec<f32>,
    start: usize,
    length: usize,
}

impl Buffer {
    pub(crate) fn zeros(length: usize) -> Self {
        let memory = vec![0.0; length + LINE];
        // `align_offset` may refuse; alignment is only a matter of speed.
        let start = memory
            .as_ptr()
            .align_offset(LINE * size_of::<f32>())
            .min(LINE);
        Self {
            memory,
            start,
            length,
        }
    }
}

impl Clone for Buffer {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.length);
        copy.copy_from_slice(self);
        copy
    }
}

impl Deref for Buffer {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.memory[self.start..][..self.length]
    }
}

impl DerefMut for Buffer {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.memory[self.start..][..self.length]
    }
}
