//! Calibration, §III-C.1: from demonstrations to the calibration segments of an object file.
//!
//! [`record`] moves the arm and keeps what it feels; [`csv`] and `pubs_run::recording` read and
//! write recordings, and [`faults`] refuses what cannot be used. [`traces`] turns frames into
//! readings at joint states, [`fit`] turns those into [`segment`]s: `changepoints` and `smoothing`
//! wrap the two numerical crates, `curve` fits one force channel, `motion` counts m_p.
//! [`calibration`] is the whole of it, [`spread`] judges by holding pulls out whether the belief is
//! honest, [`survey`] does so for tables of measured doors ([`pulls`]), [`drift`] says whether a
//! stored model still holds. [`object_text`] edits the object file, [`plot`] draws, [`report`] makes
//! a page of all this.

pub mod calibration;
pub mod changepoints;
mod column;
mod contact;
pub mod csv;
mod curve;
pub mod drift;
mod fault;
pub mod faults;
pub mod fit;
mod grid;
mod motion;
pub mod object_text;
mod overlay;
pub mod plot;
pub mod pulls;
pub mod record;
pub mod report;
pub mod segment;
mod segment_model;
pub mod smoothing;
mod source;
pub mod spread;
pub mod stored;
pub mod survey;
mod table;
pub mod traces;

pub use fault::{Fault, Place, Refused};
pub use segment::{Channel, Segment, Values};
pub use source::Source;
