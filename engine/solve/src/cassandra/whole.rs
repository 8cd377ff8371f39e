//! What can be said only at the end of a file: what is missing, and which rows do not sum to one.

use super::fault::ParseFault;
use super::names::Kind;
use super::parser::Parser;
use super::rows::Table;
use crate::pomdp::{Pomdp, PomdpParts, Rows, SUM_TOLERANCE};

impl Parser<'_> {
    /// The POMDP, or the faults in the order of the file.
    pub(super) fn finish(mut self) -> Result<Pomdp, Vec<ParseFault>> {
        let start = self.states.is_some().then(|| self.initial_belief());
        if self.faults.is_empty() {
            self.check_complete();
        }
        self.check_sums("T", |parser| &parser.transitions);
        self.check_sums("O", |parser| &parser.observation_table);
        if !self.faults.is_empty() {
            self.faults.sort_by_key(|fault| (fault.line, fault.column));
            return Err(self.faults);
        }
        let start = start.and_then(Result::ok).unwrap_or_default();
        let discount = self.discount.map_or(0.0, |discount| discount.0);
        let parts = self.parts(start, discount);
        Pomdp::new(parts).map_err(|error| {
            vec![ParseFault {
                line: 1,
                column: 1,
                message: error.to_string(),
                help: "the file as a whole makes no POMDP".to_owned(),
            }]
        })
    }

    fn check_complete(&mut self) {
        let end = self.tokens.len();
        if self.discount.is_none() {
            self.fault_at(
                end,
                "`discount:` is missing",
                "add a line such as `discount: 0.95`",
            );
        }
        for kind in [Kind::State, Kind::Action, Kind::Observation] {
            if self.names(kind).is_none() {
                let keyword = kind.keyword();
                let message = format!("`{keyword}:` is missing");
                let help = format!("add `{keyword}: 2` or `{keyword}: left right`");
                self.fault_at(end, message, help);
            }
        }
        if !self.has_tables {
            self.fault_at(
                end,
                "there is no `T:`, `O:` or `R:`",
                "add the model's numbers",
            );
            return;
        }
        self.check_written("T", |parser| &parser.transitions);
        self.check_written("O", |parser| &parser.observation_table);
    }

    fn check_written(&mut self, letter: &str, table: impl Fn(&Self) -> &Table) {
        let rows = table(self).rows();
        let mut missing = rows.filter(|row| row.2.written_by.is_none());
        let Some((action, state, _)) = missing.next() else {
            return;
        };
        let more = missing.count();
        let (action, state) = (self.action_name(action), self.state_name(state));
        let others = match more {
            0 => String::new(),
            more => format!(", nor for {more} others"),
        };
        let message = format!(
            "no `{letter}:` says anything for action `{action}` and state `{state}`{others}"
        );
        let help = format!("add `{letter}: {action} : {state}` and its row of probabilities");
        self.fault_at(self.tokens.len(), message, help);
    }

    /// One fault for each place whose entry left rows that do not sum to one.
    fn check_sums(&mut self, letter: &str, table: impl Fn(&Self) -> &Table) {
        let mut wrong: Vec<(usize, String, f64, usize)> = Vec::new();
        for (action, state, row) in table(self).rows() {
            let Some(token) = row.written_by else {
                continue;
            };
            let sum = row.sum();
            if (sum - 1.0).abs() <= SUM_TOLERANCE {
                continue;
            }
            if let Some(same) = wrong.iter_mut().find(|wrong| wrong.0 == token) {
                same.3 += 1;
                continue;
            }
            let (action, state) = (self.action_name(action), self.state_name(state));
            wrong.push((
                token,
                format!("action `{action}` and state `{state}`"),
                sum,
                0,
            ));
        }
        for (token, row, sum, more) in wrong {
            let others = match more {
                0 => String::new(),
                more => format!(" (and {more} more rows that end here)"),
            };
            let sum = (sum * 1e9).round() / 1e9;
            let message = format!("the row of `{letter}:` for {row} sums to {sum}{others}");
            self.fault_at(token, message, "a row of probabilities sums to 1");
        }
    }

    fn action_name(&self, action: usize) -> String {
        self.actions
            .as_ref()
            .map_or_else(String::new, |names| names.list()[action].clone())
    }

    fn state_name(&self, state: usize) -> String {
        self.states
            .as_ref()
            .map_or_else(String::new, |names| names.list()[state].clone())
    }

    fn parts(&self, start: Vec<f64>, discount: f64) -> PomdpParts {
        let list = |kind| {
            self.names(kind)
                .map_or_else(Vec::new, |names| names.list().to_vec())
        };
        let (actions, states) = (self.count(Kind::Action), self.count(Kind::State));
        let tables = |table: &Table| -> Vec<Rows> {
            let row = |action, state| {
                let entries = table.row(action, state).entries.iter();
                entries.map(|entry| (entry.0 as usize, entry.1)).collect()
            };
            let rows = |action| (0..states).map(|state| row(action, state)).collect();
            (0..actions).map(rows).collect()
        };
        let sign = if self.costs { -1.0 } else { 1.0 };
        let reward = |action, state| {
            let row = self.transitions.row(action, state);
            let observations = |next| self.observation_table.row(action, next);
            sign * self.rewards.expected(action, state, row, observations)
        };
        let rewards = |action| (0..states).map(|state| reward(action, state)).collect();
        PomdpParts {
            name: String::new(),
            states: list(Kind::State),
            actions: list(Kind::Action),
            observations: list(Kind::Observation),
            discount,
            start,
            transitions: tables(&self.transitions),
            observation_rows: tables(&self.observation_table),
            rewards: (0..actions).map(rewards).collect(),
        }
    }
}
