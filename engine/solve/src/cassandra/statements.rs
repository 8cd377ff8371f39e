//! `T:`, `O:` and `R:`.

use super::names::{Kind, Which};
use super::parser::{Broken, Parser};
use super::rows::Table;
use crate::pomdp::SUM_TOLERANCE;

/// Which of the two tables of probabilities.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Transitions,
    Observations,
}

impl Of {
    fn column(self) -> Kind {
        match self {
            Self::Transitions => Kind::State,
            Self::Observations => Kind::Observation,
        }
    }
}

impl Parser<'_> {
    pub(super) fn read_transition(&mut self, keyword: usize) -> Result<(), Broken> {
        self.begin_tables(keyword)?;
        self.read_probabilities(Of::Transitions)
    }

    pub(super) fn read_observation(&mut self, keyword: usize) -> Result<(), Broken> {
        self.begin_tables(keyword)?;
        self.read_probabilities(Of::Observations)
    }

    /// The names must be known, and are fixed from here on.
    fn begin_tables(&mut self, keyword: usize) -> Result<(), Broken> {
        if !self.has_tables {
            for kind in [Kind::State, Kind::Action, Kind::Observation] {
                if self.names(kind).is_none() {
                    return Err(self.undeclared(keyword, kind));
                }
            }
            let (actions, states) = (self.count(Kind::Action), self.count(Kind::State));
            self.transitions = Table::new(actions, states);
            self.observation_table = Table::new(actions, states);
            self.has_tables = true;
        }
        self.colon()
    }

    /// Says so once, and reads no further: every later statement would say it again.
    fn undeclared(&mut self, keyword: usize, kind: Kind) -> Broken {
        let name = kind.keyword();
        let message = format!("`{name}:` is missing before this statement");
        let help = format!("declare them above: `{name}: 2` or `{name}: left right`");
        self.fault_at(keyword, message, help);
        self.at = self.tokens.len();
        Broken
    }

    fn read_probabilities(&mut self, of: Of) -> Result<(), Broken> {
        let actions = self.which(Kind::Action)?;
        if !self.takes(":") {
            return self.read_matrix(of, actions);
        }
        let states = self.which(Kind::State)?;
        if !self.takes(":") {
            return self.read_row(of, actions, states);
        }
        // Some files put a colon before the values of a row.
        if self.is_row_ahead(of) {
            return self.read_row(of, actions, states);
        }
        let columns = self.which(of.column())?;
        // As some programs write it.
        self.takes(":");
        let token = self.at;
        let value = self.probability()?;
        self.ends("the probability")?;
        let count = self.count(of.column());
        self.write(of, actions, states, |row| {
            for column in columns.range(count) {
                row.set(column, value, token);
            }
        });
        Ok(())
    }

    /// Whether a row's values stand here, where the name of a column could stand.
    fn is_row_ahead(&self, of: Of) -> bool {
        let text = |ahead: usize| self.tokens.get(self.at + ahead).map(|token| token.text);
        let Some(first) = text(0) else { return false };
        let is_number = |text: &str| text.parse::<f64>().is_ok();
        let names = self.names(of.column());
        if first != "*" && names.is_none_or(|names| names.find(first).is_none()) {
            return is_number(first) || matches!(first, "uniform" | "reset");
        }
        let count = self.count(of.column());
        count > 2 && (0..count).all(|ahead| text(ahead).is_some_and(is_number))
    }

    fn read_row(&mut self, of: Of, actions: Which, states: Which) -> Result<(), Broken> {
        let width = self.count(of.column());
        let values = if self.takes("uniform") {
            self.ends("`uniform`")?;
            vec![1.0 / width as f64; width]
        } else if of == Of::Transitions && self.takes("reset") {
            self.ends("`reset`")?;
            self.initial_belief()?
        } else {
            self.probabilities(width, "a row")?
        };
        let last = self.at - 1;
        self.write(of, actions, states, |row| {
            row.replace(values.iter().copied(), last);
        });
        Ok(())
    }

    fn read_matrix(&mut self, of: Of, actions: Which) -> Result<(), Broken> {
        let (height, width) = (self.count(Kind::State), self.count(of.column()));
        let token = self.at;
        if self.takes("uniform") {
            self.ends("`uniform`")?;
            let share = 1.0 / width as f64;
            self.write(of, actions, Which::All, |row| {
                row.replace((0..width).map(|_| share), token);
            });
            return Ok(());
        }
        if height == width && self.takes("identity") {
            self.ends("`identity`")?;
            for state in 0..height {
                self.write(of, actions, Which::One(state), |row| {
                    row.entries.clear();
                    row.set(state, 1.0, token);
                });
            }
            return Ok(());
        }
        let mut rows = Vec::with_capacity(height);
        for _ in 0..height {
            let values = self.row_of_matrix(height, width)?;
            rows.push((values, self.at - 1));
        }
        self.ends("the matrix")?;
        for (state, (values, last)) in rows.into_iter().enumerate() {
            self.write(of, actions, Which::One(state), |row| {
                row.replace(values.iter().copied(), last);
            });
        }
        Ok(())
    }

    fn row_of_matrix(&mut self, height: usize, width: usize) -> Result<Vec<f64>, Broken> {
        let what = format!("a matrix of {height} rows of {width}");
        (0..width).map(|_| self.entry(&what)).collect()
    }

    fn entry(&mut self, what: &str) -> Result<f64, Broken> {
        if self.is_at_end() {
            return Err(self.too_few(what));
        }
        self.probability()
    }

    fn too_few(&mut self, what: &str) -> Broken {
        let message = format!("{} stands inside {what}", self.found(self.at));
        self.fault_at(self.at, message, "give all of its numbers")
    }

    fn write(
        &mut self,
        of: Of,
        actions: Which,
        states: Which,
        mut change: impl FnMut(&mut super::rows::Row),
    ) {
        let counts = (self.count(Kind::Action), self.count(Kind::State));
        let table = match of {
            Of::Transitions => &mut self.transitions,
            Of::Observations => &mut self.observation_table,
        };
        for action in actions.range(counts.0) {
            for state in states.range(counts.1) {
                change(table.row_mut(action, state));
            }
        }
    }

    /// Reads one probability.
    pub(super) fn probability(&mut self) -> Result<f64, Broken> {
        let token = self.at;
        let value = self.any_number()?;
        if (0.0..=1.0 + SUM_TOLERANCE).contains(&value) {
            return Ok(value);
        }
        let message = format!("{value} is no probability");
        Err(self.fault_at(token, message, "probabilities lie from 0 to 1"))
    }

    fn any_number(&mut self) -> Result<f64, Broken> {
        let token = self.at;
        if let Some(value) = self.number() {
            return Ok(value);
        }
        let message = format!("{} stands where a number should", self.found(token));
        let help = "numbers are written as 1, 0.25, .25 or 2.5e-1";
        Err(self.fault_at(token, message, help))
    }

    fn probabilities(&mut self, count: usize, what: &str) -> Result<Vec<f64>, Broken> {
        let mut values = Vec::with_capacity(count);
        while !self.is_at_end() {
            if values.len() == count {
                let message = format!("{} is one more than {what} of {count}", self.found(self.at));
                return Err(self.fault_at(self.at, message, "take it away"));
            }
            values.push(self.probability()?);
        }
        self.check_count(&values, count, what)?;
        Ok(values)
    }

    fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, Broken> {
        let mut values = Vec::with_capacity(count);
        while !self.is_at_end() {
            if values.len() == count {
                let message = format!("{} is one more than {what} of {count}", self.found(self.at));
                return Err(self.fault_at(self.at, message, "take it away"));
            }
            values.push(self.any_number()?);
        }
        self.check_count(&values, count, what)?;
        Ok(values)
    }

    fn check_count(&mut self, values: &[f64], count: usize, what: &str) -> Result<(), Broken> {
        if values.len() == count {
            return Ok(());
        }
        let message = format!(
            "{what} has {} numbers, and {count} are needed",
            values.len()
        );
        Err(self.fault_at(self.at - 1, message, "add those that are missing"))
    }

    pub(super) fn read_reward(&mut self, keyword: usize) -> Result<(), Broken> {
        self.begin_tables(keyword)?;
        let action = self.which(Kind::Action)?;
        self.colon()?;
        let state = self.which(Kind::State)?;
        let observations = self.count(Kind::Observation);
        if !self.takes(":") {
            let states = self.count(Kind::State);
            let values = self.numbers(states * observations, "a matrix")?;
            for (next, row) in values.chunks_exact(observations).enumerate() {
                self.rewards
                    .set_row([action, state, Which::One(next)], row.to_vec());
            }
            return Ok(());
        }
        let next = self.which(Kind::State)?;
        let at = [action, state, next];
        if !self.takes(":") {
            let values = self.numbers(observations, "a row")?;
            self.rewards.set_row(at, values);
            return Ok(());
        }
        let observation = self.which(Kind::Observation)?;
        self.takes(":");
        let value = self.any_number()?;
        self.ends("the reward")?;
        self.rewards.set(at, observation, value);
        Ok(())
    }
}
