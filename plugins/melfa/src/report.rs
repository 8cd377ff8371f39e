//! Checks as they are made.

use pubs_plugin::{CheckState, DriverCheck, PluginError};

/// All checks so far.
#[derive(Debug, Clone, Default)]
pub struct Report {
    checks: Vec<DriverCheck>,
}

impl Report {
    /// Something is as it should be.
    pub fn ok(&mut self, name: &str, found: impl Into<String>) {
        self.add(name, CheckState::Ok, found.into(), String::new());
    }

    /// The arm would move, but somebody should know.
    pub fn warn(&mut self, name: &str, found: impl Into<String>, cure: impl Into<String>) {
        self.add(name, CheckState::Warn, found.into(), cure.into());
    }

    /// The arm would not move.
    pub fn fault(&mut self, name: &str, found: impl Into<String>, cure: impl Into<String>) {
        self.add(name, CheckState::Fault, found.into(), cure.into());
    }

    /// Not looked at.
    pub fn skip(&mut self, name: &str, why: impl Into<String>) {
        self.add(name, CheckState::Skipped, why.into(), String::new());
    }

    fn add(&mut self, name: &str, state: CheckState, found: String, cure: String) {
        self.checks.push(DriverCheck {
            name: name.to_owned(),
            state,
            found,
            cure,
        });
    }

    /// Whether something keeps the arm from moving.
    pub fn has_fault(&self) -> bool {
        self.first_fault().is_some()
    }

    fn first_fault(&self) -> Option<&DriverCheck> {
        let mut checks = self.checks.iter();
        checks.find(|check| check.state == CheckState::Fault)
    }

    /// The first thing that keeps the arm from moving, with its cure.
    pub fn refusal(&self) -> PluginError {
        let text = match self.first_fault() {
            Some(check) => format!("{}: {}; {}", check.name, check.found, check.cure),
            None => "the preparations did not come to their end".to_owned(),
        };
        PluginError::new(text)
    }

    /// The checks in the order they were made.
    pub fn into_checks(self) -> Vec<DriverCheck> {
        self.checks
    }
}
