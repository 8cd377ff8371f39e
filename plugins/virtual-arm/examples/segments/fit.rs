//! Means as piecewise linear curves, sigma and probability as pieces that are constant.

use pubs_virtual_arm::world::Joint;

/// No sensor is better than this in what a filter makes of it, N.
const SIGMA_FLOOR_N: f64 = 0.3;

/// Neighbouring cells are one segment while their sigmas differ by less than this factor.
const SIGMA_FACTOR: f64 = 1.3;

/// Neighbouring cells are one segment while their probabilities differ by less than this.
const PROBABILITY_STEP: f64 = 0.1;

/// Nothing is quite certain.
const PROBABILITY_MARGIN: f64 = 0.02;

/// A cell with fewer samples says nothing by itself.
const FEWEST_SAMPLES: usize = 25;

/// Draws neighbouring knots together with the weight of this many samples; fills empty stretches.
const SMOOTHING: f64 = 0.05;

const SWEEPS: usize = 400;

/// Where a curve may bend: close together near the limits, coarser elsewhere.
pub struct Knots(Vec<f64>);

impl Knots {
    pub fn over(joint: &Joint) -> Self {
        let range = joint.upper - joint.lower;
        // On door2: every 0.5 degrees in the first 8 and the last 3, every 2.5 elsewhere; and one
        // 0.1 degrees inside each limit, since a state stays there while the tool pushes on.
        let (fine, coarse, first, last, edge) = (0.004, 0.02, 0.064, 0.024, 0.0008);
        let mut knots = vec![0.0, edge];
        let mut at = 0.0f64;
        while at < 1.0 - 1e-9 {
            let near = at < first - 1e-9 || at > 1.0 - last - 1e-9;
            let next = at + if near { fine } else { coarse };
            let turns_fine = at < 1.0 - last - 1e-9 && next > 1.0 - last - 1e-9;
            at = if turns_fine {
                1.0 - last
            } else {
                next.min(1.0)
            };
            knots.push(at);
        }
        knots.insert(knots.len() - 1, 1.0 - edge);
        Self(
            knots
                .into_iter()
                .map(|fraction| joint.lower + fraction * range)
                .collect(),
        )
    }

    fn cells(&self) -> usize {
        self.0.len() - 1
    }

    /// Cell of a state, and how far into it (0 to 1).
    fn place(&self, state: f64) -> (usize, f64) {
        let above = self.0.partition_point(|&knot| knot <= state);
        let cell = above.saturating_sub(1).min(self.cells() - 1);
        let (from, to) = (self.0[cell], self.0[cell + 1]);
        (cell, (state - from) / (to - from))
    }
}

/// Each sample at five places around its own, as a normal error of the state would put it; a place
/// past a limit counts at the limit. A filter knows the state no better than this, because its
/// particles stand apart and the grasp gives: where a force is steep its mean is then smoother and
/// its sigma wider, by as much as that error makes of it.
pub fn blurred<T: Copy>(joint: &Joint, position_sd: f64, points: &[(f64, T)]) -> Vec<(f64, T)> {
    let error = position_sd * (joint.upper - joint.lower);
    // Medians of the fifths of a standard normal distribution.
    let fifths = [-1.2816, -0.5244, 0.0, 0.5244, 1.2816];
    let around = |&(state, value): &(f64, T)| {
        fifths.map(|deviation| {
            let place = (state + deviation * error).clamp(joint.lower, joint.upper);
            (place, value)
        })
    };
    points.iter().flat_map(around).collect()
}

/// A stretch with one sigma.
pub struct ForceSegment {
    pub position: Vec<f64>,
    pub mean_n: Vec<f64>,
    pub sigma_n: f64,
}

/// A stretch with one probability.
pub struct MovedSegment {
    pub from: f64,
    pub to: f64,
    pub probability: f64,
}

/// Least squares over `(state, force)`.
pub fn force(knots: &Knots, points: &[(f64, f64)]) -> Vec<ForceSegment> {
    let mean = curve(knots, points);
    let mut cells = vec![Cell::default(); knots.cells()];
    for &(state, force) in points {
        let (cell, part) = knots.place(state);
        let residual = force - mean[cell] * (1.0 - part) - mean[cell + 1] * part;
        cells[cell].add(residual * residual);
    }
    let sigma = |cell: &Cell| cell.mean().sqrt().max(SIGMA_FLOOR_N);
    let alike = |a: &Cell, b: &Cell| {
        let ratio = sigma(a) / sigma(b);
        (1.0 / SIGMA_FACTOR..SIGMA_FACTOR).contains(&ratio)
    };
    let segment = |(from, to, cell): (usize, usize, Cell)| ForceSegment {
        position: knots.0[from..=to].to_vec(),
        mean_n: mean[from..=to].to_vec(),
        sigma_n: sigma(&cell),
    };
    merged(&cells, alike).into_iter().map(segment).collect()
}

/// Shares over `(state, moved)`.
pub fn moved(knots: &Knots, points: &[(f64, bool)]) -> Vec<MovedSegment> {
    let mut cells = vec![Cell::default(); knots.cells()];
    for &(state, moved) in points {
        cells[knots.place(state).0].add(if moved { 1.0 } else { 0.0 });
    }
    let alike = |a: &Cell, b: &Cell| (a.mean() - b.mean()).abs() < PROBABILITY_STEP;
    let segment = |(from, to, cell): (usize, usize, Cell)| MovedSegment {
        from: knots.0[from],
        to: knots.0[to],
        probability: cell
            .mean()
            .clamp(PROBABILITY_MARGIN, 1.0 - PROBABILITY_MARGIN),
    };
    merged(&cells, alike).into_iter().map(segment).collect()
}

#[derive(Clone, Copy, Default)]
struct Cell {
    sum: f64,
    count: usize,
}

impl Cell {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }

    fn and(&self, other: &Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            count: self.count + other.count,
        }
    }
}

/// Runs of cells `from..to` that are alike or too thin to stand alone.
fn merged(cells: &[Cell], alike: impl Fn(&Cell, &Cell) -> bool) -> Vec<(usize, usize, Cell)> {
    let mut runs: Vec<(usize, usize, Cell)> = Vec::new();
    for (index, cell) in cells.iter().enumerate() {
        match runs.last_mut() {
            Some((_, to, run))
                if run.count < FEWEST_SAMPLES
                    || cell.count < FEWEST_SAMPLES
                    || alike(run, cell) =>
            {
                (*to, *run) = (index + 1, run.and(cell));
            }
            _ => runs.push((index, index + 1, *cell)),
        }
    }
    runs
}

/// Knot values of the piecewise linear least-squares curve, by Gauss-Seidel.
fn curve(knots: &Knots, points: &[(f64, f64)]) -> Vec<f64> {
    let count = knots.0.len();
    let (mut diagonal, mut beside, mut right) =
        (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    for &(state, force) in points {
        let (cell, part) = knots.place(state);
        let rest = 1.0 - part;
        diagonal[cell] += rest * rest;
        diagonal[cell + 1] += part * part;
        beside[cell] += rest * part;
        right[cell] += rest * force;
        right[cell + 1] += part * force;
    }
    let mut values = vec![0.0; count];
    for _ in 0..SWEEPS {
        for i in 0..count {
            let (mut sum, mut weight) = (right[i], diagonal[i]);
            let neighbours = [(i > 0).then(|| i - 1), (i + 1 < count).then_some(i + 1)];
            for j in neighbours.into_iter().flatten() {
                sum += SMOOTHING * values[j] - beside[i.min(j)] * values[j];
                weight += SMOOTHING;
            }
            values[i] = sum / weight;
        }
    }
    values
}
