//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

mod column;
pub mod csv;
mod fault;
pub mod faults;
pub mod pulls;
pub mod segment;
mod source;
mod table;

pub use fault::{Fault, Place, Refused};
pub use segment::{Channel, Segment, Values};
pub use source::Source;
