//! A discrete POMDP and the checks that make one.

use sha2::{Digest, Sha256};
use thiserror::Error;

use crate::sparse::SparseRows;

/// How far from one a row of probabilities may sum; within it the row is scaled to one. Files in
/// use print 1/870 with six decimals, which a sum over 870 states shows.
pub const SUM_TOLERANCE: f64 = 1e-3;

/// Each row as its (column, probability), in any order; columns left out are zero.
pub type Rows = Vec<Vec<(usize, f64)>>;

/// What a [`Pomdp`] is made of. Indices are positions in the lists of names.
#[derive(Clone, Debug)]
pub struct PomdpParts {
    /// What the problem is called; kept in policies made for it.
    pub name: String,
    /// Names of the states.
    pub states: Vec<String>,
    /// Names of the actions.
    pub actions: Vec<String>,
    /// Names of the observations.
    pub observations: Vec<String>,
    /// The discount, in [0, 1).
    pub discount: f64,
    /// The initial belief, one probability for each state.
    pub start: Vec<f64>,
    /// T: for each action, a row for each state with the probabilities of the next states.
    pub transitions: Vec<Rows>,
    /// Z: for each action, a row for each *next* state with the probabilities of observations.
    pub observation_rows: Vec<Rows>,
    /// R: for each action, the expected reward in each state.
    pub rewards: Vec<Vec<f64>>,
}

/// A discrete POMDP whose numbers hold together. A terminal state is one with a self-loop and
/// reward 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Pomdp {
    name: String,
    states: Vec<String>,
    actions: Vec<String>,
    observations: Vec<String>,
    discount: f64,
    start: Vec<f64>,
    pub(crate) transitions: Vec<SparseRows>,
    pub(crate) observation_rows: Vec<SparseRows>,
    pub(crate) rewards: Vec<Vec<f64>>,
}

/// Why parts make no POMDP.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PomdpError {
    /// A list of names is empty.
    #[error("a POMDP needs at least one {0}")]
    Empty(&'static str),
    /// The discount does not make sums of rewards finite.
    #[error(
        "the discount is {0}: it must be at least 0 and below 1, or the value of a policy that \
         never ends has no bound"
    )]
    Discount(f64),
    /// A list or table has the wrong length.
    #[error("{what} has {found} entries, {wanted} are needed")]
    Length {
        /// The list or table.
        what: String,
        /// Its length.
        found: usize,
        /// The length it should have.
        wanted: usize,
    },
    /// An entry names a column that is not there.
    #[error("{row} names number {column}, but there are {count} (numbers begin at 0)")]
    Column {
        /// The row.
        row: String,
        /// The column that it names.
        column: usize,
        /// How many there are.
        count: usize,
    },
    /// A probability is negative, above one, or not a number.
    #[error("{row} holds the probability {value}: probabilities lie from 0 to 1")]
    Probability {
        /// The row.
        row: String,
        /// The entry.
        value: f64,
    },
    /// A row of probabilities does not sum to one.
    #[error("{row} sums to {sum}, not to 1 (within {SUM_TOLERANCE})")]
    Sum {
        /// The row.
        row: String,
        /// Its sum.
        sum: f64,
    },
    /// A reward is infinite or not a number.
    #[error("the reward of action `{action}` in state `{state}` is {value}, not a finite number")]
    Reward {
        /// The action.
        action: String,
        /// The state.
        state: String,
        /// The reward.
        value: f64,
    },
}

impl Pomdp {
    /// Checks the parts and scales each row of probabilities to a sum of exactly one.
    ///
    /// # Errors
    /// The first thing found that does not hold together.
    pub fn new(parts: PomdpParts) -> Result<Self, PomdpError> {
        check_counts(&parts)?;
        let PomdpParts {
            name,
            states,
            actions,
            observations,
            discount,
            mut start,
            transitions,
            observation_rows,
            rewards,
        } = parts;
        let start_row: Vec<_> = start.iter().copied().enumerate().collect();
        let scaled = scaled_row(start_row, states.len(), || "the initial belief".to_owned())?;
        start.fill(0.0);
        for (state, probability) in scaled {
            start[state] = probability;
        }
        let table = |tables: Vec<Rows>, width: usize, what: &str| {
            let each = tables.into_iter().zip(&actions).map(|(rows, action)| {
                let rows = rows.into_iter().zip(&states).map(|(row, state)| {
                    scaled_row(row, width, || {
                        format!("the row of {what} for action `{action}` and state `{state}`")
                    })
                });
                Ok(SparseRows::new(&rows.collect::<Result<Vec<_>, _>>()?))
            });
            each.collect::<Result<Vec<_>, PomdpError>>()
        };
        let transitions = table(transitions, states.len(), "transitions")?;
        let observation_rows = table(observation_rows, observations.len(), "observations")?;
        for (row, action) in rewards.iter().zip(&actions) {
            for (&value, state) in row.iter().zip(&states) {
                if !value.is_finite() {
                    return Err(PomdpError::Reward {
                        action: action.clone(),
                        state: state.clone(),
                        value,
                    });
                }
            }
        }
        Ok(Self {
            name,
            states,
            actions,
            observations,
            discount,
            start,
            transitions,
            observation_rows,
            rewards,
        })
    }

    /// What the problem is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The same problem by another name, such as that of its file.
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Names of the states.
    pub fn states(&self) -> &[String] {
        &self.states
    }

    /// Names of the actions.
    pub fn actions(&self) -> &[String] {
        &self.actions
    }

    /// Names of the observations.
    pub fn observations(&self) -> &[String] {
        &self.observations
    }

    /// The discount, in [0, 1).
    pub fn discount(&self) -> f64 {
        self.discount
    }

    /// The initial belief.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The next states that are possible, and how probable each is.
    pub fn transition(
        &self,
        action: usize,
        state: usize,
    ) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.transitions[action].entries(state)
    }

    /// The observations that are possible after an action that led to `next`.
    pub fn observation(
        &self,
        action: usize,
        next: usize,
    ) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.observation_rows[action].entries(next)
    }

    /// The expected reward of an action in a state.
    pub fn reward(&self, action: usize, state: usize) -> f64 {
        self.rewards[action][state]
    }

    /// True where no action leaves the state and none is rewarded.
    pub fn is_terminal(&self, state: usize) -> bool {
        (0..self.actions.len()).all(|action| {
            self.rewards[action][state] == 0.0
                && self
                    .transition(action, state)
                    .all(|(next, _)| next == state)
        })
    }

    /// SHA-256, in hexadecimal, over the problem's numbers (not its names): two problems that
    /// share it share their policies.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for count in [
            self.states.len(),
            self.actions.len(),
            self.observations.len(),
        ] {
            hash.update((count as u64).to_le_bytes());
        }
        hash.update(self.discount.to_le_bytes());
        for value in &self.start {
            hash.update(value.to_le_bytes());
        }
        for table in self.transitions.iter().chain(&self.observation_rows) {
            for row in 0..table.len() {
                let (columns, values) = table.row(row);
                hash.update((columns.len() as u64).to_le_bytes());
                for (column, value) in columns.iter().zip(values) {
                    hash.update(column.to_le_bytes());
                    hash.update(value.to_le_bytes());
                }
            }
        }
        for value in self.rewards.iter().flatten() {
            hash.update(value.to_le_bytes());
        }
        let bytes = hash.finalize();
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

fn check_counts(parts: &PomdpParts) -> Result<(), PomdpError> {
    let (states, actions) = (parts.states.len(), parts.actions.len());
    for (count, what) in [
        (states, "state"),
        (actions, "action"),
        (parts.observations.len(), "observation"),
    ] {
        if count == 0 {
            return Err(PomdpError::Empty(what));
        }
    }
    if !(0.0..1.0).contains(&parts.discount) {
        return Err(PomdpError::Discount(parts.discount));
    }
    let length = |what: &str, found: usize, wanted: usize| {
        if found == wanted {
            return Ok(());
        }
        Err(PomdpError::Length {
            what: what.to_owned(),
            found,
            wanted,
        })
    };
    length("the initial belief", parts.start.len(), states)?;
    length("the table of transitions", parts.transitions.len(), actions)?;
    length(
        "the table of observations",
        parts.observation_rows.len(),
        actions,
    )?;
    length("the table of rewards", parts.rewards.len(), actions)?;
    for (index, action) in parts.actions.iter().enumerate() {
        for (what, found) in [
            ("transitions", parts.transitions[index].len()),
            ("observations", parts.observation_rows[index].len()),
            ("rewards", parts.rewards[index].len()),
        ] {
            length(&format!("{what} of action `{action}`"), found, states)?;
        }
    }
    Ok(())
}

/// Sorts a row, drops its zeros, joins columns named twice and scales it to one.
fn scaled_row(
    mut row: Vec<(usize, f64)>,
    width: usize,
    name: impl Fn() -> String,
) -> Result<Vec<(usize, f64)>, PomdpError> {
    for &(column, value) in &row {
        if column >= width {
            return Err(PomdpError::Column {
                row: name(),
                column,
                count: width,
            });
        }
        if !(0.0..=1.0 + SUM_TOLERANCE).contains(&value) {
            return Err(PomdpError::Probability { row: name(), value });
        }
    }
    // An empty sum is -0, which reads badly.
    let sum = row.iter().map(|entry| entry.1).sum::<f64>() + 0.0;
    if (sum - 1.0).abs() > SUM_TOLERANCE {
        return Err(PomdpError::Sum { row: name(), sum });
    }
    row.retain(|entry| entry.1 > 0.0);
    row.sort_by_key(|entry| entry.0);
    row.dedup_by(|later, earlier| {
        let same = later.0 == earlier.0;
        if same {
            earlier.1 += later.1;
        }
        same
    });
    // A row that is whole already keeps its bits.
    if (sum - 1.0).abs() > 1e-12 {
        row.iter_mut().for_each(|entry| entry.1 /= sum);
    }
    Ok(row)
}
