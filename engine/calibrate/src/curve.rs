//! One force channel of one action over the joint state: mean and sigma, §III-C.1.
//!
//! Regions of distinct variance are found in what is left when the coarse shape is taken away
//! (`changepoints`): in a free stretch that is noise alone, at a catch or a spring it is also the
//! part of the shape that the coarse curve cannot follow. Inside a region a Savitzky–Golay filter
//! over the cells' means gives the mean, few knots with straight lines between stand for it, and
//! the residual of the readings gives sigma:
//!
//! σ² = var(readings about their own pull) + (1 + 1/n) · var(pulls about the mean), n pulls,
//!
//! since a later pull will differ from the mean of n pulls by its own deviation and by theirs.

use crate::changepoints::{ChangepointError, changepoints};
use crate::grid::{Grid, filled};
use crate::smoothing::{SmoothingError, knots, savitzky_golay};
use crate::stored;

/// The coarse shape follows what is wider than this share of the range.
const COARSE_SHARE: f64 = 0.06;

/// The mean inside a region follows what is wider than this share of the range...
const FINE_SHARE: f64 = 0.06;

/// ...or than this share of the region, where that is less: a short region has a shape of its own.
const FINE_SHARE_OF_REGION: f64 = 0.4;

/// Order of both smoothing polynomials.
const ORDER: usize = 2;

/// A region has at least this share of the range.
const SHORTEST_SHARE: f64 = 0.008;

/// Readings of a cell that look for changes: of two pulls, so that pulls alternate and a constant
/// difference between them counts as noise.
const PULLS_PER_CELL: usize = 2;

/// Knots keep the mean to within this share of sigma.
const KNOT_SHARE: f64 = 0.25;

/// No reading is better than this, N: the last digit that files keep, and a filter that multiplies
/// thousands of readings must not take rounding for knowledge.
pub const SIGMA_FLOOR_N: f64 = 0.05;

/// A stretch of one region.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Where it starts (rad or m).
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Strictly increasing, within the piece.
    pub position: Vec<f64>,
    /// At each position, N.
    pub mean_n: Vec<f64>,
    /// Standard deviation of a reading, N.
    pub sigma_n: f64,
    /// Readings it rests on.
    pub readings: usize,
}

impl Piece {
    /// Mean at a state: linear between positions, constant beyond them.
    pub fn mean_at(&self, state: f64) -> f64 {
        stored::at(&self.position, &self.mean_n, state)
    }
}

/// Why there is no curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// Change points could not be sought.
    #[error(transparent)]
    Changepoints(#[from] ChangepointError),
    /// The mean could not be smoothed.
    #[error(transparent)]
    Smoothing(#[from] SmoothingError),
}

/// Readings of one pull: (state, force).
pub type Readings = Vec<(f64, f64)>;

/// Cell means of each pull and over the pulls.
struct Pooled {
    /// Of each pull in each cell.
    by_pull: Vec<Vec<Option<f64>>>,
    /// Over the pulls, each counting once; gaps filled.
    mean: Vec<f64>,
}

impl Pooled {
    fn new(grid: &Grid, pulls: &[Readings]) -> Self {
        let by_pull: Vec<Vec<Option<f64>>> =
            pulls.iter().map(|pull| cell_means(grid, pull)).collect();
        let over_pulls = |cell: usize| {
            let values: Vec<f64> = by_pull.iter().filter_map(|pull| pull[cell]).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let mean: Vec<Option<f64>> = (0..grid.len()).map(over_pulls).collect();
        Self {
            mean: filled(&mean),
            by_pull,
        }
    }
}

fn cell_means(grid: &Grid, readings: &Readings) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0_usize); grid.len()];
    for &(state, force) in readings {
        let (sum, count) = &mut sums[grid.cell(state)];
        *sum += force;
        *count += 1;
    }
    sums.into_iter()
        .map(|(sum, count)| (count > 0).then(|| sum / count as f64))
        .collect()
}

/// The cells at which a region of another variance begins.
///
/// # Errors
/// Where the readings are not finite.
pub fn regions(grid: &Grid, pulls: &[Readings]) -> Result<Vec<usize>, CurveError> {
    let pooled = Pooled::new(grid, pulls);
    let coarse = savitzky_golay(&pooled.mean, share_of(grid, COARSE_SHARE), ORDER)?;
    let (mut signal, mut cells) = (Vec::new(), Vec::new());
    for (cell, coarse) in coarse.iter().enumerate() {
        let values: Vec<f64> = pooled
            .by_pull
            .iter()
            .filter_map(|pull| pull[cell])
            .collect();
        for turn in 0..PULLS_PER_CELL.min(values.len()) {
            signal.push(values[(cell * PULLS_PER_CELL + turn) % values.len()] - coarse);
            cells.push(cell);
        }
    }
    let shortest = ((SHORTEST_SHARE * grid.len() as f64).round() as usize).max(2);
    let mut regions = Vec::new();
    let mut last = 0;
    for change in changepoints(&signal)? {
        let cell = cells[change];
        if cell >= last + shortest && cell + shortest <= grid.len() {
            regions.push(cell);
            last = cell;
        }
    }
    Ok(regions)
}

/// Mean and sigma over the whole grid, cut at `regions` (ascending cells).
///
/// # Errors
/// Where the readings are not finite.
pub fn pieces(
    grid: &Grid,
    pulls: &[Readings],
    regions: &[usize],
) -> Result<Vec<Piece>, CurveError> {
    let pooled = Pooled::new(grid, pulls);
    let starts = std::iter::once(0).chain(regions.iter().copied());
    let ends = regions.iter().copied().chain([grid.len()]);
    starts
        .zip(ends)
        .map(|(from, to)| piece(grid, pulls, &pooled.mean, from, to))
        .collect()
}

fn piece(
    grid: &Grid,
    pulls: &[Readings],
    mean: &[f64],
    from: usize,
    to: usize,
) -> Result<Piece, CurveError> {
    let of_region = odd(FINE_SHARE_OF_REGION * (to - from) as f64);
    let window = share_of(grid, FINE_SHARE).min(of_region);
    let smooth = savitzky_golay(&mean[from..to], window, ORDER)?;
    let position: Vec<f64> = (from..to).map(|cell| grid.centre(cell)).collect();
    let (start, end) = (grid.edge(from), grid.edge(to));
    let whole = Piece {
        from: start,
        to: end,
        position,
        mean_n: smooth,
        sigma_n: 0.0,
        readings: 0,
    };
    let inside: Vec<Vec<f64>> = pulls
        .iter()
        .map(|pull| residuals(pull, &whole, to == grid.len()))
        .collect();
    let sigma_n = sigma(&inside).max(SIGMA_FLOOR_N);
    let kept = knots(&whole.position, &whole.mean_n, KNOT_SHARE * sigma_n);
    Ok(Piece {
        position: kept.iter().map(|&index| whole.position[index]).collect(),
        mean_n: kept.iter().map(|&index| whole.mean_n[index]).collect(),
        sigma_n,
        readings: inside.iter().map(Vec::len).sum(),
        ..whole
    })
}

fn residuals(pull: &Readings, piece: &Piece, last: bool) -> Vec<f64> {
    pull.iter()
        .filter(|&&(state, _)| state >= piece.from && (state < piece.to || last))
        .map(|&(state, force)| force - piece.mean_at(state))
        .collect()
}

/// σ of the head of this file, from each pull's residuals.
pub fn sigma(residuals: &[Vec<f64>]) -> f64 {
    let seen: Vec<&Vec<f64>> = residuals.iter().filter(|pull| !pull.is_empty()).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let offsets: Vec<f64> = seen.iter().map(|pull| mean(pull)).collect();
    let count: usize = seen.iter().map(|pull| pull.len()).sum();
    if seen.is_empty() {
        return 0.0;
    }
    let squares: f64 = seen
        .iter()
        .zip(&offsets)
        .flat_map(|(pull, offset)| pull.iter().map(move |value| (value - offset).powi(2)))
        .sum();
    let pulls = seen.len() as f64;
    let within = squares / (count as f64 - pulls).max(1.0);
    if seen.len() < 2 {
        return (within + offsets[0] * offsets[0]).sqrt();
    }
    let between = offsets.iter().map(|offset| offset * offset).sum::<f64>() / (pulls - 1.0);
    (within + (1.0 + 1.0 / pulls) * between).sqrt()
}

fn share_of(grid: &Grid, share: f64) -> usize {
    odd(share * grid.len() as f64)
}

/// An odd number of cells, at least 5.
fn odd(cells: f64) -> usize {
    (cells.round() as usize | 1).max(5)
}
