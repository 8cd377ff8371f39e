//! The arithmetic that takes the time: plain loops, compiled once for each vector unit.

pub(crate) mod buffer;
pub(crate) mod column;
pub(crate) mod gates;
pub(crate) mod matrix;
pub(crate) mod sum;
pub(crate) mod tanh;
pub(crate) mod tile;
pub(crate) mod transpose;
