//! The vocabulary of the key table: what a key may hold, for which joints, in which range.

use pubs_plugin::JointType;

/// One key of the object file.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Path from the root, elements of a list of tables as `*`: `action.*.move`.
    pub path: &'static str,
    /// Whether a file must, may or must not have it, for revolute, prismatic, abstract joints.
    pub need: [Need; 3],
    /// What it holds.
    pub kind: Kind,
    /// Unit, as text for people; empty for none.
    pub unit: &'static str,
    /// One or two sentences for the author of an object.
    pub doc: &'static str,
}

/// Whether a file must have a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Stated in every file.
    Required,
    /// The engine's defaults give it where the file does not.
    Defaulted,
    /// May be left out; its doc says what that means.
    Optional,
    /// Has no meaning for this joint type and is refused.
    Absent,
}

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Keys of their own.
    Table,
    /// A list of tables.
    Tables,
    /// Any text but the empty one.
    Text,
    /// Letters, digits, `_` and `-`: fit for file names.
    Name,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    /// A number.
    Number(Range),
    /// A number without a fraction.
    Whole(Range),
    /// This many numbers.
    Numbers(usize, Range),
    /// A list of whole numbers, not empty.
    Wholes(Range),
    /// Anything finite: the schema of a plugin checks it.
    Plugin,
}

/// An interval of numbers. Containment is positive and the bounds are finite, so that NaN and
/// the infinities are in no range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// Whether the lower bound itself is outside.
    pub above_low: bool,
    /// Whether the upper bound itself is outside.
    pub below_high: bool,
}

/// `low..=high`.
pub const fn from_to(low: f64, high: f64) -> Range {
    Range {
        low,
        high,
        above_low: false,
        below_high: false,
    }
}

/// Above `low`, up to `high`.
pub const fn above_to(low: f64, high: f64) -> Range {
    Range {
        low,
        high,
        above_low: true,
        below_high: false,
    }
}

/// Above `low`, below `high`.
pub const fn above_below(low: f64, high: f64) -> Range {
    Range {
        low,
        high,
        above_low: true,
        below_high: true,
    }
}

/// Every finite number.
pub const FINITE: Range = from_to(-f64::MAX, f64::MAX);
/// Every finite number above 0.
pub const POSITIVE: Range = above_to(0.0, f64::MAX);
/// Every finite number from 0 downwards.
pub const NOT_POSITIVE: Range = from_to(-f64::MAX, 0.0);

impl Range {
    /// Whether `value` lies inside; false for NaN and the infinities.
    pub fn contains(&self, value: f64) -> bool {
        let high_enough = if self.above_low {
            value > self.low
        } else {
            value >= self.low
        };
        let low_enough = if self.below_high {
            value < self.high
        } else {
            value <= self.high
        };
        high_enough && low_enough
    }

    fn describe(&self) -> String {
        let low = (self.low > -f64::MAX).then_some(self.low);
        let high = (self.high < f64::MAX).then_some(self.high);
        let upper = if self.below_high { "below" } else { "up to" };
        match (low, high) {
            (None, None) => "finite".to_owned(),
            (None, Some(high)) => format!("{upper} {high}"),
            (Some(low), None) if self.above_low => format!("above {low}"),
            (Some(low), None) => format!("{low} or more"),
            (Some(low), Some(high)) if self.above_low => format!("above {low} and {upper} {high}"),
            (Some(low), Some(high)) if low == high => format!("exactly {low}"),
            (Some(low), Some(high)) => format!("from {low} to {high}"),
        }
    }
}

impl Kind {
    /// The rule in words, to follow "it must be".
    pub fn describe(&self) -> String {
        match self {
            Self::Table => "a table".to_owned(),
            Self::Tables => "a list of tables".to_owned(),
            Self::Text => "a text that is not empty".to_owned(),
            Self::Name => "a text of letters, digits, `_` and `-`".to_owned(),
            Self::Choice(words) => {
                let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                match quoted.as_slice() {
                    [only] => only.clone(),
                    several => format!("one of {}", several.join(", ")),
                }
            }
            Self::Flag => "true or false".to_owned(),
            Self::Number(FINITE) => "a finite number".to_owned(),
            Self::Number(range) => format!("a number, {}", range.describe()),
            Self::Whole(range) => format!("a whole number, {}", range.describe()),
            Self::Numbers(count, FINITE) => format!("a list of {count} finite numbers"),
            Self::Numbers(count, range) => {
                format!("a list of {count} numbers, each {}", range.describe())
            }
            Self::Wholes(range) => {
                format!(
                    "a list of at least one whole number, each {}",
                    range.describe()
                )
            }
            Self::Plugin => "made of finite numbers, texts, flags, lists and tables".to_owned(),
        }
    }
}

impl Key {
    /// Whether a file with this joint must have the key; where the type is not known, a key is
    /// optional if any type has it.
    pub fn need(&self, joint: Option<JointType>) -> Need {
        match joint {
            Some(joint) => self.need[column(joint)],
            None if self.need == [Need::Required; 3] => Need::Required,
            None => Need::Optional,
        }
    }

    /// The last part of the path.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// The path of the table that holds the key; empty for the root.
    pub fn parent(&self) -> &'static str {
        self.path.rsplit_once('.').map_or("", |(parent, _)| parent)
    }

    /// The joint types that have the key, in words.
    pub fn joints(&self) -> String {
        let names: Vec<&str> = JOINTS
            .into_iter()
            .filter(|joint| self.need[column(*joint)] != Need::Absent)
            .map(joint_name)
            .collect();
        names.join(" or ")
    }

    /// The rule in words with the unit, to follow "it must be".
    pub fn describe(&self) -> String {
        match self.unit {
            "" => self.kind.describe(),
            unit => format!("{} ({unit})", self.kind.describe()),
        }
    }
}

/// The joint types in the order of [`Key::need`].
pub const JOINTS: [JointType; 3] = [
    JointType::Revolute,
    JointType::Prismatic,
    JointType::Abstract,
];

fn column(joint: JointType) -> usize {
    match joint {
        JointType::Revolute => 0,
        JointType::Prismatic => 1,
        JointType::Abstract => 2,
    }
}

/// The word that an object file uses for a joint type.
pub fn joint_name(joint: JointType) -> &'static str {
    match joint {
        JointType::Revolute => "revolute",
        JointType::Prismatic => "prismatic",
        JointType::Abstract => "abstract",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_contain_what_they_say_and_neither_nan_nor_infinity() {
        let cases = [
            (from_to(0.0, 1.0), 0.0, true),
            (from_to(0.0, 1.0), 1.0, true),
            (above_to(0.0, 1.0), 0.0, false),
            (above_to(0.0, 1.0), 1.0, true),
            (above_below(0.0, 1.0), 1.0, false),
            (above_below(0.0, 1.0), 0.5, true),
            (NOT_POSITIVE, 0.0, true),
            (NOT_POSITIVE, 0.1, false),
            (FINITE, -1e300, true),
        ];
        for (range, value, expected) in cases {
            assert_eq!(range.contains(value), expected, "{value} in {range:?}");
        }
        for range in [
            FINITE,
            POSITIVE,
            NOT_POSITIVE,
            from_to(-1.0, 1.0),
            above_below(0.0, 1.0),
        ] {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert!(!range.contains(value), "{value} must be outside {range:?}");
            }
        }
    }

    #[test]
    fn rules_read_as_sentences() {
        let cases = [
            (Kind::Number(POSITIVE), "a number, above 0"),
            (Kind::Number(NOT_POSITIVE), "a number, up to 0"),
            (
                Kind::Number(above_below(0.0, 1.0)),
                "a number, above 0 and below 1",
            ),
            (
                Kind::Whole(from_to(2.0, 9.0)),
                "a whole number, from 2 to 9",
            ),
            (Kind::Numbers(3, FINITE), "a list of 3 finite numbers"),
            (Kind::Choice(&["sis"]), "\"sis\""),
        ];
        for (kind, expected) in cases {
            assert_eq!(kind.describe(), expected);
        }
    }
}
