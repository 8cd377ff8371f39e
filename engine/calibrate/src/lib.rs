//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.

pub mod calibration;
mod changepoints;
mod contact;
mod curve;
pub mod fit;
mod grid;
mod motion;
pub mod object_text;
pub mod pulls;
pub mod record;
pub mod segment;
mod segment_model;
mod smoothing;
pub mod spread;
pub mod survey;
pub mod traces;

pub use segment::{Channel, Segment, Values};
