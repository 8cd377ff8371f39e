//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

pub mod calibration;
mod changepoints;
mod column;
mod contact;
pub mod csv;
mod curve;
mod fault;
pub mod faults;
pub mod fit;
mod grid;
mod motion;
pub mod object_text;
pub mod pulls;
pub mod record;
pub mod segment;
mod segment_model;
mod smoothing;
mod source;
pub mod spread;
pub mod survey;
mod table;
pub mod traces;

pub use fault::{Fault, Place, Refused};
pub use segment::{Channel, Segment, Values};
pub use source::Source;
