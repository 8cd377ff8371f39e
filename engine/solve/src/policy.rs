//! A policy of alpha vectors and its file.
//!
//! The file is one JSON object:
//!
//! | key | what it holds |
//! |---|---|
//! | `format` | `"pubs-solve alpha vectors"` |
//! | `version` | 1 |
//! | `problem` | the problem's name |
//! | `problem_sha256` | SHA-256 over the problem's numbers ([`Pomdp::digest`]) |
//! | `method` | `"qmdp"` or `"sarsop"` |
//! | `lower`, `upper` | bounds on the value of the initial belief |
//! | `discount` | the problem's discount |
//! | `states` | how many states there are |
//! | `actions` | names of the actions |
//! | `origin` | what the problem was made of, by whoever made it; left out for a file of its own |
//! | `alpha_vectors` | a list of `{ "action": index, "values": [one for each state] }` |

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::pomdp::Pomdp;
use crate::solve::Method;

const FORMAT: &str = "pubs-solve alpha vectors";
const VERSION: u32 = 1;

/// A plan's value in each state, and the action that it begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlphaVector {
    /// Index of the action.
    pub action: usize,
    /// One value for each state.
    pub values: Vec<f64>,
}

/// A policy: the action of the alpha vector that is best at the belief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlphaPolicy {
    format: String,
    version: u32,
    problem: String,
    problem_sha256: String,
    method: Method,
    lower: f64,
    upper: f64,
    discount: f64,
    states: usize,
    actions: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Value>,
    alpha_vectors: Vec<AlphaVector>,
}

/// Why a policy file is not taken.
#[derive(Debug, Error)]
pub enum PolicyError {
    /// The file cannot be read or written.
    #[error("cannot {doing} {}", path.display())]
    File {
        /// `read` or `write`.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file does not hold a policy.
    #[error("{} holds no policy of alpha vectors: {reason}; give a .json file that `solve` has written", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The policy was made for another problem.
    #[error(
        "the policy was solved for a problem `{made_for}` with other numbers than `{problem}` has \
         here: solve this problem again"
    )]
    OtherProblem {
        /// The problem in the policy file.
        made_for: String,
        /// The problem at hand.
        problem: String,
    },
}

impl AlphaPolicy {
    /// A policy for `pomdp`. There must be at least one vector, each with a value for each state.
    pub(crate) fn new(
        pomdp: &Pomdp,
        method: Method,
        lower: f64,
        upper: f64,
        alpha_vectors: Vec<AlphaVector>,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            problem: pomdp.name().to_owned(),
            problem_sha256: pomdp.digest(),
            method,
            lower,
            upper,
            discount: pomdp.discount(),
            states: pomdp.states().len(),
            actions: pomdp.actions().to_vec(),
            origin: None,
            alpha_vectors,
        }
    }

    /// The same, with a word on what the problem was made of, so that it can be made again.
    pub fn with_origin(mut self, origin: Value) -> Self {
        self.origin = Some(origin);
        self
    }

    /// What the problem was made of, where it was not a file of its own.
    pub fn origin(&self) -> Option<&Value> {
        self.origin.as_ref()
    }

    /// The index of the action to take at a belief (one probability for each state).
    pub fn choose(&self, belief: &[f64]) -> usize {
        self.best(belief).0
    }

    /// What the vectors promise at a belief. For SARSOP a lower bound on the policy's value there,
    /// for QMDP no bound on what the policy earns.
    pub fn value(&self, belief: &[f64]) -> f64 {
        self.best(belief).1
    }

    fn best(&self, belief: &[f64]) -> (usize, f64) {
        let possible = belief.iter().copied().enumerate();
        let possible: Vec<_> = possible.filter(|entry| entry.1 > 0.0).collect();
        let mut best = (0, f64::NEG_INFINITY);
        for vector in &self.alpha_vectors {
            let parts = possible.iter();
            let value: f64 = parts
                .map(|&(state, weight)| weight * vector.values[state])
                .sum();
            if value > best.1 {
                best = (vector.action, value);
            }
        }
        best
    }

    /// The problem's name.
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// SHA-256 over the problem's numbers, in hexadecimal.
    pub fn problem_sha256(&self) -> &str {
        &self.problem_sha256
    }

    /// The solver that made it.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Bounds on the value of the initial belief, the lower one first.
    pub fn bounds(&self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    /// The problem's discount.
    pub fn discount(&self) -> f64 {
        self.discount
    }

    /// How many states the problem has.
    pub fn states(&self) -> usize {
        self.states
    }

    /// Names of the actions.
    pub fn actions(&self) -> &[String] {
        &self.actions
    }

    /// The vectors.
    pub fn alpha_vectors(&self) -> &[AlphaVector] {
        &self.alpha_vectors
    }

    /// Checks that the policy was made for a problem with these very numbers.
    ///
    /// # Errors
    /// [`PolicyError::OtherProblem`] where it was not.
    pub fn check_problem(&self, pomdp: &Pomdp) -> Result<(), PolicyError> {
        if self.problem_sha256 == pomdp.digest() {
            return Ok(());
        }
        Err(PolicyError::OtherProblem {
            made_for: self.problem.clone(),
            problem: pomdp.name().to_owned(),
        })
    }

    /// Writes the policy file. A file that is there already is replaced whole or not at all.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), PolicyError> {
        let failed = |source| PolicyError::File {
            doing: "write",
            path: path.to_owned(),
            source,
        };
        let text = serde_json::to_string(self).map_err(|error| failed(error.into()))?;
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        fs::write(&part, text).map_err(failed)?;
        fs::rename(&part, path).map_err(failed)
    }

    /// Reads a policy file.
    ///
    /// # Errors
    /// Where the file cannot be read, or holds something else or something broken.
    pub fn read(path: &Path) -> Result<Self, PolicyError> {
        let text = fs::read_to_string(path).map_err(|source| PolicyError::File {
            doing: "read",
            path: path.to_owned(),
            source,
        })?;
        Self::from_json(&text).map_err(|reason| PolicyError::Content {
            path: path.to_owned(),
            reason,
        })
    }

    fn from_json(text: &str) -> Result<Self, String> {
        #[derive(Deserialize)]
        struct Head {
            format: String,
            version: u32,
        }
        let head: Head = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if head.format != FORMAT {
            return Err(format!("its format is `{}`, not `{FORMAT}`", head.format));
        }
        if head.version != VERSION {
            return Err(format!(
                "its version is {}, and this program reads version {VERSION}",
                head.version
            ));
        }
        let policy: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        policy.check()?;
        Ok(policy)
    }

    fn check(&self) -> Result<(), String> {
        if self.alpha_vectors.is_empty() {
            return Err("it has no alpha vector".to_owned());
        }
        for (index, vector) in self.alpha_vectors.iter().enumerate() {
            if vector.action >= self.actions.len() {
                return Err(format!(
                    "alpha vector {index} takes action number {}, and there are {} (from 0)",
                    vector.action,
                    self.actions.len()
                ));
            }
            if vector.values.len() != self.states {
                return Err(format!(
                    "alpha vector {index} has {} values for {} states",
                    vector.values.len(),
                    self.states
                ));
            }
        }
        Ok(())
    }
}
