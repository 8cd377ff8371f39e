//! `discount:`, `values:`, `states:`, `actions:`, `observations:` and `start:`.

use super::names::{Kind, Names};
use super::parser::{Broken, Parser};
use crate::pomdp::SUM_TOLERANCE;

/// Far above what any solver comes to an end with; keeps a slip of the pen from filling the memory.
const MOST: usize = 1_000_000;

/// The forms of the initial belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StartForm {
    /// Probabilities, `uniform`, or a state.
    Plain,
    /// Uniform over the states listed.
    Include,
    /// Uniform over the states not listed.
    Exclude,
}

impl Parser<'_> {
    pub(super) fn read_discount(&mut self) -> Result<(), Broken> {
        self.colon()?;
        let token = self.at;
        let help = "the discount is a number of at least 0 and below 1, such as 0.95";
        let Some(discount) = self.number() else {
            let message = format!("{} is no number", self.found(token));
            return Err(self.fault_at(token, message, help));
        };
        self.ends("the discount")?;
        self.discount = Some((discount, token));
        if (0.0..1.0).contains(&discount) {
            return Ok(());
        }
        self.fault_at(
            token,
            format!("the discount is {discount}"),
            format!("{help}: at 1 or above a policy that never ends has no finite value"),
        );
        Ok(())
    }

    pub(super) fn read_values(&mut self) -> Result<(), Broken> {
        self.colon()?;
        let token = self.at;
        self.costs = match self.text() {
            // The plural stands in some files.
            Some("reward" | "rewards") => false,
            Some("cost" | "costs") => true,
            _ => {
                let message = format!("{} is no kind of value", self.found(token));
                return Err(self.fault_at(token, message, "write `reward` or `cost`"));
            }
        };
        self.at += 1;
        self.ends("the kind of values")
    }

    pub(super) fn read_names(&mut self, kind: Kind) -> Result<(), Broken> {
        let token = self.at - 1;
        self.colon()?;
        let words: Vec<usize> = self.words();
        let keyword = kind.keyword();
        if self.names(kind).is_some() {
            let message = format!("`{keyword}:` is given twice");
            return Err(self.fault_at(token, message, "keep one of the two"));
        }
        let help = format!("give a count or names: `{keyword}: 2` or `{keyword}: left right`");
        let names = match words.as_slice() {
            [] => {
                let message = format!("`{keyword}:` is empty");
                return Err(self.fault_at(token, message, help));
            }
            &[only] => match self.tokens[only].text.parse::<usize>() {
                Ok(0) => {
                    let message = format!("there are 0 {keyword}");
                    return Err(self.fault_at(only, message, help));
                }
                Ok(count) if count > MOST => {
                    let message = format!("there are {count} {keyword}");
                    let help = format!("a solver serves at most {MOST}");
                    return Err(self.fault_at(only, message, help));
                }
                Ok(count) => Names::counted(count),
                Err(_) => self.named(&words, kind),
            },
            _ => self.named(&words, kind),
        };
        match kind {
            Kind::State => self.states = Some(names),
            Kind::Action => self.actions = Some(names),
            Kind::Observation => self.observations = Some(names),
        }
        Ok(())
    }

    fn named(&mut self, words: &[usize], kind: Kind) -> Names {
        let mut names = Names::default();
        for &word in words {
            let text = self.tokens[word].text;
            if matches!(text, ":" | "*") {
                let message = format!("`{text}` is no name of a {}", kind.noun());
                self.fault_at(word, message, "names are words, parted by white space");
            } else if !names.push(text) {
                let message = format!("the {} `{text}` is named twice", kind.noun());
                self.fault_at(word, message, "give each a name of its own");
            }
        }
        names
    }

    /// Whether the next word has a colon behind it: a statement that is written wrongly.
    fn is_before_colon(&self) -> bool {
        let next = self.tokens.get(self.at + 1);
        next.is_some_and(|token| token.text == ":")
    }

    /// The tokens up to the next statement.
    fn words(&mut self) -> Vec<usize> {
        let first = self.at;
        while !self.is_at_end() && !self.is_before_colon() {
            self.at += 1;
        }
        (first..self.at).collect()
    }

    /// Refuses what follows where a statement should have ended.
    pub(super) fn ends(&mut self, what: &str) -> Result<(), Broken> {
        if self.is_at_end() {
            return Ok(());
        }
        if self.is_before_colon() {
            return Err(self.not_a_statement(self.at));
        }
        let message = format!("{} follows {what}", self.found(self.at));
        Err(self.fault_at(
            self.at,
            message,
            "a statement should begin here: discount:, values:, states:, actions:, \
             observations:, start:, T:, O: or R:",
        ))
    }

    /// Keeps the words of `start`: they may come before the states that they name.
    pub(super) fn read_start(&mut self) -> Result<(), Broken> {
        let form = match self.text() {
            Some("include") => StartForm::Include,
            Some("exclude") => StartForm::Exclude,
            _ => StartForm::Plain,
        };
        self.at += usize::from(form != StartForm::Plain);
        self.colon()?;
        let first = self.at;
        self.words();
        self.start = Some((form, first..self.at));
        Ok(())
    }

    /// The initial belief: uniform where the file gives none.
    pub(super) fn initial_belief(&mut self) -> Result<Vec<f64>, Broken> {
        let count = self.count(Kind::State);
        let Some((form, words)) = self.start.clone() else {
            return Ok(vec![1.0 / count as f64; count]);
        };
        let end = std::mem::replace(&mut self.at, words.start);
        let belief = match form {
            StartForm::Plain => self.plain_start(words.end),
            StartForm::Include => self.listed(words.end, true),
            StartForm::Exclude => self.listed(words.end, false),
        };
        self.at = end;
        belief
    }

    fn plain_start(&mut self, end: usize) -> Result<Vec<f64>, Broken> {
        let count = self.count(Kind::State);
        let first = self.at;
        let one_word = end - first == 1;
        if one_word && self.takes("uniform") {
            return Ok(vec![1.0 / count as f64; count]);
        }
        let is_probability = count == 1 && self.text().is_some_and(|text| text.parse() == Ok(1.0));
        if one_word && !is_probability {
            let mut belief = vec![0.0; count];
            let state = self.one(Kind::State)?;
            belief[state] = 1.0;
            return Ok(belief);
        }
        let mut belief = Vec::new();
        while self.at < end {
            belief.push(self.probability()?);
        }
        if belief.len() != count {
            let message = format!(
                "the initial belief has {} probabilities for {count} states",
                belief.len()
            );
            let help = "give one for each state, `uniform`, a state, or `start include:` and \
                        states";
            return Err(self.fault_at(first, message, help));
        }
        let sum: f64 = belief.iter().sum();
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            let message = format!("the initial belief sums to {sum}");
            let help = "probabilities sum to 1: write more digits, or mend one of them";
            return Err(self.fault_at(end - 1, message, help));
        }
        Ok(belief)
    }

    fn listed(&mut self, end: usize, included: bool) -> Result<Vec<f64>, Broken> {
        let first = self.at;
        let mut chosen = vec![!included; self.count(Kind::State)];
        while self.at < end {
            let state = self.one(Kind::State)?;
            chosen[state] = included;
        }
        let count = chosen.iter().filter(|chosen| **chosen).count();
        if count == 0 {
            return Err(self.fault_at(first, "no state is left to start in", "list others"));
        }
        let weight = |chosen: bool| f64::from(u8::from(chosen)) / count as f64;
        Ok(chosen.into_iter().map(weight).collect())
    }
}
