//! MELFA-BASIC programs: the few statements that matter to external control.

use std::net::IpAddr;

use pubs_melfa_protocol::mxt::DataType;

/// What a line does.
#[derive(Debug, Clone, PartialEq)]
pub enum Statement {
    /// `Open "ENET:<address>" As #<file>`; `None` where the address cannot be read.
    Open {
        /// Number of the file.
        file: u8,
        /// The client.
        peer: Option<IpAddr>,
    },
    /// `Close #<file>`, or all.
    Close {
        /// Number of the file.
        file: Option<u8>,
    },
    /// `Mxt <file>, <type>[, <filter>]`.
    Mxt {
        /// Number of the file.
        file: u8,
        /// What targets are.
        target: TargetKind,
        /// Time constant of the low-pass, ms.
        filter_ms: f64,
    },
    /// `Servo On` or `Servo Off`.
    Servo(bool),
    /// `Ovrd <percent>`.
    Override(u32),
    /// `Hlt`.
    Halt,
    /// `End`.
    End,
    /// Anything else: passed over.
    Other,
}

/// What the targets of an `Mxt` line are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetKind {
    /// Type 0: position data.
    Pose,
    /// Type 1: joints.
    Joint,
    /// Type 2: pulses.
    Pulse,
}

impl TargetKind {
    /// The type that commands must have.
    pub fn data_type(self) -> DataType {
        match self {
            Self::Pose => DataType::CommandPose,
            Self::Joint => DataType::CommandJoint,
            Self::Pulse => DataType::CommandPulse,
        }
    }
}

/// A program.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// Its lines as written, without their numbers.
    pub lines: Vec<String>,
}

impl Program {
    /// From lines, with or without numbers. Numbered lines go in order of their numbers.
    pub fn from_lines<'a>(lines: impl Iterator<Item = &'a str>) -> Self {
        let mut numbered: Vec<(u32, String)> = vec![];
        for line in lines {
            let line = line.trim();
            let digits = line.chars().take_while(char::is_ascii_digit).count();
            let last = numbered.last().map_or(0, |(number, _)| *number);
            let number = line[..digits].parse().unwrap_or(last);
            let text = line[digits..].trim().to_owned();
            if !text.is_empty() {
                numbered.push((number, text));
            }
        }
        numbered.sort_by_key(|(number, _)| *number);
        Self {
            lines: numbered.into_iter().map(|(_, text)| text).collect(),
        }
    }

    /// What the line with this index does; `None` past the end.
    pub fn statement(&self, index: usize) -> Option<Statement> {
        self.lines.get(index).map(|line| statement(line))
    }
}

/// What a line does.
pub fn statement(line: &str) -> Statement {
    let line = line.trim();
    let (word, rest) = match line.find(|letter: char| !letter.is_ascii_alphabetic()) {
        Some(end) => (&line[..end], line[end..].trim()),
        None => (line, ""),
    };
    let read = match word.to_ascii_lowercase().as_str() {
        "open" => open(rest),
        "close" => Some(Statement::Close {
            file: rest.trim_start_matches('#').trim().parse().ok(),
        }),
        "mxt" => mxt(rest),
        "servo" => servo(rest),
        "ovrd" => rest.parse().ok().map(Statement::Override),
        "hlt" => Some(Statement::Halt),
        "end" => Some(Statement::End),
        _ => None,
    };
    read.unwrap_or(Statement::Other)
}

fn open(rest: &str) -> Option<Statement> {
    let mut quoted = rest.split('"');
    let device = quoted.nth(1)?;
    let file = quoted.next()?.split('#').nth(1)?.trim().parse().ok()?;
    let (scheme, address) = device.split_once(':')?;
    if !scheme.eq_ignore_ascii_case("enet") {
        return None;
    }
    Some(Statement::Open {
        file,
        peer: address.trim().parse().ok(),
    })
}

fn mxt(rest: &str) -> Option<Statement> {
    let mut arguments = rest.split(',').map(str::trim);
    let file = arguments.next()?.trim_start_matches('#').parse().ok()?;
    let target = match arguments.next()? {
        "0" => TargetKind::Pose,
        "1" => TargetKind::Joint,
        "2" => TargetKind::Pulse,
        _ => return None,
    };
    let filter_ms = match arguments.next() {
        None | Some("") => 0.0,
        Some(text) => text.parse().ok().filter(|ms| (0.0..1e4).contains(ms))?,
    };
    Some(Statement::Mxt {
        file,
        target,
        filter_ms,
    })
}

fn servo(rest: &str) -> Option<Statement> {
    match rest.to_ascii_lowercase().as_str() {
        "on" => Some(Statement::Servo(true)),
        "off" => Some(Statement::Servo(false)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn statements_are_understood_in_any_case() {
        let open = |peer: Option<&str>| Statement::Open {
            file: 1,
            peer: peer.map(|peer| peer.parse().unwrap()),
        };
        let mxt = |target, filter_ms| Statement::Mxt {
            file: 1,
            target,
            filter_ms,
        };
        let cases = [
            ("Open \"ENET:127.0.0.1\" As #1", open(Some("127.0.0.1"))),
            ("OPEN \"ENET:192.168.0.3\" AS #1", open(Some("192.168.0.3"))),
            ("open \"enet: 10.0.0.7\" as #1", open(Some("10.0.0.7"))),
            ("Open \"ENET:nobody\" As #1", open(None)),
            ("Open \"COM1:\" As #1", Statement::Other),
            ("Mxt 1,0", mxt(TargetKind::Pose, 0.0)),
            ("MXT 1, 1, 10", mxt(TargetKind::Joint, 10.0)),
            ("mxt #1,2,7.5", mxt(TargetKind::Pulse, 7.5)),
            ("Mxt 1,3", Statement::Other),
            ("Servo On", Statement::Servo(true)),
            ("SERVO OFF", Statement::Servo(false)),
            ("Ovrd 10", Statement::Override(10)),
            ("HLT", Statement::Halt),
            ("End", Statement::End),
            ("Close #1", Statement::Close { file: Some(1) }),
            ("Mov P1", Statement::Other),
            ("' a remark", Statement::Other),
        ];
        for (line, wanted) in cases {
            assert_eq!(statement(line), wanted, "{line}");
        }
    }

    #[test]
    fn numbered_lines_go_by_their_numbers() {
        let program = Program::from_lines(["30 End", "10 Servo On", "20 Hlt", ""].into_iter());
        assert_eq!(program.lines, ["Servo On", "Hlt", "End"]);
        let plain = Program::from_lines(["Servo On", "Hlt", "End"].into_iter());
        assert_eq!(plain, program);
        assert_eq!(plain.statement(2), Some(Statement::End));
        assert_eq!(plain.statement(3), None);
    }
}
