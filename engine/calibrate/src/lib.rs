//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

pub mod changepoints;
pub mod drift;
pub mod object_text;
pub mod segment;
pub mod smoothing;
pub mod stored;

pub use segment::{Channel, Segment, Values};
