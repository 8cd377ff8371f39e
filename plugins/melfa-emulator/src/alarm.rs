//! Alarms and refusals, with their numbers.
//!
//! No list of the controller's error numbers was at hand. Numbers below 8800 are known from
//! reports; those from 8800 on are stand-ins invented here, so that a client sees *some* number
//! and a text: a client must not depend on them.

use pubs_melfa_protocol::r3;

/// How grave an alarm is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// H: the program stops, and the servo goes off once the arm has come to rest.
    High,
    /// L: the program stops.
    Low,
}

/// Why a program was stopped by the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Alarm {
    /// Number without its letter.
    pub number: u32,
    /// Its letter.
    pub severity: Severity,
    /// What `ERRORMES` says.
    pub text: String,
}

/// Number, letter and text of everything that raises an alarm.
const ALARMS: [(u32, Severity, &str); 14] = [
    // Reported by users at the start of a program with an ENET line. The text is known.
    (
        r3::NETWORK_ERROR,
        Severity::Low,
        "Network communication error",
    ),
    // From here on: invented.
    (NO_HANDSHAKE, Severity::Low, "MXT command before handshake"),
    (WRONG_TYPE, Severity::Low, "MXT data type mismatch"),
    (TIMEOUT, Severity::Low, "MXT communication timeout"),
    (
        FILE_NOT_OPEN,
        Severity::Low,
        "MXT on a file that is not open",
    ),
    (JOINT_SPEED, Severity::High, "Excessive joint speed"),
    (JOINT_RANGE, Severity::Low, "Target beyond a joint's range"),
    (OUT_OF_REACH, Severity::Low, "Target out of reach"),
    (SINGULAR, Severity::Low, "Target at a singular point"),
    (OTHER_POSTURE, Severity::Low, "Target in another posture"),
    (NOT_FINITE, Severity::Low, "Target is not a number"),
    (SERVO_OFF, Severity::Low, "Servo is off"),
    (EMERGENCY_STOP, Severity::High, "Emergency stop"),
    (CONTACT, Severity::High, "Contact detected"),
];

/// A target came before the first packet with command 0.
pub const NO_HANDSHAKE: u32 = 8801;
/// A target of another type than the program's `Mxt` line asks for.
pub const WRONG_TYPE: u32 = 8802;
/// More cycles without a packet than MXTTOUT allows.
pub const TIMEOUT: u32 = 8803;
/// `Mxt` without an `Open` before it.
pub const FILE_NOT_OPEN: u32 = 8804;
/// A joint would be faster than it can.
pub const JOINT_SPEED: u32 = 8805;
/// A joint would leave its range.
pub const JOINT_RANGE: u32 = 8806;
/// No joints reach the target.
pub const OUT_OF_REACH: u32 = 8807;
/// The target determines no joints.
pub const SINGULAR: u32 = 8808;
/// The target's flags name a posture that the arm does not have.
pub const OTHER_POSTURE: u32 = 8809;
/// The target has a number that is infinite or none.
pub const NOT_FINITE: u32 = 8810;
/// Motion was asked for with the servo off.
pub const SERVO_OFF: u32 = 8811;
/// The button was pressed.
pub const EMERGENCY_STOP: u32 = 8812;
/// The collaborative arm felt a contact.
pub const CONTACT: u32 = 8813;

impl Alarm {
    /// The alarm with this number; one that is not in the table is taken as grave.
    pub fn new(number: u32) -> Self {
        let known = ALARMS.iter().find(|(known, ..)| *known == number);
        let (severity, text) = known.map_or((Severity::High, "Alarm"), |(_, severity, text)| {
            (*severity, *text)
        });
        Self {
            number,
            severity,
            text: text.to_owned(),
        }
    }

    /// With particulars behind its text.
    pub fn with(mut self, particulars: &str) -> Self {
        self.text = format!("{}: {particulars}", self.text);
        self
    }
}

/// The text of a number, alarm or refusal.
pub fn text_of(number: u32) -> Option<&'static str> {
    let alarm = ALARMS.iter().find(|(known, ..)| *known == number);
    let refusal = Refusal::ALL.iter().find(|known| known.number() == number);
    alarm
        .map(|(_, _, text)| *text)
        .or(refusal.map(|refusal| refusal.text()))
}

/// Why a request over R3 is not carried out. Raises no alarm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// Another connection has the operation right.
    Busy,
    /// Not a command of the protocol, or one that is not emulated.
    UnknownCommand,
    /// A part of the request cannot be read.
    BadArgument,
    /// Longer than clients and controllers can hold.
    TooLong,
    /// `CNTLON` comes first.
    NoOperationRight,
    /// The controller is in MANUAL: the network commands nothing.
    Manual,
    /// `RSTALRM` comes first.
    InAlarm,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// Not while a program runs.
    Running,
    /// Another program is interrupted: `SLOTINIT` or `RSTPRG` comes first.
    Interrupted,
    /// No program of this name.
    NoProgram,
    /// No program is open for editing.
    NoEdit,
    /// No variable of this name.
    NoVariable,
}

impl Refusal {
    const ALL: [Self; 13] = [
        Self::Busy,
        Self::UnknownCommand,
        Self::BadArgument,
        Self::TooLong,
        Self::NoOperationRight,
        Self::Manual,
        Self::InAlarm,
        Self::EmergencyStop,
        Self::Running,
        Self::Interrupted,
        Self::NoProgram,
        Self::NoEdit,
        Self::NoVariable,
    ];

    /// Its number: 5640 is known to clients as busy, the others are invented.
    pub fn number(self) -> u32 {
        match self {
            Self::Busy => r3::BUSY,
            other => 8850 + other as u32,
        }
    }

    /// What `ERRORMES` says.
    pub fn text(self) -> &'static str {
        match self {
            Self::Busy => "Operation right is held elsewhere",
            Self::UnknownCommand => "Unknown command",
            Self::BadArgument => "Illegal argument",
            Self::TooLong => "Request too long",
            Self::NoOperationRight => "No operation right",
            Self::Manual => "Mode is MANUAL",
            Self::InAlarm => "Alarm present",
            Self::EmergencyStop => "Emergency stop is pressed",
            Self::Running => "Program is running",
            Self::Interrupted => "Program is interrupted",
            Self::NoProgram => "No such program",
            Self::NoEdit => "No program open for editing",
            Self::NoVariable => "No such variable",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_has_one_text() {
        let mut numbers: Vec<u32> = ALARMS.iter().map(|(number, ..)| *number).collect();
        numbers.extend(Refusal::ALL.iter().map(|refusal| refusal.number()));
        for number in &numbers {
            let times = numbers.iter().filter(|other| *other == number).count();
            assert_eq!(times, 1, "{number} stands for more than one thing");
            assert!(text_of(*number).is_some(), "{number} has no text");
        }
        assert_eq!(text_of(1), None);
    }
}
