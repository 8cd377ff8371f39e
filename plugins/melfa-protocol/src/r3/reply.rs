//! What a controller answers: `QoK…`, or an error number.

use std::fmt;
use std::str::FromStr;

use super::TextError;

/// The prefix of a reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// `QoK`: done, no alarm.
    Done,
    /// `Qok`: done; the controller has an alarm.
    DoneInAlarm,
    /// `QeR`: refused, no alarm.
    Refused,
    /// `Qer`: refused; the controller has an alarm.
    RefusedInAlarm,
}

impl Status {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Done, "QoK"),
        (Self::DoneInAlarm, "Qok"),
        (Self::Refused, "QeR"),
        (Self::RefusedInAlarm, "Qer"),
    ];

    /// Whether the request was carried out.
    pub fn is_done(self) -> bool {
        matches!(self, Self::Done | Self::DoneInAlarm)
    }

    /// Whether the controller has an alarm.
    pub fn is_in_alarm(self) -> bool {
        matches!(self, Self::DoneInAlarm | Self::RefusedInAlarm)
    }
}

/// A reply.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// Its prefix.
    pub status: Status,
    /// What follows: data, or four digits of an error number.
    pub text: String,
}

impl Reply {
    /// The request was carried out.
    pub fn done(text: impl Into<String>, in_alarm: bool) -> Self {
        let status = match in_alarm {
            false => Status::Done,
            true => Status::DoneInAlarm,
        };
        Self {
            status,
            text: text.into(),
        }
    }

    /// The request was refused with this error number.
    pub fn refused(number: u32, in_alarm: bool) -> Self {
        let status = match in_alarm {
            false => Status::Refused,
            true => Status::RefusedInAlarm,
        };
        Self {
            status,
            text: format!("{number:04}"),
        }
    }

    /// Why the request was refused; `None` where it was not, or where no number is given.
    pub fn error_number(&self) -> Option<u32> {
        if self.status.is_done() {
            return None;
        }
        let digits = self.text.trim();
        let end = digits
            .find(|letter: char| !letter.is_ascii_digit())
            .unwrap_or(digits.len());
        digits[..end].parse().ok()
    }
}

impl fmt::Display for Reply {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = Status::ALL
            .iter()
            .find(|(status, _)| *status == self.status);
        let prefix = known.map_or("", |(_, prefix)| prefix);
        write!(formatter, "{prefix}{}", self.text)
    }
}

impl FromStr for Reply {
    type Err = TextError;

    fn from_str(text: &str) -> Result<Self, TextError> {
        let text = text.trim_end_matches(['\r', '\n', '\0']);
        let known = Status::ALL
            .iter()
            .find_map(|(status, prefix)| Some((*status, text.strip_prefix(prefix)?)));
        let (status, rest) = known.ok_or_else(|| TextError::Reply {
            text: text.to_owned(),
        })?;
        Ok(Self {
            status,
            text: rest.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn prefixes_say_whether_done_and_whether_in_alarm() {
        for (text, done, in_alarm, error) in [
            ("QoKA1060;1;0", true, false, None),
            ("Qok", true, true, None),
            ("QeR5640", false, false, Some(5640)),
            ("Qer0117\r", false, true, Some(117)),
        ] {
            let reply: Reply = text.parse().unwrap();
            let found = (reply.status.is_done(), reply.status.is_in_alarm());
            assert_eq!(found, (done, in_alarm), "{text:?}");
            assert_eq!(reply.error_number(), error, "{text:?}");
            assert_eq!(reply.to_string(), text.trim_end());
        }
        assert_eq!(Reply::refused(117, true).to_string(), "Qer0117");
        assert!("QOK".parse::<Reply>().is_err(), "QOK is no prefix");
    }
}
