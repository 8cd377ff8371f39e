//! A table of estimates, the paper's beside ours.

use super::paper::Estimate;
use super::seeds::Seeds;
use crate::statistics::NORMAL_95;

/// Rows of methods, columns of tasks.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// What stands above.
    pub columns: Vec<Column>,
    /// In order.
    pub rows: Vec<Row>,
}

/// A column of a [`Matrix`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its head.
    pub title: String,
    /// How its numbers are written.
    pub format: Format,
}

/// How an estimate is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Mean ± standard error, with so many decimals each.
    Decimals(usize, usize),
    /// A share in percent, without its error.
    Percent,
}

/// A row of a [`Matrix`].
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The method.
    pub label: String,
    /// Whether it is one of the paper's methods, among which the best is sought.
    pub compared: bool,
    /// One per column.
    pub entries: Vec<Entry>,
}

/// Where a row and a column meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What we found.
    pub ours: Ours,
    /// Whether that is within the 95 % confidence interval of the column's best.
    pub ours_bold: bool,
    /// What the paper found, where it says.
    pub paper: Option<Estimate>,
    /// As for ours, among the paper's.
    pub paper_bold: bool,
}

/// What we found.
#[derive(Debug, Clone, PartialEq)]
pub enum Ours {
    /// A number.
    Found {
        /// Of the best seed.
        value: Estimate,
        /// `None` where nothing is trained.
        seeds: Option<Spread>,
    },
    /// The cell has not been run yet.
    NotRun,
    /// There is no such cell.
    Inapplicable,
}

/// The seeds behind a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The one that is shown.
    pub best: u64,
    /// How many were run.
    pub count: usize,
    /// Least and greatest of what they reach on the reported trials.
    pub range: [f64; 2],
}

impl Ours {
    /// What the best seed reaches by a measure on the reported trials, and what all do.
    /// `measure` says `None` where it does not apply.
    pub fn of_seeds<'r>(
        seeds: Option<&Seeds<'r>>,
        measure: impl Fn(&'r super::cell::Judged) -> Option<Estimate>,
    ) -> Self {
        let Some(seeds) = seeds else {
            return Self::NotRun;
        };
        let Some(value) = measure(seeds.best.fresh) else {
            return Self::Inapplicable;
        };
        let all = seeds.all.iter().filter_map(|seed| measure(seed.fresh));
        let range = all.fold([value.mean; 2], |[least, greatest], seed| {
            [least.min(seed.mean), greatest.max(seed.mean)]
        });
        Self::Found {
            value,
            seeds: Some(Spread {
                best: seeds.best.seed,
                count: seeds.all.len(),
                range,
            }),
        }
    }

    /// The number, if there is one.
    pub fn value(&self) -> Option<Estimate> {
        match self {
            Self::Found { value, .. } => Some(*value),
            Self::NotRun | Self::Inapplicable => None,
        }
    }
}

impl Entry {
    /// Not bold yet: see [`Matrix::new`].
    pub fn new(ours: Ours, paper: Option<Estimate>) -> Self {
        Self {
            ours,
            ours_bold: false,
            paper,
            paper_bold: false,
        }
    }

    /// Ours less the paper's.
    pub fn difference(&self) -> Option<f64> {
        Some(self.ours.value()?.mean - self.paper?.mean)
    }
}

impl Matrix {
    /// A matrix whose entries are bold as the paper's: where the mean is within the 95 %
    /// confidence interval of the column's best.
    pub fn new(columns: Vec<Column>, mut rows: Vec<Row>) -> Self {
        for column in 0..columns.len() {
            let ours = floor(&rows, column, |entry| entry.ours.value());
            let paper = floor(&rows, column, |entry| entry.paper);
            for row in rows.iter_mut().filter(|row| row.compared) {
                let entry = &mut row.entries[column];
                entry.ours_bold = reaches(entry.ours.value(), ours);
                entry.paper_bold = reaches(entry.paper, paper);
            }
        }
        Self { columns, rows }
    }

    /// Whether the paper says anything in it.
    pub fn has_paper(&self) -> bool {
        let mut entries = self.rows.iter().flat_map(|row| &row.entries);
        entries.any(|entry| entry.paper.is_some())
    }
}

/// The lower end of the interval of the best of a column.
fn floor(rows: &[Row], column: usize, value: impl Fn(&Entry) -> Option<Estimate>) -> Option<f64> {
    let compared = rows.iter().filter(|row| row.compared);
    let best = compared
        .filter_map(|row| value(&row.entries[column]))
        .max_by(|a, b| a.mean.total_cmp(&b.mean))?;
    Some(best.mean - NORMAL_95 * best.se)
}

fn reaches(value: Option<Estimate>, floor: Option<f64>) -> bool {
    value
        .zip(floor)
        .is_some_and(|(value, floor)| value.mean >= floor)
}
