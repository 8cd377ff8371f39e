//! The named inputs of a policy.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What one input of the network is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FeatureName {
    /// Mean joint state of the belief, rad, m or plain.
    MeanState,
    /// Shannon entropy of the particle weights over ln N, in \[0, 1\].
    Entropy,
    /// Mean joint state minus the goal, for a policy that serves every goal.
    MeanMinusGoal,
}

impl FeatureName {
    /// Every feature, in the order a policy file uses.
    pub const ALL: [Self; 3] = [Self::MeanState, Self::Entropy, Self::MeanMinusGoal];

    /// The name in files and messages.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::MeanState => "mean_state",
            Self::Entropy => "entropy",
            Self::MeanMinusGoal => "mean_minus_goal",
        }
    }
}

impl fmt::Display for FeatureName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.as_str())
    }
}

/// A word that names no feature.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "no input is called {found:?}; known are mean_state (or mean), entropy and mean_minus_goal"
)]
pub struct UnknownFeature {
    found: String,
}

impl FromStr for FeatureName {
    type Err = UnknownFeature;

    /// Reads a name as `--inputs` has it; `mean` is short for `mean_state`.
    fn from_str(text: &str) -> Result<Self, UnknownFeature> {
        let word = text.trim();
        if word == "mean" {
            return Ok(Self::MeanState);
        }
        Self::ALL
            .into_iter()
            .find(|name| name.as_str() == word)
            .ok_or_else(|| UnknownFeature {
                found: text.to_owned(),
            })
    }
}

/// What the unit of a feature may be: radians, metres, a plain number.
pub const UNITS: [&str; 3] = ["rad", "m", "1"];

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
        for name in FeatureName::ALL {
            assert_eq!(name.as_str().parse::<FeatureName>().unwrap(), name);
            assert_eq!(serde_json::to_string(&name).unwrap(), format!("\"{name}\""));
        }
        assert_eq!(
            " mean".parse::<FeatureName>().unwrap(),
            FeatureName::MeanState
        );
        let fault = "variance".parse::<FeatureName>().unwrap_err().to_string();
        assert!(
            fault.contains("variance") && fault.contains("mean_minus_goal"),
            "{fault}"
        );
    }
}
