//! What a policy reads: by its method (§IV-B) and by the ablation of its entropy (§IV-D).

use std::str::FromStr;

use pubs_core::Input;
use pubs_policy::Method;
use pubs_train::surrogate::Goals;
use serde::{Deserialize, Serialize};

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

/// A word that names no entropy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no entropy {found:?}; there are {}", EntropyInput::ALL.map(EntropyInput::name).join(", "))]
pub struct UnknownEntropy {
    found: String,
}

impl FromStr for EntropyInput {
    type Err = UnknownEntropy;

    fn from_str(text: &str) -> Result<Self, UnknownEntropy> {
        let mut all = Self::ALL.into_iter();
        all.find(|entropy| entropy.name() == text)
            .ok_or_else(|| UnknownEntropy {
                found: text.to_owned(),
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
        for entropy in EntropyInput::ALL {
            assert_eq!(entropy.name().parse::<EntropyInput>().unwrap(), entropy);
        }
        let fault = "some".parse::<EntropyInput>().unwrap_err().to_string();
        assert!(
            fault.contains("some") && fault.contains("random"),
            "{fault}"
        );
    }
}
