//! `R:` statements, and the expected reward that they come to.

use std::collections::HashMap;

use super::names::Which;
use super::rows::Row;

/// Rewards of one statement by observation.
enum ByObservation {
    /// The same for all.
    Same(f64),
    /// One number for one observation.
    One(usize, f64),
    /// A number for each.
    Each(Vec<f64>),
}

impl ByObservation {
    fn at(&self, observation: usize) -> Option<f64> {
        match self {
            Self::Same(value) => Some(*value),
            Self::One(place, value) => (*place == observation).then_some(*value),
            Self::Each(values) => Some(values[observation]),
        }
    }
}

/// All `R:` statements so far. A later one takes the place of an earlier one where both hold.
#[derive(Default)]
pub(super) struct Rewards {
    statements: HashMap<[Option<usize>; 3], Vec<(usize, ByObservation)>>,
    count: usize,
}

impl Rewards {
    /// `R: action : state : next : observation value`.
    pub fn set(&mut self, at: [Which; 3], observation: Which, value: f64) {
        let values = match observation {
            Which::All => ByObservation::Same(value),
            Which::One(place) => ByObservation::One(place, value),
        };
        self.push(at, values);
    }

    /// `R: action : state : next` and a value for each observation.
    pub fn set_row(&mut self, at: [Which; 3], values: Vec<f64>) {
        self.push(at, ByObservation::Each(values));
    }

    fn push(&mut self, at: [Which; 3], values: ByObservation) {
        let statements = self.statements.entry(at.map(Which::one)).or_default();
        if !matches!(values, ByObservation::One(..)) {
            statements.clear();
        }
        statements.push((self.count, values));
        self.count += 1;
    }

    /// The expected reward of an action in a state, given the row of T for them and the rows of O
    /// for the action and each next state.
    pub fn expected<'a>(
        &self,
        action: usize,
        state: usize,
        transitions: &Row,
        observations: impl Fn(usize) -> &'a Row,
    ) -> f64 {
        let next = transitions.entries.iter();
        let parts = next.map(|&(next, probability)| {
            let next = next as usize;
            probability * self.after(action, state, next, observations(next))
        });
        parts.sum()
    }

    fn after(&self, action: usize, state: usize, next: usize, observations: &Row) -> f64 {
        let mut matching: Vec<&(usize, ByObservation)> = Vec::new();
        for mask in 0..8 {
            let key = [action, state, next];
            let key = std::array::from_fn(|place| (mask >> place & 1 == 0).then_some(key[place]));
            matching.extend(self.statements.get(&key).into_iter().flatten());
        }
        matching.sort_unstable_by_key(|statement| std::cmp::Reverse(statement.0));
        if let Some((_, ByObservation::Same(value))) = matching.first() {
            return *value;
        }
        let value_at = |observation: usize| {
            let values = matching.iter().map(|statement| &statement.1);
            values
                .filter_map(|values| values.at(observation))
                .next()
                .unwrap_or(0.0)
        };
        let entries = observations.entries.iter();
        entries
            .map(|&(observation, likelihood)| likelihood * value_at(observation as usize))
            .sum()
    }
}
