//! The lower bound: the best of a set of alpha vectors.

use std::rc::Rc;

use crate::pomdp::Pomdp;

/// A plan's value in each state, and the action that it begins with.
pub(super) struct Alpha {
    /// Ascending in the order of making: says which vectors someone has seen.
    pub id: u32,
    pub action: usize,
    pub values: Box<[f64]>,
    /// Ids of the vectors that the plan goes on with, one for each observation; none where it
    /// repeats its action for ever.
    follow: Box<[u32]>,
}

/// The vectors in use, in ascending order of their ids, and all that were ever made: a plan may go
/// on with a vector that was pruned since.
pub(super) struct LowerBound {
    live: Vec<Rc<Alpha>>,
    made: Vec<Rc<Alpha>>,
}

impl LowerBound {
    /// Begins with one vector for each action.
    pub fn new(blind: Vec<Vec<f64>>) -> Self {
        let mut bound = Self {
            live: Vec::new(),
            made: Vec::new(),
        };
        for (action, values) in blind.into_iter().enumerate() {
            bound.insert(action, values, &[]);
        }
        bound
    }

    /// Adds the vector of a plan and drops those that it is nowhere below.
    pub fn insert(&mut self, action: usize, values: Vec<f64>, follow: &[u32]) -> Rc<Alpha> {
        self.live
            .retain(|other| other.values.iter().zip(&values).any(|(old, new)| old > new));
        let alpha = Rc::new(Alpha {
            id: self.next_id(),
            action,
            values: values.into_boxed_slice(),
            follow: follow.into(),
        });
        self.made.push(Rc::clone(&alpha));
        self.live.push(Rc::clone(&alpha));
        alpha
    }

    /// All vectors in use.
    pub fn live(&self) -> &[Rc<Alpha>] {
        &self.live
    }

    /// Those made since `seen`, which is a value that [`Self::next_id`] once had.
    pub fn since(&self, seen: u32) -> &[Rc<Alpha>] {
        let first = self.live.partition_point(|alpha| alpha.id < seen);
        &self.live[first..]
    }

    /// The id that the next vector gets.
    pub fn next_id(&self) -> u32 {
        self.made.len() as u32
    }

    /// A plan's vector with all that it goes on with, to the end: following the best of these is
    /// worth at least what the first one says, which those in use alone do not promise. With them
    /// the plans that repeat one action, for beliefs where the plan never leads.
    pub fn whole_plan(&self, first: &Alpha) -> Vec<Rc<Alpha>> {
        let mut needed: Vec<bool> = self
            .made
            .iter()
            .map(|alpha| alpha.follow.is_empty())
            .collect();
        let mut open = vec![first.id];
        needed[first.id as usize] = true;
        while let Some(id) = open.pop() {
            for &next in &self.made[id as usize].follow {
                if !std::mem::replace(&mut needed[next as usize], true) {
                    open.push(next);
                }
            }
        }
        let all = self.made.iter().zip(needed);
        all.filter(|(_, needed)| *needed)
            .map(|(alpha, _)| Rc::clone(alpha))
            .collect()
    }

    /// Keeps the vectors whose ids are in `keep` (ascending).
    pub fn retain(&mut self, keep: &[u32]) {
        self.live
            .retain(|alpha| keep.binary_search(&alpha.id).is_ok());
    }
}

/// Adds `weight` times the row of observations of each next state to `out`.
#[inline]
pub(super) fn add_observations(
    pomdp: &Pomdp,
    action: usize,
    next: usize,
    weight: f64,
    out: &mut [f64],
) {
    let (columns, values) = pomdp.observation_rows[action].row(next);
    if columns.len() == out.len() {
        for (sum, value) in out.iter_mut().zip(values) {
            *sum += weight * value;
        }
        return;
    }
    for (&column, value) in columns.iter().zip(values) {
        out[column as usize] += weight * value;
    }
}

/// The vector of doing `action` and then following, after each observation, the vector that
/// `follow` has for it.
pub(super) fn backed_up(pomdp: &Pomdp, action: usize, follow: &[&Alpha]) -> Vec<f64> {
    let observations = &pomdp.observation_rows[action];
    let future: Vec<f64> = (0..pomdp.states().len())
        .map(|next| {
            let entries = observations.entries(next);
            entries
                .map(|(observation, likelihood)| likelihood * follow[observation].values[next])
                .sum()
        })
        .collect();
    let transitions = &pomdp.transitions[action];
    let rewards = pomdp.rewards[action].iter().enumerate();
    rewards
        .map(|(state, reward)| reward + pomdp.discount() * transitions.dot(state, &future))
        .collect()
}
