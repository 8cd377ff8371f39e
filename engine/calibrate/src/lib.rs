//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

pub mod plot;
pub mod segment;

pub use segment::{Channel, Segment, Values};
