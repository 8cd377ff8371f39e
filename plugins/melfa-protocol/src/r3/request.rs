//! What a client asks: `1;1;DSTATE`.

use std::fmt;
use std::str::FromStr;

use super::TextError;

/// A request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Number of the robot, 1 with one arm.
    pub robot: u8,
    /// Task slot: 1 for the first, 9 for editing and direct execution, 0 for all.
    pub slot: u8,
    /// The command and what belongs to it.
    pub command: String,
}

impl Request {
    /// A request to the only robot.
    pub fn new(slot: u8, command: impl Into<String>) -> Self {
        Self {
            robot: 1,
            slot,
            command: command.into(),
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{};{};{}", self.robot, self.slot, self.command)
    }
}

impl FromStr for Request {
    type Err = TextError;

    fn from_str(text: &str) -> Result<Self, TextError> {
        let fault = || TextError::Request {
            text: text.to_owned(),
        };
        let mut fields = text.splitn(3, ';');
        let mut number = || fields.next().and_then(|field| field.trim().parse().ok());
        let robot = number().ok_or_else(fault)?;
        let slot = number().ok_or_else(fault)?;
        let command = fields.next().filter(|command| !command.is_empty());
        Ok(Self {
            robot,
            slot,
            command: command.ok_or_else(fault)?.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn requests_are_read_and_written() {
        for (text, robot, slot, command) in [
            ("1;1;DSTATE", 1, 1, "DSTATE"),
            ("1;9;ECLR", 1, 9, "ECLR"),
            ("1;0;RUN;-1", 1, 0, "RUN;-1"),
            ("1;1;VALM_Spd;M", 1, 1, "VALM_Spd;M"),
        ] {
            let request: Request = text.parse().unwrap();
            let found = (request.robot, request.slot, request.command.as_str());
            assert_eq!(found, (robot, slot, command), "{text}");
            assert_eq!(request.to_string(), text);
        }
    }

    #[test]
    fn what_is_no_request_is_refused() {
        for text in [
            "",
            "DSTATE",
            "1;DSTATE",
            "1;1;",
            "a;1;DSTATE",
            "1;300;DSTATE",
        ] {
            assert!(text.parse::<Request>().is_err(), "{text:?} was taken");
        }
    }
}
