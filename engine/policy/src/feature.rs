//! The named inputs of a policy.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What one input of the network is. Files, messages and `--inputs` have it as one plain word.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum FeatureName {
    /// `mean_state`: mean joint state of the belief, rad, m or plain.
    MeanState,
    /// `entropy`: Shannon entropy of the particle weights over ln N, in \[0, 1\].
    Entropy,
    /// `mean_minus_goal`: mean joint state minus the goal, for a policy that serves every goal.
    MeanMinusGoal,
    /// `goal`: the goal state, rad, m or plain.
    Goal,
    /// `random_entropy`: uniform in \[0, 1\], drawn anew at each policy step in place of the
    /// entropy (Random H, §IV-D).
    RandomEntropy,
    /// `reading.<channel>`: the latest reading of that channel of the observation model, such as
    /// `reading.f_d` in N or `reading.m_p` (the raw observations of §IV-B).
    Reading(String),
}

/// What the word of a reading begins with; its channel follows.
const READING: &str = "reading.";

impl FeatureName {
    /// Every feature that needs no channel to name it.
    pub const PLAIN: [Self; 5] = [
        Self::MeanState,
        Self::Entropy,
        Self::MeanMinusGoal,
        Self::Goal,
        Self::RandomEntropy,
    ];

    /// The channel of a reading.
    #[must_use]
    pub fn channel(&self) -> Option<&str> {
        match self {
            Self::Reading(channel) => Some(channel),
            _ => None,
        }
    }

    /// Whether it comes from the particle filter's belief.
    #[must_use]
    pub fn is_of_belief(&self) -> bool {
        matches!(self, Self::MeanState | Self::Entropy | Self::MeanMinusGoal)
    }

    /// The feature of exactly this word, as a contract has it.
    fn of_word(word: &str) -> Option<Self> {
        if let Some(channel) = word.strip_prefix(READING) {
            return is_channel(channel).then(|| Self::Reading(channel.to_owned()));
        }
        match word {
            "mean_state" => Some(Self::MeanState),
            "entropy" => Some(Self::Entropy),
            "mean_minus_goal" => Some(Self::MeanMinusGoal),
            "goal" => Some(Self::Goal),
            "random_entropy" => Some(Self::RandomEntropy),
            _ => None,
        }
    }

    /// Whether its word reads back: a channel may hold nothing that parts words.
    pub(crate) fn is_word(&self) -> bool {
        self.channel().is_none_or(is_channel)
    }
}

/// Words stand between commas on the command line, so a channel holds neither these nor spaces.
fn is_channel(text: &str) -> bool {
    let parts_words = |c: char| c == ',' || c.is_whitespace() || c.is_control();
    !text.is_empty() && !text.contains(parts_words)
}

impl fmt::Display for FeatureName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::MeanState => "mean_state",
            Self::Entropy => "entropy",
            Self::MeanMinusGoal => "mean_minus_goal",
            Self::Goal => "goal",
            Self::RandomEntropy => "random_entropy",
            Self::Reading(channel) => return write!(formatter, "{READING}{channel}"),
        })
    }
}

/// A word that names no feature.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "no input is called {found:?}; known are mean_state (or mean), entropy, mean_minus_goal, goal, random_entropy and \
     reading.CHANNEL, such as reading.f_d"
)]
pub struct UnknownFeature {
    found: String,
}

impl FromStr for FeatureName {
    type Err = UnknownFeature;

    /// Reads a name as `--inputs` has it; `mean` is short for `mean_state`.
    fn from_str(text: &str) -> Result<Self, UnknownFeature> {
        match text.trim() {
            "mean" => Ok(Self::MeanState),
            word => Self::of_word(word).ok_or_else(|| UnknownFeature {
                found: text.to_owned(),
            }),
        }
    }
}

impl From<FeatureName> for String {
    fn from(name: FeatureName) -> Self {
        name.to_string()
    }
}

impl TryFrom<String> for FeatureName {
    type Error = UnknownFeature;

    /// Reads a name as a contract has it, without the leniency of the command line.
    fn try_from(text: String) -> Result<Self, UnknownFeature> {
        Self::of_word(&text).ok_or(UnknownFeature { found: text })
    }
}

/// What the unit of a feature may be: radians, metres, newtons, a plain number.
pub const UNITS: [&str; 4] = ["rad", "m", "N", "1"];

/// One input of the network. The graph computes `(x - offset) * scale` before its first layer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Feature {
    /// What it is.
    pub name: FeatureName,
    /// The unit of everything below but `scale`, one of [`UNITS`].
    pub unit: String,
    /// Smallest value met in training.
    pub lower: f64,
    /// Largest value met in training.
    pub upper: f64,
    /// Subtracted first.
    pub offset: f64,
    /// Multiplied then, 1 / unit.
    pub scale: f64,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_read_back_and_unknown_ones_say_what_is_known() {
        let reading = |channel: &str| FeatureName::Reading(channel.to_owned());
        let cases = [
            (FeatureName::MeanState, "mean_state"),
            (FeatureName::Entropy, "entropy"),
            (FeatureName::MeanMinusGoal, "mean_minus_goal"),
            (FeatureName::Goal, "goal"),
            (FeatureName::RandomEntropy, "random_entropy"),
            (reading("f_d"), "reading.f_d"),
            (reading("m_p"), "reading.m_p"),
            (reading("finger.tip"), "reading.finger.tip"),
        ];
        for (name, word) in cases {
            assert_eq!(name.to_string(), word);
            assert_eq!(word.parse::<FeatureName>().unwrap(), name);
            let json = format!("\"{word}\"");
            assert_eq!(serde_json::to_string(&name).unwrap(), json);
            assert_eq!(serde_json::from_str::<FeatureName>(&json).unwrap(), name);
        }
        assert_eq!(
            " mean".parse::<FeatureName>().unwrap(),
            FeatureName::MeanState
        );
        for word in ["variance", "", "reading", "reading.", "reading.f d", "Goal"] {
            let fault = word.parse::<FeatureName>().unwrap_err().to_string();
            assert!(fault.contains(&format!("{word:?}")), "{fault}");
            for known in FeatureName::PLAIN {
                assert!(fault.contains(&known.to_string()), "{fault} lacks {known}");
            }
            assert!(fault.contains("reading.f_d"), "{fault}");
        }
        let lenient = serde_json::from_str::<FeatureName>("\"mean\"");
        assert!(lenient.is_err(), "a contract has the whole word");
    }
}
