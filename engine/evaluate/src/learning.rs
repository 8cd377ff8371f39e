//! The learning curves of a training, kept beside the policy: `NAME.training.json`.
//!
//! They are not in the policy file, whose metadata is a contract that older engines read and refuse
//! where it says more than they know.

use std::path::{Path, PathBuf};

use pubs_train::Progress;
use serde::{Deserialize, Serialize};

use crate::candidates::Candidate;
use crate::evaluation::{Evaluation, Figures};

/// The version of the layout.
const FORMAT: u32 = 1;

/// What a training left behind beside its policy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearningCurves {
    /// Version of the layout.
    pub format: u32,
    /// Of the policy's weights: whether this file belongs to that policy.
    pub policy_sha256: String,
    /// The seed that was kept.
    pub best: u64,
    /// The kept policy on fresh trials.
    pub evaluation: Figures,
    /// Each seed in turn.
    pub seeds: Vec<SeedCurve>,
}

/// How the training of one seed went. The lists are of one length; means are over the latest 1,000
/// episodes, and null until the first one has finished.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeedCurve {
    /// The seed.
    pub seed: u64,
    /// Its policy on the trials on which seeds are compared.
    pub selection: Figures,
    /// Steps of the surrogate so far.
    pub steps: Vec<usize>,
    /// Mean undiscounted return of an episode.
    pub mean_return: Vec<Option<f32>>,
    /// Share of episodes that ended in success.
    pub success_rate: Vec<Option<f32>>,
    /// Share of episodes with a safety violation.
    pub violation_rate: Vec<Option<f32>>,
}

/// Why there are no curves although there is a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LearningFileError {
    /// The operating system says no.
    #[error("{} cannot be read: {reason}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What it says.
        reason: String,
    },
    /// It holds something else.
    #[error("{} holds no learning curves of this version: {reason}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// It is of another training.
    #[error("{} belongs to another policy; train again with --overwrite to have both anew", file.display())]
    OtherPolicy {
        /// The file.
        file: PathBuf,
    },
}

impl LearningCurves {
    /// Those of a training that kept the candidate `best`.
    pub fn of(
        policy_sha256: &str,
        candidates: &[Candidate],
        best: usize,
        evaluation: &Evaluation,
    ) -> Self {
        Self {
            format: FORMAT,
            policy_sha256: policy_sha256.to_owned(),
            best: candidates[best].seed,
            evaluation: evaluation.figures,
            seeds: candidates.iter().map(SeedCurve::of).collect(),
        }
    }

    /// Where the curves of a policy lie.
    pub fn file_of(policy: &Path) -> PathBuf {
        policy.with_extension("training.json")
    }

    /// Writes them beside the policy.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn write(&self, policy: &Path) -> std::io::Result<()> {
        let text = serde_json::to_string(self).map_err(std::io::Error::other)?;
        std::fs::write(Self::file_of(policy), text)
    }

    /// Those of the policy with these weights; `None` where none were kept.
    ///
    /// # Errors
    /// [`LearningFileError`].
    pub fn read(policy: &Path, policy_sha256: &str) -> Result<Option<Self>, LearningFileError> {
        let file = Self::file_of(policy);
        let text = match std::fs::read_to_string(&file) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => {
                let reason = error.to_string();
                return Err(LearningFileError::Read { file, reason });
            }
        };
        let curves = serde_json::from_str::<Self>(&text)
            .map_err(|error| error.to_string())
            .and_then(Self::checked);
        match curves {
            Err(reason) => Err(LearningFileError::Content { file, reason }),
            Ok(curves) if curves.policy_sha256 != policy_sha256 => {
                Err(LearningFileError::OtherPolicy { file })
            }
            Ok(curves) => Ok(Some(curves)),
        }
    }

    fn checked(self) -> Result<Self, String> {
        if self.format != FORMAT {
            return Err(format!("format {} in place of {FORMAT}", self.format));
        }
        let odd = self.seeds.iter().find(|curve| !curve.is_even());
        match odd {
            Some(curve) => Err(format!("the lists of seed {} differ in length", curve.seed)),
            None => Ok(self),
        }
    }
}

impl SeedCurve {
    fn of(candidate: &Candidate) -> Self {
        let curve = candidate.curve();
        let each = |value: fn(&Progress) -> Option<f32>| curve.iter().map(value).collect();
        Self {
            seed: candidate.seed,
            selection: candidate.evaluation.figures,
            steps: curve.iter().map(|progress| progress.steps).collect(),
            mean_return: each(|progress| progress.mean_return),
            success_rate: each(|progress| progress.success_rate),
            violation_rate: each(|progress| progress.violation_rate),
        }
    }

    fn is_even(&self) -> bool {
        let lists = [&self.mean_return, &self.success_rate, &self.violation_rate];
        lists.iter().all(|list| list.len() == self.steps.len())
    }
}
