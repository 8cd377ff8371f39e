//! How a policy was trained.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The paper's method or one of its baselines (§IV-B).
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// PPO on belief summaries.
    #[default]
    Pubs,
    /// PPO with the same network on readings.
    Ppo,
    /// Recurrent PPO on readings, one LSTM layer.
    Lstm1,
    /// Recurrent PPO on readings, two LSTM layers.
    Lstm2,
}

impl Method {
    /// All of them, the paper's own first.
    pub const ALL: [Self; 4] = [Self::Pubs, Self::Ppo, Self::Lstm1, Self::Lstm2];

    /// As in files and after `--method`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pubs => "pubs",
            Self::Ppo => "ppo",
            Self::Lstm1 => "lstm1",
            Self::Lstm2 => "lstm2",
        }
    }

    /// Layers of LSTM in front of the perceptron.
    #[must_use]
    pub fn lstm_layers(self) -> usize {
        match self {
            Self::Pubs | Self::Ppo => 0,
            Self::Lstm1 => 1,
            Self::Lstm2 => 2,
        }
    }

    /// Whether its policy reads a particle filter's belief.
    #[must_use]
    pub fn has_belief(self) -> bool {
        self == Self::Pubs
    }

    // serde hands over references.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    pub(crate) fn is_pubs(&self) -> bool {
        *self == Self::Pubs
    }
}

impl fmt::Display for Method {
    /// As in the paper.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Pubs => "PuBS",
            Self::Ppo => "PPO",
            Self::Lstm1 => "LSTM1",
            Self::Lstm2 => "LSTM2",
        })
    }
}

/// A word that names no method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no method {found:?}; there are {}", Method::ALL.map(Method::name).join(", "))]
pub struct UnknownMethod {
    found: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(text: &str) -> Result<Self, UnknownMethod> {
        let mut all = Self::ALL.into_iter();
        all.find(|method| method.name() == text)
            .ok_or_else(|| UnknownMethod {
                found: text.to_owned(),
            })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_read_back_and_unknown_ones_list_the_known() {
        for method in Method::ALL {
            assert_eq!(method.name().parse::<Method>().unwrap(), method);
            let text = serde_json::to_string(&method).unwrap();
            assert_eq!(text, format!("\"{}\"", method.name()));
        }
        let fault = "lstm3".parse::<Method>().unwrap_err().to_string();
        assert!(
            fault.contains("lstm3") && fault.contains("lstm2"),
            "{fault}"
        );
    }
}
