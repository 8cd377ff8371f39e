//! What a belief is likely to be worth in the end, guessed from beliefs like it (SARSOP §III-C):
//! sampling goes on where the guess says that it would raise the value at the root.

/// Averages of lower bounds over bins of (initial upper bound, entropy), coarse and fine.
pub(super) struct Predictor {
    grids: [Grid; 2],
    lowest: f64,
    range: f64,
}

struct Grid {
    side: usize,
    bins: Vec<Bin>,
}

#[derive(Clone, Default)]
struct Bin {
    count: f64,
    sum: f64,
    /// Squared errors of guessing the average, and of guessing the upper bound.
    average_error: f64,
    upper_error: f64,
}

impl Predictor {
    /// Upper bounds lie from `lowest` to `highest`.
    pub fn new(lowest: f64, highest: f64) -> Self {
        let grid = |side: usize| Grid {
            side,
            bins: vec![Bin::default(); side * side],
        };
        Self {
            grids: [grid(5), grid(20)],
            lowest,
            range: (highest - lowest).max(f64::MIN_POSITIVE),
        }
    }

    /// The guess at the value of a belief with these features, now bounded by `upper`.
    pub fn predict(&self, features: (f64, f64), upper: f64) -> f64 {
        let fine_first = self.grids.iter().rev();
        let bins = fine_first.map(|grid| &grid.bins[self.place(grid, features)]);
        let known = bins.into_iter().find(|bin| bin.count > 0.0);
        match known {
            Some(bin) if bin.average_error <= bin.upper_error => (bin.sum / bin.count).min(upper),
            _ => upper,
        }
    }

    /// Hears that a belief's lower bound is now `lower`, where the bins knew it as `before`.
    pub fn learn(&mut self, features: (f64, f64), before: Option<f64>, lower: f64, upper: f64) {
        let places = self.grids.each_ref().map(|grid| self.place(grid, features));
        for (grid, place) in self.grids.iter_mut().zip(places) {
            let bin = &mut grid.bins[place];
            if bin.count > 0.0 {
                bin.average_error += (bin.sum / bin.count - lower).powi(2);
                bin.upper_error += (upper - lower).powi(2);
            }
            match before {
                Some(before) => bin.sum += lower - before,
                None => {
                    bin.count += 1.0;
                    bin.sum += lower;
                }
            }
        }
    }

    fn place(&self, grid: &Grid, (value, entropy): (f64, f64)) -> usize {
        let step = |share: f64| ((share * grid.side as f64) as usize).min(grid.side - 1);
        step((value - self.lowest) / self.range) * grid.side + step(entropy)
    }
}
