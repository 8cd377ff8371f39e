//! The walk over a file's statements.

use super::fault::ParseFault;
use super::names::{Kind, Names, Which};
use super::rewards::Rewards;
use super::rows::Table;
use super::token::{Token, tokens};

/// More faults than this are not worth reading.
const MOST_FAULTS: usize = 50;

/// The words that begin a statement.
const KEYWORDS: [&str; 9] = [
    "discount",
    "values",
    "states",
    "actions",
    "observations",
    "start",
    "T",
    "O",
    "R",
];

/// A statement could not be read; its fault is written down already.
pub(super) struct Broken;

/// What is known of a file while it is read.
pub(super) struct Parser<'a> {
    pub tokens: Vec<Token<'a>>,
    pub at: usize,
    pub faults: Vec<ParseFault>,
    pub discount: Option<(f64, usize)>,
    pub costs: bool,
    pub states: Option<Names>,
    pub actions: Option<Names>,
    pub observations: Option<Names>,
    /// The form of `start` and its words.
    pub start: Option<(super::preamble::StartForm, std::ops::Range<usize>)>,
    pub transitions: Table,
    pub observation_table: Table,
    pub rewards: Rewards,
    /// Whether `T:`, `O:` or `R:` came already; names cannot change after that.
    pub has_tables: bool,
}

impl<'a> Parser<'a> {
    pub fn new(text: &'a str) -> Self {
        Self {
            tokens: tokens(text),
            at: 0,
            faults: Vec::new(),
            discount: None,
            costs: false,
            states: None,
            actions: None,
            observations: None,
            start: None,
            transitions: Table::default(),
            observation_table: Table::default(),
            rewards: Rewards::default(),
            has_tables: false,
        }
    }

    pub fn read_statements(&mut self) {
        while self.at < self.tokens.len() && self.faults.len() < MOST_FAULTS {
            if self.read_statement().is_err() {
                self.skip_to_statement();
            }
        }
    }

    fn read_statement(&mut self) -> Result<(), Broken> {
        let token = self.at;
        if !self.is_statement(token) {
            return Err(self.not_a_statement(token));
        }
        self.at += 1;
        match self.tokens[token].text {
            "discount" => self.read_discount(),
            "values" => self.read_values(),
            "states" => self.read_names(Kind::State),
            "actions" => self.read_names(Kind::Action),
            "observations" => self.read_names(Kind::Observation),
            "start" => self.read_start(),
            "T" => self.read_transition(token),
            "O" => self.read_observation(token),
            _ => self.read_reward(token),
        }
    }

    /// Says that a word begins no statement, and which do.
    pub fn not_a_statement(&mut self, token: usize) -> Broken {
        let text = self.tokens[token].text;
        let lower = text.to_lowercase();
        let alike = KEYWORDS
            .into_iter()
            .find(|keyword| keyword.to_lowercase() == lower);
        let help = match alike {
            Some(keyword) if keyword == text => format!("write `{keyword}:` with a colon"),
            Some(keyword) => format!("write `{keyword}:`"),
            None => "a statement begins with discount:, values:, states:, actions:, \
                     observations:, start:, T:, O: or R:"
                .to_owned(),
        };
        self.fault_at(token, format!("`{text}` begins no statement"), help)
    }

    /// Whether a statement begins at a token.
    pub fn is_statement(&self, token: usize) -> bool {
        let text = |token: usize| self.tokens.get(token).map(|token| token.text);
        let Some(word) = text(token).filter(|word| KEYWORDS.contains(word)) else {
            return false;
        };
        let is_start_list = || {
            word == "start"
                && matches!(text(token + 1), Some("include" | "exclude"))
                && text(token + 2) == Some(":")
        };
        text(token + 1) == Some(":") || is_start_list()
    }

    fn skip_to_statement(&mut self) {
        while self.at < self.tokens.len() && !self.is_statement(self.at) {
            self.at += 1;
        }
    }

    /// Writes a fault down at a token, or after the last one.
    pub fn fault_at(
        &mut self,
        token: usize,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Broken {
        let (line, column) = match self.tokens.get(token) {
            Some(token) => (token.line, token.column),
            None => self.end(),
        };
        self.faults.push(ParseFault {
            line,
            column,
            message: message.into(),
            help: help.into(),
        });
        Broken
    }

    fn end(&self) -> (usize, usize) {
        self.tokens.last().map_or((1, 1), |last| {
            (last.line, last.column + last.text.chars().count())
        })
    }

    /// The text of a token for a message.
    pub fn found(&self, token: usize) -> String {
        match self.tokens.get(token) {
            Some(token) => format!("`{}`", token.text),
            None => "the end of the file".to_owned(),
        }
    }

    pub fn text(&self) -> Option<&'a str> {
        self.tokens.get(self.at).map(|token| token.text)
    }

    /// Goes past the next token where it is `text`.
    pub fn takes(&mut self, text: &str) -> bool {
        let found = self.text() == Some(text);
        self.at += usize::from(found);
        found
    }

    /// Goes past a colon.
    pub fn colon(&mut self) -> Result<(), Broken> {
        if self.takes(":") {
            return Ok(());
        }
        let message = format!("{} stands where a colon should", self.found(self.at));
        Err(self.fault_at(self.at, message, "write `:` before it"))
    }

    /// Whether the present statement ends here.
    pub fn is_at_end(&self) -> bool {
        self.at >= self.tokens.len() || self.is_statement(self.at)
    }

    /// The next tokens as a number, if they are one. A sign may stand apart.
    pub fn number(&mut self) -> Option<f64> {
        let text = self.text()?;
        let (sign, digits, count) = match text {
            "-" | "+" => {
                let digits = self.tokens.get(self.at + 1)?.text;
                (if text == "-" { -1.0 } else { 1.0 }, digits, 2)
            }
            _ => (1.0, text, 1),
        };
        // Words such as `nan` and `infinity` are no numbers here.
        if !digits.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first)) {
            return None;
        }
        let value: f64 = digits.parse().ok()?;
        if !value.is_finite() {
            return None;
        }
        self.at += count;
        Some(sign * value)
    }

    /// Reads `*`, a name or a number.
    pub fn which(&mut self, kind: Kind) -> Result<Which, Broken> {
        if self.takes("*") {
            return Ok(Which::All);
        }
        self.one(kind).map(Which::One)
    }

    /// Reads a name or a number.
    pub fn one(&mut self, kind: Kind) -> Result<usize, Broken> {
        let token = self.at;
        let Some(names) = self.names(kind) else {
            let message = format!(
                "the {} are not declared before they are used",
                kind.keyword()
            );
            let help = format!("put `{}:` above", kind.keyword());
            return Err(self.fault_at(token, message, help));
        };
        let found = self.text().and_then(|text| names.find(text));
        if let Some(place) = found {
            self.at += 1;
            return Ok(place);
        }
        let noun = kind.noun();
        let help = format!("the {} are: {}", kind.keyword(), names.shown());
        let message = match self.text().map(str::parse::<usize>) {
            Some(Ok(number)) => format!(
                "there is no {noun} number {number}: there are {}, counted from 0",
                names.len()
            ),
            _ => format!("{} is no {noun}", self.found(token)),
        };
        Err(self.fault_at(token, message, help))
    }

    pub fn names(&self, kind: Kind) -> Option<&Names> {
        match kind {
            Kind::State => self.states.as_ref(),
            Kind::Action => self.actions.as_ref(),
            Kind::Observation => self.observations.as_ref(),
        }
    }

    /// How many there are of a kind; none where they are not declared.
    pub fn count(&self, kind: Kind) -> usize {
        self.names(kind).map_or(0, Names::len)
    }
}
