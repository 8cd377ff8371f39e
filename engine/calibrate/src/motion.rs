//! m_p: whether the handle moves, by the force against what stops the action, §III-C.1.
//!
//! A reading says "moves" where the force along the motion does not exceed the threshold, "held"
//! where it does. The share of the former among the readings of a stretch is its probability. It
//! belongs to the state *before* a filter update, since the force there decides.

use crate::grid::Grid;

/// Neighbouring cells are one stretch while their shares differ by less than this.
const STEP: f64 = 0.1;

/// A stretch with fewer readings says nothing by itself.
const FEWEST: usize = 10;

/// Nothing is quite certain: share kept away from 0 and 1. A wider margin would let the trainer's
/// simulator hold the handle back at random so often that policies count on it.
pub const MARGIN: f64 = 0.005;

/// A stretch of one probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// First cell.
    pub from: usize,
    /// One past the last cell.
    pub to: usize,
    /// Probability that the handle moves.
    pub probability: f64,
}

/// Shares of the pulls that have a reading, and how many readings they have.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    shares: f64,
    pulls: usize,
    readings: usize,
}

impl Count {
    fn share(&self) -> f64 {
        self.shares / self.pulls.max(1) as f64
    }

    fn and(self, other: Self) -> Self {
        Self {
            shares: self.shares + other.shares,
            pulls: self.pulls + other.pulls,
            readings: self.readings + other.readings,
        }
    }
}

/// Stretches over the whole grid from each pull's readings `(state before, moves)`. In a cell each
/// pull counts once, however long it stood there. Cells without any reading belong to the stretch
/// before them.
pub fn stretches(grid: &Grid, pulls: &[Vec<(f64, bool)>]) -> Vec<Stretch> {
    let mut counts = vec![Count::default(); grid.len()];
    for pull in pulls {
        let mut own = vec![(0_usize, 0_usize); grid.len()];
        for &(state, moves) in pull {
            let (moving, all) = &mut own[grid.cell(state)];
            *moving += usize::from(moves);
            *all += 1;
        }
        for (count, (moving, all)) in counts.iter_mut().zip(own) {
            if all > 0 {
                count.shares += moving as f64 / all as f64;
                count.pulls += 1;
                count.readings += all;
            }
        }
    }
    let mut runs: Vec<(usize, usize, Count)> = Vec::new();
    for (cell, &count) in counts.iter().enumerate() {
        match runs.last_mut() {
            Some((_, to, run))
                if run.readings < FEWEST
                    || count.pulls == 0
                    || (run.share() - count.share()).abs() < STEP =>
            {
                (*to, *run) = (cell + 1, run.and(count));
            }
            _ => runs.push((cell, cell + 1, count)),
        }
    }
    runs.into_iter()
        .map(|(from, to, count)| Stretch {
            from,
            to,
            probability: if count.pulls == 0 {
                1.0 - MARGIN
            } else {
                within_margin(count.share())
            },
        })
        .collect()
}

/// Share of `moves` among `all`, never quite certain; 1 where nothing is known.
pub fn probability(moves: usize, all: usize) -> f64 {
    let share = if all == 0 {
        1.0
    } else {
        moves as f64 / all as f64
    };
    within_margin(share)
}

fn within_margin(share: f64) -> f64 {
    share.clamp(MARGIN, 1.0 - MARGIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_by_hand() {
        let grid = Grid::new(0.0, 4.0, 4);
        let mut long = vec![(0.5, true); 20];
        long.extend(vec![(1.5, false); 90]);
        long.extend(vec![(3.5, false); 20]);
        let short = vec![(0.5, true), (1.5, true)];
        // In cell 1 one pull is held for long and the other moves on: one half, not one in 91.
        let expected = [(0, 1, 0.995), (1, 3, 0.5), (3, 4, 0.005)];
        let found: Vec<_> = stretches(&grid, &[long, short])
            .iter()
            .map(|stretch| (stretch.from, stretch.to, stretch.probability))
            .collect();
        assert_eq!(found, expected);
    }
}
