//! The tables in a few sentences.

use super::matrix::{Entry, Matrix};
use super::numbers::{NOT_RUN, percent};
use super::paper::{self, Estimate, GOALS, OBJECTS};
use super::results::Results;
use super::violations::violations;
use super::{tables, transfer};

/// How often the first row leads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lead {
    /// Columns in which every compared row has a number.
    pub whole: usize,
    /// Of those: where the first has the greatest mean, alone.
    pub first: usize,
    /// Of those: where it is bold.
    pub bold: usize,
}

impl Lead {
    /// Counts a matrix, of ours or of the paper's numbers, on top of what was counted.
    pub fn count(
        &mut self,
        matrix: &Matrix,
        value: impl Fn(&Entry) -> Option<Estimate>,
        bold: impl Fn(&Entry) -> bool,
    ) {
        for column in 0..matrix.columns.len() {
            let compared = matrix.rows.iter().filter(|row| row.compared);
            let entries: Vec<_> = compared.map(|row| &row.entries[column]).collect();
            let means: Option<Vec<_>> = entries.iter().map(|entry| value(entry)).collect();
            let Some((head, others)) = means.as_deref().and_then(<[_]>::split_first) else {
                continue;
            };
            self.whole += 1;
            let leads = others.iter().all(|other| head.mean > other.mean);
            self.first += usize::from(leads);
            self.bold += usize::from(bold(entries[0]));
        }
    }

    fn ours(matrices: &[Matrix]) -> Self {
        let mut lead = Self::default();
        for matrix in matrices {
            lead.count(matrix, |entry| entry.ours.value(), |entry| entry.ours_bold);
        }
        lead
    }

    fn papers(matrices: &[Matrix]) -> Self {
        let mut lead = Self::default();
        for matrix in matrices {
            lead.count(matrix, |entry| entry.paper, |entry| entry.paper_bold);
        }
        lead
    }

    fn sentence(matrices: &[Matrix], of: &str) -> String {
        let [ours, paper] = [Self::ours(matrices), Self::papers(matrices)];
        format!(
            "{of}: PuBS has the greatest mean in {} of {} (paper: {} of {}) and is within the best \
             method's interval in {} (paper: {})",
            ours.first, ours.whole, paper.first, paper.whole, ours.bold, paper.bold
        )
    }
}

/// What the tables say of the paper's claims, counting only what has been run.
pub(super) fn brief(results: &Results) -> Vec<String> {
    let table_i = GOALS.map(|goal| tables::table_i(results, goal));
    let table_iii = [tables::table_iii(results)];
    vec![
        Lead::sentence(&table_i, "Table I, cells with all four methods"),
        fewest(results),
        Lead::sentence(&table_iii, "Table III, tasks with all three inputs"),
        transferred(results),
    ]
}

fn fewest(results: &Results) -> String {
    let mut whole = 0;
    let mut fewest = 0;
    let mut shielded = Some(0);
    for rows in GOALS.map(|goal| violations(results, goal)) {
        shielded = shielded.zip(rows[1].best()).map(|(sum, more)| sum + more);
        if [0, 2, 3, 4]
            .iter()
            .any(|&row| rows[row].run() < OBJECTS.len())
        {
            continue;
        }
        whole += 1;
        let baselines = rows[2..].iter().filter_map(|row| row.best()).min();
        fewest += usize::from(rows[0].best() < baselines);
    }
    let shielded = shielded.map_or_else(String::new, |count| {
        format!("; with the shield it has {count} in all that has been run")
    });
    format!(
        "Fig. 4, goals with all methods and tasks: PuBS has fewer violations than every baseline in \
         {fewest} of {whole}{shielded}"
    )
}

fn transferred(results: &Results) -> String {
    let run = OBJECTS.map(|object| {
        let ours = transfer::transfer(results, object, false)?;
        let paper = paper::table_iv(object)?;
        Some((object, ours.success_rate, paper.success_rate))
    });
    let said: Vec<_> = run
        .into_iter()
        .flatten()
        .map(|(object, ours, paper)| {
            let name = tables::name(object);
            format!("{name} {} (paper: {})", percent(ours), percent(paper))
        })
        .collect();
    if said.is_empty() {
        return format!("Table IV: {}", NOT_RUN);
    }
    format!("Table IV, success without drift: {}", said.join(", "))
}
