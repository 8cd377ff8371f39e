//! Goals as a user writes them.

use std::fmt;
use std::str::FromStr;

use crate::joint::{Joint, JointKind};

/// A goal joint state, as written after `--goal`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// `0.5`, `open`, `closed`, `middle`: a fraction of the range from closed to open.
    Fraction(f64),
    /// `40deg`, in rad.
    Angle(f64),
    /// `12cm` or `0.12m`, in m.
    Distance(f64),
    /// `@50`: the joint's own unit as its object file writes it (degrees, metres, plain).
    Own(f64),
}

/// Why a text is no goal, or not one of this joint.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GoalError {
    /// The text has none of the known forms.
    #[error(
        "`{0}` is not a goal: write a fraction of the range (0.5), open, closed, middle, 40deg, 12cm, or @50 in the joint's own unit"
    )]
    Unreadable(String),
    /// An angle for a slide, or the like.
    #[error("goal {goal} does not fit a joint that is {joint}: {cure}")]
    WrongUnit {
        /// As written.
        goal: Goal,
        /// Kind of joint.
        joint: &'static str,
        /// What to write instead.
        cure: &'static str,
    },
    /// Beyond the limits.
    #[error(
        "goal {goal} lies outside the limits, {lower} to {upper}: write a fraction from 0 to 1, or a state between the limits"
    )]
    OutsideLimits {
        /// As written.
        goal: Goal,
        /// Closed limit, for people.
        lower: String,
        /// Open limit, for people.
        upper: String,
    },
}

impl FromStr for Goal {
    type Err = GoalError;

    fn from_str(text: &str) -> Result<Self, GoalError> {
        let number = |digits: &str| -> Result<f64, GoalError> {
            let value = digits
                .trim()
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite());
            value.ok_or_else(|| GoalError::Unreadable(text.to_owned()))
        };
        match text {
            "open" => Ok(Self::Fraction(1.0)),
            "closed" | "close" => Ok(Self::Fraction(0.0)),
            "middle" => Ok(Self::Fraction(0.5)),
            _ if text.starts_with('@') => number(&text[1..]).map(Self::Own),
            _ if text.ends_with("deg") => {
                number(&text[..text.len() - 3]).map(|degrees| Self::Angle(degrees.to_radians()))
            }
            _ if text.ends_with("cm") => number(&text[..text.len() - 2])
                .map(|centimetres| Self::Distance(centimetres / 100.0)),
            _ if text.ends_with('m') => number(&text[..text.len() - 1]).map(Self::Distance),
            _ => number(text).map(Self::Fraction),
        }
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fraction(fraction) => write!(out, "{fraction}"),
            Self::Angle(angle) => write!(out, "{}deg", angle.to_degrees()),
            Self::Distance(distance) => write!(out, "{}cm", distance * 100.0),
            Self::Own(value) => write!(out, "@{value}"),
        }
    }
}

impl Goal {
    /// The goal state s_g of a joint (rad, m or plain).
    ///
    /// # Errors
    /// Where the unit is another joint's or the state lies outside the limits.
    pub fn state(&self, joint: &Joint) -> Result<f64, GoalError> {
        let wrong = |joint, cure| GoalError::WrongUnit {
            goal: *self,
            joint,
            cure,
        };
        let state = match (self, &joint.kind) {
            (Self::Fraction(fraction), _) => joint.at_fraction(*fraction),
            (Self::Angle(angle), JointKind::Revolute { .. }) => *angle,
            (Self::Distance(distance), JointKind::Prismatic { .. }) => *distance,
            (Self::Own(degrees), JointKind::Revolute { .. }) => degrees.to_radians(),
            (Self::Own(value), _) => *value,
            (_, JointKind::Revolute { .. }) => {
                return Err(wrong("a hinge", "write an angle such as 40deg"));
            }
            (_, JointKind::Prismatic { .. }) => {
                return Err(wrong("a slide", "write a distance such as 12cm"));
            }
            (_, JointKind::Abstract { .. }) => {
                return Err(wrong("abstract", "write a plain number such as @50"));
            }
        };
        // A limit written in degrees and a goal at it differ by rounding.
        let slack = 1e-9 * joint.range();
        if (joint.lower - slack..=joint.upper + slack).contains(&state) {
            return Ok(state.clamp(joint.lower, joint.upper));
        }
        Err(GoalError::OutsideLimits {
            goal: *self,
            lower: joint.display(joint.lower),
            upper: joint.display(joint.upper),
        })
    }
}

/// A goal state as a fraction of the range, to the four digits that file names carry.
pub fn fraction_label(joint: &Joint, state: f64) -> String {
    let digits = format!("{:.4}", (state - joint.lower) / joint.range());
    let short = digits.trim_end_matches('0').trim_end_matches('.');
    if short.is_empty() {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}
