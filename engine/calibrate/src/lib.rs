//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

mod changepoints;
mod contact;
mod curve;
pub mod fit;
mod grid;
mod motion;
pub mod record;
pub mod segment;
mod smoothing;
pub mod traces;

pub use segment::{Channel, Segment, Values};
