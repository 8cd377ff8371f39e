//! Readings that say the same are one observation.
//!
//! Two bins whose probabilities are in the same proportion after every action and at every state
//! change a belief in the same way. Joining them loses nothing and saves a solver most of its work:
//! a sharp sensor with two levels has two observations, however fine its bins.

use std::collections::HashMap;

use pubs_solve::Rows;

/// Proportions this close are the same.
const STEPS_OF_PROPORTION: f64 = 1e6;

/// Which bins go together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Groups {
    /// Group of each bin.
    of_place: Vec<usize>,
    count: usize,
}

impl Groups {
    /// Groups of `count` bins, given their probabilities per action and state. A bin that never
    /// comes up goes with the nearest one below that does.
    pub fn of(rows: &[Rows], count: usize) -> Self {
        let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); count];
        let all = rows.iter().flatten().enumerate();
        for (index, row) in all {
            for &(place, probability) in row {
                columns[place].push((index as u32, probability));
            }
        }
        let mut known: HashMap<Vec<(u32, u32)>, usize> = HashMap::new();
        let mut latest = 0;
        let of_place = columns.iter().map(|column| {
            if !column.is_empty() {
                let next = known.len();
                latest = *known.entry(proportions(column)).or_insert(next);
            }
            latest
        });
        Self {
            of_place: of_place.collect(),
            count: known.len().max(1),
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The group of a bin.
    pub fn of_place(&self, place: usize) -> usize {
        self.of_place[place]
    }

    /// Rows over groups instead of bins.
    pub fn merge(&self, rows: Rows) -> Rows {
        rows.into_iter().map(|row| self.merge_row(&row)).collect()
    }

    fn merge_row(&self, row: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut merged: Vec<(usize, f64)> = Vec::new();
        for &(place, probability) in row {
            let group = self.of_place[place];
            match merged.iter_mut().find(|(known, _)| *known == group) {
                Some((_, sum)) => *sum += probability,
                None => merged.push((group, probability)),
            }
        }
        merged
    }
}

/// A column over its largest entry, in whole steps.
fn proportions(column: &[(u32, f64)]) -> Vec<(u32, u32)> {
    let largest = column
        .iter()
        .fold(0.0, |most: f64, entry| most.max(entry.1));
    let step = |probability: f64| (probability / largest * STEPS_OF_PROPORTION).round() as u32;
    let steps = column
        .iter()
        .map(|&(index, probability)| (index, step(probability)));
    steps.filter(|&(_, step)| step > 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_in_proportion_are_one_observation() {
        // Two actions, two states: bins 0 and 2 are in the proportion 1 to 3, bin 3 never comes.
        let rows = [
            vec![
                vec![(0, 0.1), (1, 0.6), (2, 0.3)],
                vec![(0, 0.2), (1, 0.2), (2, 0.6)],
            ],
            vec![vec![(1, 1.0)], vec![(0, 0.25), (2, 0.75)]],
        ];
        let groups = Groups::of(&rows, 4);
        let places: Vec<usize> = (0..4).map(|place| groups.of_place(place)).collect();
        assert_eq!((places, groups.count()), (vec![0, 1, 0, 0], 2));
        let merged = groups.merge(rows[0].clone());
        for (row, expected) in merged.iter().zip([[0.4, 0.6], [0.8, 0.2]]) {
            for (group, probability) in row {
                let wanted = expected[*group];
                assert!(
                    (probability - wanted).abs() < 1e-12,
                    "group {group}: {probability}, expected {wanted}"
                );
            }
        }
    }
}
