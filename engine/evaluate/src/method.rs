//! How a policy is trained, and what it reads for that: the method, its baselines (§IV-B) and its
//! ablations (§IV-D).

use std::fmt;
use std::str::FromStr;

use pubs_core::Input;
use pubs_train::surrogate::Goals;
use serde::{Deserialize, Serialize};

/// How a policy is trained, §IV-B.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// On belief summaries.
    Pubs,
    /// The same network on raw observations.
    Ppo,
    /// One LSTM layer of 256 units, on raw observations.
    Lstm1,
    /// Two of them.
    Lstm2,
}

/// What the policy sees in the place of the belief's entropy, §IV-D.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EntropyInput {
    /// The entropy: no ablation.
    Belief,
    /// A number drawn from [0, 1].
    Random,
    /// Nothing.
    None,
}

/// Units of each LSTM layer, §IV-B.
pub const LSTM_WIDTH: usize = 256;

impl Method {
    /// All of them, the paper's own first.
    pub const ALL: [Self; 4] = [Self::Pubs, Self::Ppo, Self::Lstm1, Self::Lstm2];

    /// As in files and after `--method`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pubs => "pubs",
            Self::Ppo => "ppo",
            Self::Lstm1 => "lstm1",
            Self::Lstm2 => "lstm2",
        }
    }

    /// Layers of LSTM in front of the perceptron.
    pub fn lstm_layers(self) -> usize {
        match self {
            Self::Pubs | Self::Ppo => 0,
            Self::Lstm1 => 1,
            Self::Lstm2 => 2,
        }
    }

    /// Whether its policy reads a particle filter's belief.
    pub fn has_belief(self) -> bool {
        self == Self::Pubs
    }
}

impl EntropyInput {
    /// All of them, the one without ablation first.
    pub const ALL: [Self; 3] = [Self::Belief, Self::Random, Self::None];

    /// As in files and after `--entropy`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Belief => "belief",
            Self::Random => "random",
            Self::None => "none",
        }
    }
}

/// What a policy reads, in order; `channels` counts those of the observation model.
pub fn inputs_of(
    method: Method,
    entropy: EntropyInput,
    goals: Goals,
    channels: usize,
) -> Vec<Input> {
    let every = goals == Goals::Every;
    if !method.has_belief() {
        let readings = (0..channels).map(Input::Reading);
        return readings.chain(every.then_some(Input::Goal)).collect();
    }
    let entropy = match entropy {
        EntropyInput::Belief => Some(Input::Entropy),
        EntropyInput::Random => Some(Input::RandomEntropy),
        EntropyInput::None => None,
    };
    [
        Some(Input::MeanState),
        entropy,
        every.then_some(Input::MeanMinusGoal),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A word that names no method or no entropy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} {found:?}; there are {}", known.join(", "))]
pub struct UnknownWord {
    what: &'static str,
    found: String,
    known: Vec<&'static str>,
}

impl FromStr for Method {
    type Err = UnknownWord;

    fn from_str(text: &str) -> Result<Self, UnknownWord> {
        find("method", text, &Self::ALL, Self::name)
    }
}

impl FromStr for EntropyInput {
    type Err = UnknownWord;

    fn from_str(text: &str) -> Result<Self, UnknownWord> {
        find("entropy", text, &Self::ALL, Self::name)
    }
}

fn find<T: Copy>(
    what: &'static str,
    text: &str,
    all: &[T],
    name: fn(T) -> &'static str,
) -> Result<T, UnknownWord> {
    let found = all.iter().copied().find(|one| name(*one) == text);
    found.ok_or_else(|| UnknownWord {
        what,
        found: text.to_owned(),
        known: all.iter().copied().map(name).collect(),
    })
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn each_method_reads_what_the_paper_gives_it() {
        use Input::{Entropy, Goal, MeanMinusGoal, MeanState, RandomEntropy, Reading};
        let one = Goals::One(0.5);
        let cases = [
            (
                Method::Pubs,
                EntropyInput::Belief,
                one,
                vec![MeanState, Entropy],
            ),
            (
                Method::Pubs,
                EntropyInput::Belief,
                Goals::Every,
                vec![MeanState, Entropy, MeanMinusGoal],
            ),
            (
                Method::Pubs,
                EntropyInput::Random,
                one,
                vec![MeanState, RandomEntropy],
            ),
            (Method::Pubs, EntropyInput::None, one, vec![MeanState]),
            (
                Method::Ppo,
                EntropyInput::Belief,
                one,
                vec![Reading(0), Reading(1)],
            ),
            (
                Method::Lstm2,
                EntropyInput::Belief,
                Goals::Every,
                vec![Reading(0), Reading(1), Goal],
            ),
        ];
        for (method, entropy, goals, expected) in cases {
            let found = inputs_of(method, entropy, goals, 2);
            assert_eq!(found, expected, "{method}, entropy {entropy:?}, {goals:?}");
        }
    }

    #[test]
    fn names_read_back_and_unknown_ones_list_the_known() {
        for method in Method::ALL {
            assert_eq!(method.name().parse::<Method>().unwrap(), method);
        }
        for entropy in EntropyInput::ALL {
            assert_eq!(entropy.name().parse::<EntropyInput>().unwrap(), entropy);
        }
        let fault = "lstm3".parse::<Method>().unwrap_err().to_string();
        assert!(
            fault.contains("lstm3") && fault.contains("lstm2"),
            "{fault}"
        );
    }
}
