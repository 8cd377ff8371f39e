//! What an edit would change.

use similar::TextDiff;

/// Unchanged lines shown around each change.
const CONTEXT: usize = 3;

/// A unified difference without file names; empty where the texts are equal.
pub fn difference(old: &str, new: &str) -> String {
    let lines = TextDiff::from_lines(old, new);
    lines.unified_diff().context_radius(CONTEXT).to_string()
}
