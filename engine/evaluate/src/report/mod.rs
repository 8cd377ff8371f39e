//! One page on a run, on a training or on an evaluation: figures first, then their numbers, then
//! where they come from. `pubs_draw` draws and writes it; the page of a calibration is the business
//! of the crate that calibrates.

pub mod evaluation;
pub mod run;
mod text;
pub mod training;
