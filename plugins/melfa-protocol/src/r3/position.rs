//! Positions in text: `PPOSF`, `JPOSF` and lists in brackets. Millimetres and degrees.

use std::fmt::{self, Write};
use std::str::FromStr;

use super::TextError;
use crate::pose::Pose;

const NAMES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// The answer to `PPOSF`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Position {
    /// X, Y, Z.
    pub position_mm: [f64; 3],
    /// A, B, C.
    pub angles_deg: [f64; 3],
    /// First word of flags.
    pub posture: u32,
    /// Second word of flags.
    pub turns: u32,
    /// Override, %.
    pub override_percent: u32,
    /// Speed, as the controller gives it.
    pub speed: f64,
}

impl Position {
    /// As position data of the packets.
    pub fn pose(&self) -> Pose {
        Pose {
            position_mm: self.position_mm.map(|value| value as f32),
            angles_rad: self.angles_deg.map(|value| value.to_radians() as f32),
            extra: [0.0; 2],
            posture: self.posture,
            turns: self.turns,
        }
    }
}

impl fmt::Display for Position {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in NAMES
            .iter()
            .zip(self.position_mm.iter().chain(&self.angles_deg))
        {
            write!(formatter, "{name};{:.2};", hundredths(*value))?;
        }
        write!(
            formatter,
            ";{},{};{};{:.2};00000000",
            self.posture, self.turns, self.override_percent, self.speed
        )
    }
}

impl FromStr for Position {
    type Err = TextError;

    /// Reads what follows `QoK` in an answer to `PPOSF`. What follows C may be missing.
    fn from_str(text: &str) -> Result<Self, TextError> {
        let fields: Vec<&str> = text.split(';').map(str::trim).collect();
        let mut values = [0.0; 6];
        for (value, name) in values.iter_mut().zip(NAMES) {
            let found = fields.iter().position(|field| *field == name);
            *value = found
                .and_then(|index| fields.get(index + 1)?.parse().ok())
                .ok_or_else(|| TextError::field(text, "number after each of X, Y, Z, A, B, C"))?;
        }
        let [x, y, z, a, b, c] = values;
        let mut position = Self {
            position_mm: [x, y, z],
            angles_deg: [a, b, c],
            override_percent: 100,
            ..Self::default()
        };
        position.read_flags(&fields);
        Ok(position)
    }
}

impl Position {
    /// The field with a comma has the flags; override and speed follow it.
    fn read_flags(&mut self, fields: &[&str]) {
        let flags = fields
            .iter()
            .enumerate()
            .find_map(|(index, field)| Some((index, field.split_once(',')?)));
        let Some((index, (posture, turns))) = flags else {
            return;
        };
        self.posture = posture.trim().parse().unwrap_or(0);
        self.turns = turns.trim().parse().unwrap_or(0);
        let field = |offset: usize| fields.get(index + offset);
        if let Some(percent) = field(1).and_then(|field| field.parse().ok()) {
            self.override_percent = percent;
        }
        self.speed = field(2).and_then(|field| field.parse().ok()).unwrap_or(0.0);
    }
}

/// Rounded to two decimals, and never minus zero.
fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

/// The answer to `JPOSF` for these joints, degrees.
pub fn format_joints(joints_deg: &[f64; 6]) -> String {
    let mut text = String::new();
    for (index, value) in joints_deg.iter().enumerate() {
        let _ = write!(text, "J{};{:.2};", index + 1, hundredths(*value));
    }
    text.pop();
    text
}

/// Joints 1 to 6 (degrees) from what follows `QoK` in an answer to `JPOSF`: the values at odd
/// places.
pub fn parse_joints(text: &str) -> Result<[f64; 6], TextError> {
    let mut values = text.split(';').skip(1).step_by(2);
    let mut joints = [0.0; 6];
    for joint in &mut joints {
        *joint = values
            .next()
            .and_then(|field| field.trim().parse().ok())
            .ok_or_else(|| TextError::field(text, "six joint values at odd places"))?;
    }
    Ok(joints)
}

/// Position data as MELFA-BASIC writes it: `(x,y,z,a,b,c)(posture,turns)`.
pub fn format_list(values: &[f64; 6], flags: (u32, u32)) -> String {
    let values = values.map(|value| format!("{:.2}", hundredths(value)));
    let values = values.join(",");
    format!("({values})({},{})", flags.0, flags.1)
}

/// The numbers of the first list in brackets of a text, such as `P_FsCurD=(1.2,…)(…)`.
pub fn parse_list(text: &str) -> Result<Vec<f64>, TextError> {
    let fault = || TextError::field(text, "list of numbers in brackets");
    let (_, rest) = text.split_once('(').ok_or_else(fault)?;
    let (list, _) = rest.split_once(')').ok_or_else(fault)?;
    let numbers = list.split(',').map(|field| field.trim().parse());
    numbers.collect::<Result<_, _>>().map_err(|_| fault())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const CAPTURED: &str =
        "X;450.00;Y;0.00;Z;405.00;A;-180.00;B;0.00;C;-180.00;;7,0;100;0.00;00000000";

    #[test]
    fn captured_position_is_read_and_written() {
        let position: Position = CAPTURED.parse().unwrap();
        assert_eq!(position.position_mm, [450.0, 0.0, 405.0]);
        assert_eq!(position.angles_deg, [-180.0, 0.0, -180.0]);
        assert_eq!((position.posture, position.turns), (7, 0));
        assert_eq!((position.override_percent, position.speed), (100, 0.0));
        assert_eq!(position.to_string(), CAPTURED);
        let pose = position.pose();
        assert_eq!(pose.position_mm, [450.0, 0.0, 405.0]);
        assert!((pose.angles_rad[0] + std::f32::consts::PI).abs() < 1e-6);
    }

    #[test]
    fn position_without_its_tail_is_enough() {
        let short: Position = "X;1.5;Y;2;Z;-3;A;0;B;90;C;0".parse().unwrap();
        assert_eq!(short.position_mm, [1.5, 2.0, -3.0]);
        assert!("X;1.5;Y;2;Z;x;A;0;B;90;C;0".parse::<Position>().is_err());
        assert!("".parse::<Position>().is_err());
    }

    #[test]
    fn joints_are_read_and_written() {
        let joints = [0.0, -10.25, 90.0, 0.0, 90.0, 180.0];
        let text = "J1;0.00;J2;-10.25;J3;90.00;J4;0.00;J5;90.00;J6;180.00";
        assert_eq!(format_joints(&joints), text);
        assert_eq!(parse_joints(text).unwrap(), joints);
        let more = format!("{text};L1;0.00;100");
        assert_eq!(parse_joints(&more).unwrap(), joints);
        assert!(parse_joints("J1;0.00").is_err());
    }

    #[test]
    fn lists_are_read_and_written() {
        let text = format_list(&[1.25, -0.5, 12.0, 0.03, -0.1, -0.001], (0, 0));
        assert_eq!(text, "(1.25,-0.50,12.00,0.03,-0.10,0.00)(0,0)");
        let found = parse_list(&format!("P_FsCurD={text}")).unwrap();
        assert_eq!(found, [1.25, -0.5, 12.0, 0.03, -0.1, 0.0]);
        assert!(parse_list("P_FsCurD").is_err());
        assert!(parse_list("(1,a)").is_err());
    }
}
