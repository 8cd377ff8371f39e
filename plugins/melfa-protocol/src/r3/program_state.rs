//! The longer account of the state: the answer to `STATE`, 19 fields.

use std::fmt;
use std::str::FromStr;

use super::{State, TextError};

/// The answer to `STATE`. Fields 7 to 13 are not known; they are skipped, and written empty.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ProgramState {
    /// Field 0: name of the program.
    pub program: String,
    /// Field 1: line.
    pub line: u32,
    /// Field 2: override, %.
    pub override_percent: u32,
    /// Field 3: edit status, hex digits.
    pub edit_status: String,
    /// Field 4, with the step of field 5 and the mechanism of field 6.
    pub state: State,
    /// Field 14: program of the slot.
    pub slot_program: String,
    /// Field 15: "REP" rather than "CYC".
    pub repeat: bool,
    /// Field 16: START, ALWAYS or ERROR.
    pub start_condition: String,
    /// Field 17: priority.
    pub priority: u32,
    /// Field 18: number of the mechanism.
    pub mechanism_number: u32,
}

impl fmt::Display for ProgramState {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            program,
            line,
            override_percent,
            edit_status,
            state,
            ..
        } = self;
        let status = state.status_text();
        write!(
            formatter,
            "{program};{line};{override_percent};{edit_status};{status};{};{:02X};;;;;;;",
            state.step, state.mechanism
        )?;
        let cycle = if self.repeat { "REP" } else { "CYC" };
        write!(
            formatter,
            ";{};{cycle};{};{};{}",
            self.slot_program, self.start_condition, self.priority, self.mechanism_number
        )
    }
}

impl FromStr for ProgramState {
    type Err = TextError;

    /// Reads what follows `QoK` in an answer to `STATE`. Fields from 5 on may be missing.
    fn from_str(text: &str) -> Result<Self, TextError> {
        let fields: Vec<&str> = text.split(';').map(str::trim).collect();
        let field = |index: usize| fields.get(index).copied().unwrap_or("");
        let number = |index: usize| field(index).parse().unwrap_or(0);
        let status = State::parse_status(field(4));
        let status = status.ok_or_else(|| TextError::field(text, "status in its fifth field"))?;
        Ok(Self {
            program: field(0).to_owned(),
            line: number(1),
            override_percent: number(2),
            edit_status: field(3).to_owned(),
            state: State {
                step: number(5),
                mechanism: u32::from_str_radix(field(6), 16).unwrap_or(0),
                ..status
            },
            slot_program: field(14).to_owned(),
            repeat: field(15) == "REP",
            start_condition: field(16).to_owned(),
            priority: number(17),
            mechanism_number: number(18),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn fields_stand_in_their_places() {
        let text = "PUBS;3;80;00;E0186130;3;01;;;;;;;;PUBS;CYC;START;1;1";
        let state: ProgramState = text.parse().unwrap();
        assert_eq!((state.program.as_str(), state.line), ("PUBS", 3));
        assert_eq!(state.override_percent, 80);
        assert!(state.state.run.servo_on && state.state.run.running);
        assert_eq!((state.state.error, state.state.step), (6130, 3));
        assert_eq!(state.state.mechanism, 1);
        assert_eq!(state.slot_program, "PUBS");
        assert!(!state.repeat);
        assert_eq!(state.start_condition, "START");
        assert_eq!((state.priority, state.mechanism_number), (1, 1));
        assert_eq!(state.to_string(), text);
        assert_eq!(text.split(';').nth(14), Some("PUBS"), "field 14");
    }

    #[test]
    fn short_answer_is_enough_and_one_without_status_is_not() {
        let state: ProgramState = "P;1;100;00;A1060".parse().unwrap();
        assert!(state.state.run.operation_enabled);
        assert!("P;1;100;00".parse::<ProgramState>().is_err());
    }
}
