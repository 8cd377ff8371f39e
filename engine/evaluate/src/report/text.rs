//! Numbers and words as pages have them.

use pubs_core::Joint;

use crate::reproduce::numbers::{NOTHING, decimal};

/// A state with a decimal more than a person needs to tell two runs apart, and its unit.
pub(super) fn state(joint: &Joint, value: f64) -> String {
    let (unit, factor) = joint.kind.shown_unit();
    let number = decimal(value * factor, 2);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// A value, or a dash where nobody knows it.
pub(super) fn or_nothing<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or_else(|| NOTHING.to_owned(), text)
}

pub(super) fn yes_or_no(value: bool) -> String {
    if value { "yes" } else { "no" }.to_owned()
}
