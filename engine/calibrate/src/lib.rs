//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

mod contact;
pub mod record;
pub mod segment;

pub use segment::{Channel, Segment, Values};
