//! Lengths, angles and directions as a person types them. A number without its unit is refused,
//! since 40 may be degrees, centimetres or a slip.

/// What a joint's states are measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Of a hinge; degrees.
    Angle,
    /// Of a slide, or of a radius; m.
    Length,
}

impl Measure {
    /// Unit, and how many of the file's own units it is: degrees or metres.
    fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Angle => &[("deg", 1.0), ("°", 1.0)],
            Self::Length => &[("cm", 0.01), ("mm", 0.001), ("m", 1.0)],
        }
    }

    fn form(self) -> &'static str {
        match self {
            Self::Angle => "an angle with its unit, such as 110deg",
            Self::Length => "a length with its unit, such as 40cm or 0.4m",
        }
    }

    /// Reads one quantity into the file's own unit; 0 alone needs no unit.
    ///
    /// # Errors
    /// What to write instead.
    pub fn read(self, text: &str) -> Result<f64, String> {
        let text = text.trim();
        let wrong = || format!("`{text}` is not {}", self.form());
        if number(text) == Some(0.0) {
            return Ok(0.0);
        }
        let (digits, scale) = self
            .units()
            .iter()
            .find_map(|(unit, scale)| Some((text.strip_suffix(unit)?, scale)))
            .ok_or_else(wrong)?;
        let value = number(digits).ok_or_else(wrong)? * scale;
        Ok(rounded(value))
    }

    /// Reads a closed and an open limit, `0deg,110deg`.
    ///
    /// # Errors
    /// What to write instead.
    pub fn read_limits(self, text: &str) -> Result<[f64; 2], String> {
        let example = match self {
            Self::Angle => "0deg,110deg",
            Self::Length => "0cm,40cm",
        };
        let Some((closed, open)) = text.split_once(',') else {
            return Err(format!(
                "`{text}` is not the closed and the open limit, such as {example}"
            ));
        };
        Ok([self.read(closed)?, self.read(open)?])
    }

    /// As [`read`](Self::read) would take it.
    pub fn written(self, value: f64) -> String {
        match self {
            Self::Angle => format!("{value}deg"),
            Self::Length => format!("{}cm", rounded(value * 100.0)),
        }
    }
}

/// Reads an axis of the tool (`+x`, `-z`, `y`) or three numbers (`0,0,-1`).
///
/// # Errors
/// What to write instead.
pub fn read_direction(text: &str) -> Result<[f64; 3], String> {
    let text = text.trim();
    let (sign, axis) = match text.strip_prefix(['+', '-']) {
        Some(axis) if text.starts_with('-') => (-1.0, axis),
        Some(axis) => (1.0, axis),
        None => (1.0, text),
    };
    let axis = ["x", "y", "z"].iter().position(|name| *name == axis);
    if let Some(axis) = axis {
        let mut direction = [0.0; 3];
        direction[axis] = sign;
        return Ok(direction);
    }
    let parts: Option<Vec<f64>> = text.split(',').map(number).collect();
    parts
        .and_then(|parts| parts.try_into().ok())
        .ok_or_else(|| {
            format!("`{text}` is not a direction in tool axes, such as -z or 0,0,-1 or 0.1,0,-1")
        })
}

/// The shortest form that [`read_direction`] takes.
pub fn written_direction(direction: [f64; 3]) -> String {
    let axes = ["+x", "+y", "+z", "-x", "-y", "-z"];
    let [x, y, z] = direction;
    axes.into_iter()
        .find(|axis| read_direction(axis) == Ok(direction))
        .map_or_else(|| format!("{x},{y},{z}"), str::to_owned)
}

fn number(text: &str) -> Option<f64> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|number| number.is_finite())
}

/// Without what a change of units leaves behind: 32 · 0.01 is 0.32 in the file.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_come_with_their_units() {
        let cases = [
            (Measure::Angle, "110deg", Some(110.0)),
            (Measure::Angle, " -5.5 ° ", Some(-5.5)),
            (Measure::Angle, "0", Some(0.0)),
            (Measure::Angle, "110", None),
            (Measure::Angle, "40cm", None),
            (Measure::Angle, "nandeg", None),
            (Measure::Length, "32cm", Some(0.32)),
            (Measure::Length, "7mm", Some(0.007)),
            (Measure::Length, "0.4m", Some(0.4)),
            (Measure::Length, "0.4", None),
            (Measure::Length, "40deg", None),
            (Measure::Length, "infm", None),
            (Measure::Length, "cm", None),
            (Measure::Length, "", None),
        ];
        for (measure, text, expected) in cases {
            assert_eq!(measure.read(text).ok(), expected, "{measure:?} {text:?}");
        }
    }

    #[test]
    fn limits_are_two_and_read_back_as_written() {
        assert_eq!(
            Measure::Angle.read_limits("0,110deg"),
            Ok([0.0, 110.0]),
            "zero is zero in any unit"
        );
        assert_eq!(Measure::Length.read_limits("2cm, 0.4m"), Ok([0.02, 0.4]));
        for text in ["110deg", "0deg,110", "0cm,40cm", "0deg,1deg,2deg"] {
            assert!(Measure::Angle.read_limits(text).is_err(), "{text}");
        }
        for value in [0.29, 0.07, 0.333] {
            let text = Measure::Length.written(value);
            assert_eq!(Measure::Length.read(&text), Ok(value), "{text}");
        }
    }

    #[test]
    fn directions_are_axes_or_three_numbers() {
        let cases = [
            ("-z", Some([0.0, 0.0, -1.0])),
            ("+x", Some([1.0, 0.0, 0.0])),
            ("y", Some([0.0, 1.0, 0.0])),
            ("0, 0.1,-1", Some([0.0, 0.1, -1.0])),
            ("--z", None),
            ("left", None),
            ("0,0", None),
            ("0,0,nan", None),
            ("", None),
        ];
        for (text, expected) in cases {
            assert_eq!(read_direction(text).ok(), expected, "{text:?}");
        }
        for direction in [[0.0, 0.0, -1.0], [0.0, 0.1, -1.0]] {
            let text = written_direction(direction);
            assert_eq!(read_direction(&text), Ok(direction), "{text}");
        }
    }
}
