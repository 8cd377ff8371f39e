//! Names of states, actions and observations, and ways to refer to them.

use std::collections::HashMap;
use std::ops::Range;

/// What a list of names is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    State,
    Action,
    Observation,
}

impl Kind {
    pub fn noun(self) -> &'static str {
        match self {
            Self::State => "state",
            Self::Action => "action",
            Self::Observation => "observation",
        }
    }

    pub fn keyword(self) -> &'static str {
        match self {
            Self::State => "states",
            Self::Action => "actions",
            Self::Observation => "observations",
        }
    }
}

/// A declared list of names.
#[derive(Default)]
pub(super) struct Names {
    list: Vec<String>,
    places: HashMap<String, usize>,
}

/// One of a list, or all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Which {
    All,
    One(usize),
}

impl Which {
    /// The places that it stands for in a list of `count`.
    pub fn range(self, count: usize) -> Range<usize> {
        match self {
            Self::All => 0..count,
            Self::One(place) => place..place + 1,
        }
    }

    /// The place, where it is one.
    pub fn one(self) -> Option<usize> {
        match self {
            Self::All => None,
            Self::One(place) => Some(place),
        }
    }
}

impl Names {
    /// Names for a bare count: the numbers themselves.
    pub fn counted(count: usize) -> Self {
        let mut names = Self::default();
        for number in 0..count {
            names.push(&number.to_string());
        }
        names
    }

    /// Adds a name; false where it is there already.
    pub fn push(&mut self, name: &str) -> bool {
        let place = self.list.len();
        if self.places.contains_key(name) {
            return false;
        }
        self.places.insert(name.to_owned(), place);
        self.list.push(name.to_owned());
        true
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    pub fn list(&self) -> &[String] {
        &self.list
    }

    /// The place of a name or a number.
    pub fn find(&self, text: &str) -> Option<usize> {
        if let Some(&place) = self.places.get(text) {
            return Some(place);
        }
        text.parse().ok().filter(|&place| place < self.list.len())
    }

    /// The names for a help text, the first few where there are many.
    pub fn shown(&self) -> String {
        const MANY: usize = 8;
        let shown: Vec<_> = self.list.iter().take(MANY).map(String::as_str).collect();
        let shown = shown.join(", ");
        if self.list.len() > MANY {
            return format!("{shown}, … ({} in all)", self.list.len());
        }
        shown
    }
}
