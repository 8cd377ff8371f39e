//! Exit codes. Scripts rely on them; they do not change.

/// Done.
pub const DONE: u8 = 0;
/// Something failed that is not the user's doing: a driver, a disk, a bug.
pub const FAULT: u8 = 1;
/// Wrong usage, or a file that is not valid; nothing was begun.
pub const INVALID: u8 = 2;
/// Finished, but the goal was missed, data was lost, or a model no longer holds.
pub const MISSED: u8 = 3;
/// Stopped for safety, or by a person.
pub const SAFETY_STOP: u8 = 4;
/// A plugin or a policy that does not fit.
pub const INCOMPATIBLE: u8 = 5;

/// The codes, for `--help`.
pub const TABLE: &str = "\
Exit codes: 0 done, 1 fault, 2 usage or invalid file, 3 finished but the goal was missed, data \
was lost or a model no longer holds, 4 stopped for safety, 5 incompatible plugin or policy";
