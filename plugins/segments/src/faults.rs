//! All that is wrong with an object's segments, gathered so that one run names everything.

use pubs_plugin::PluginError;

/// Faults found so far, one line each.
#[derive(Debug, Default)]
pub(crate) struct Faults(Vec<String>);

impl Faults {
    /// Adds one fault: where it is, what was found, the rule it breaks and what mends it.
    pub(crate) fn add(&mut self, place: &str, found: &str, rule: &str, cure: &str) {
        self.0.push(format!("{place}: {found}; {rule}; {cure}"));
    }

    /// `value` where there is no fault, else one error with a line per fault.
    pub(crate) fn or_value<T>(self, value: T) -> Result<T, PluginError> {
        if self.0.is_empty() {
            Ok(value)
        } else {
            Err(PluginError::new(self.0.join("\n")))
        }
    }
}
