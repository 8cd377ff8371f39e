//! One page on a run, on a training or on an evaluation: figures first, then their numbers, then
//! where they come from. `pubs_draw` draws and writes it; the page of a calibration is the business
//! of the crate that calibrates.

pub mod evaluation;
pub mod run;
mod text;
pub mod training;

/// The unit in which a person reads a state, and how many of them are in one of SI.
pub(crate) fn shown_unit(kind: &pubs_core::JointKind) -> (&'static str, f64) {
    use pubs_core::JointKind;
    match kind {
        JointKind::Revolute { .. } => ("deg", 1_f64.to_degrees()),
        JointKind::Prismatic { .. } => ("cm", 100.0),
        JointKind::Abstract { .. } => ("", 1.0),
    }
}
