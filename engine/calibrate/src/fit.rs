//! From readings at joint states to the calibration segments of an object, §III-C.1.
//!
//! For each movement action: the stretch between the limits is cut into regions and fitted
//! (`curve`), m_p is counted (`motion`), and three places get segments of their own:
//! *contact*, at the limit that the action moves towards, where the state stays while the tool
//! presses on; *held*, from where a lock stopped safe mode to where it was recorded again; and
//! *left out*, the end that high-force strokes do not reach. Held and left-out ends count as
//! blocked: m_p is then near 0.

use std::collections::BTreeMap;

use pubs_core::belief::Cloud;
use pubs_core::{Action, Task};
use rayon::prelude::*;

use crate::curve::{self, CurveError, Piece, Readings};
use crate::grid::Grid;
use crate::motion::{self, MARGIN, probability};
use crate::overlay::with_stretch;
use crate::segment::{Channel, Segment, Values};
use crate::traces::{Point, Trace};

/// Cells over the range: a quarter of a degree on a door of 125 degrees.
const CELLS: usize = 500;

/// Share of the range that the contact segment takes.
const CONTACT_SHARE: f64 = 0.0008;

/// A filter knows the state no better than this share of the distance between two particles.
const PLACE_SHARE: f64 = 0.5;

/// The sigma that the slope of the mean adds is written where it is more than this share.
const SLOPE_SHARE: f64 = 0.5;

/// The two accounts of the state differ by the give of grasp and stop, once pressing and once after.
const ACCOUNTS: f64 = 2.0;

/// A region that was found within so many cells of a fixed border is that border.
const APART: usize = 4;

/// What a left-out end says in the file.
pub const LEFT_OUT: &str =
    "left out: high-force demonstrations stop short of this limit; treated as blocked";

/// What a held stretch says in the file.
pub const HELD: &str = "held: safe mode is stopped here by the lock";

/// What a contact segment says in the file.
pub const CONTACT: &str = "contact: the state stays at the limit while the tool presses on";

/// Why nothing could be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// An abstract object.
    #[error("object `{0}` has an abstract joint; only doors and drawers are calibrated")]
    Abstract(String),
    /// An action was not demonstrated.
    #[error("there is no reading of action `{0}`; record it from limit to limit")]
    NoReadings(String),
    /// A channel could not be fitted.
    #[error("`{action}`, {}: {source}", channel.name())]
    Curve {
        /// Name of the action.
        action: String,
        /// Which component.
        channel: Channel,
        /// Why.
        source: CurveError,
    },
}

/// The readings of one action, sorted by what they are good for.
pub struct ActionReadings<'a> {
    task: &'a Task,
    action: &'a Action,
    grid: Grid,
    /// By pull and account: where the action is free to move.
    free: Vec<Vec<&'a Point>>,
    /// At the limit ahead.
    contact: Vec<Vec<&'a Point>>,
    /// Where a lock holds the action.
    held: Vec<Vec<&'a Point>>,
    /// The stretch that is held without any reading beyond.
    held_cells: Option<(usize, usize)>,
    /// The end that was not reached.
    left_out: Option<(usize, usize)>,
}

/// All segments of all movement actions, in the order of actions, channels and states.
///
/// # Errors
/// Where an action has no readings, or readings are not finite.
pub fn fit(task: &Task, traces: &[Trace]) -> Result<Vec<Segment>, FitError> {
    let readings = action_readings(task, traces)?;
    let regions: Vec<Regions> = readings
        .par_iter()
        .map(ActionReadings::regions)
        .collect::<Result<_, FitError>>()?;
    let mut segments = Vec::new();
    for (action, regions) in readings.iter().zip(&regions) {
        segments.extend(action.segments(regions)?);
    }
    Ok(segments)
}

/// For each force channel the cells at which a region of another variance begins.
pub type Regions = [Vec<usize>; 3];

/// The readings of each movement action.
///
/// # Errors
/// Where an action has none.
pub fn action_readings<'a>(
    task: &'a Task,
    traces: &'a [Trace],
) -> Result<Vec<ActionReadings<'a>>, FitError> {
    task.movements()
        .map(|(index, action)| {
            let own: Vec<&Trace> = traces
                .iter()
                .filter(|trace| trace.action == index)
                .collect();
            if own.is_empty() {
                return Err(FitError::NoReadings(action.name.clone()));
            }
            ActionReadings::new(task, action, &own)
        })
        .collect()
}

impl<'a> ActionReadings<'a> {
    fn new(task: &'a Task, action: &'a Action, traces: &[&'a Trace]) -> Result<Self, FitError> {
        let control = task
            .control
            .ok_or_else(|| FitError::Abstract(task.name.clone()))?;
        let joint = &task.joint;
        let mut by_pull: BTreeMap<(u32, bool), Vec<&Point>> = BTreeMap::new();
        for trace in traces {
            by_pull
                .entry((trace.pull, trace.folded))
                .or_default()
                .extend(&trace.points);
        }
        let opens = action.sign() > 0.0;
        let ahead = if opens { joint.upper } else { joint.lower };
        let near = 0.02 * joint.range()
            + 2.0 * joint.per_metre() * control.force_threshold_n
                / control.contact_stiffness_n_per_m;
        let contact = CONTACT_SHARE * joint.range();
        let mut sorted = Self {
            task,
            action,
            grid: Grid::new(joint.lower, joint.upper, CELLS),
            free: Vec::new(),
            contact: Vec::new(),
            held: Vec::new(),
            held_cells: None,
            left_out: None,
        };
        for points in by_pull.into_values() {
            let (contact, inside): (Vec<&Point>, Vec<&Point>) = points
                .into_iter()
                .partition(|point| (point.state - ahead).abs() <= contact);
            let (held, free): (Vec<&Point>, Vec<&Point>) = inside
                .into_iter()
                .partition(|point| point.held && (point.state - ahead).abs() > near);
            sorted.contact.push(contact);
            sorted.held.push(held);
            sorted.free.push(free);
        }
        sorted.find_gaps();
        Ok(sorted)
    }

    fn opens(&self) -> bool {
        self.action.sign() > 0.0
    }

    /// Cells with a reading, in which a filter would weigh forces.
    fn seen(&self) -> Vec<bool> {
        let mut seen = vec![false; self.grid.len()];
        for point in self.free.iter().flatten().filter(|point| point.settled) {
            seen[self.grid.cell(point.state)] = true;
        }
        seen
    }

    fn find_gaps(&mut self) {
        let seen = self.seen();
        let cells = self.grid.len();
        // In the direction of the motion.
        let order = |step: usize| if self.opens() { step } else { cells - 1 - step };
        let span = |from: usize, to: usize| {
            if self.opens() {
                (from, to)
            } else {
                (cells - to, cells - from)
            }
        };
        let step_of = |cell: usize| if self.opens() { cell } else { cells - 1 - cell };
        let held_to = self
            .held
            .iter()
            .flatten()
            .map(|point| step_of(self.grid.cell(point.state)))
            .max();
        let mut gaps = (None, None);
        if let Some(from) = held_to {
            let free_again = (from + 1..cells).find(|&step| seen[order(step)]);
            gaps.0 = free_again.map(|to| span(from, to));
        }
        let last_seen = (0..cells).rev().find(|&step| seen[order(step)]);
        if let Some(last) = last_seen.filter(|_| self.action.is_high_force())
            && last + 1 < cells
        {
            gaps.1 = Some(span(last + 1, cells));
        }
        (self.held_cells, self.left_out) = gaps;
    }

    /// (state, force) of each pull where the action is free to move. A cell in which no reading is
    /// settled, as where high force starts from rest, is known by the others alone.
    pub fn free_pulls(&self, channel: Channel) -> Vec<Readings> {
        let seen = self.seen();
        let of_use = |point: &&&Point| point.settled || !seen[self.grid.cell(point.state)];
        self.free
            .iter()
            .map(|points| {
                let useful = points.iter().filter(of_use);
                useful
                    .map(|point| (point.state, force(point, channel)))
                    .collect()
            })
            .collect()
    }

    /// Where each force changes its variance.
    ///
    /// # Errors
    /// Where readings are not finite.
    pub fn regions(&self) -> Result<Regions, FitError> {
        let of = |channel| {
            curve::regions(&self.grid, &self.free_pulls(channel))
                .map_err(|source| self.failed(channel, source))
        };
        let [along, up, normal] = Channel::FORCES;
        Ok([of(along)?, of(up)?, of(normal)?])
    }

    /// All segments of the action, cut at `regions`.
    ///
    /// # Errors
    /// Where readings are not finite.
    pub fn segments(&self, regions: &Regions) -> Result<Vec<Segment>, FitError> {
        let mut segments = Vec::new();
        for (channel, regions) in Channel::FORCES.into_iter().zip(regions) {
            segments.extend(self.force_segments(channel, regions)?);
        }
        segments.extend(self.motion_segments());
        Ok(segments)
    }

    fn failed(&self, channel: Channel, source: CurveError) -> FitError {
        FitError::Curve {
            action: self.action.name.clone(),
            channel,
            source,
        }
    }

    fn force_segments(
        &self,
        channel: Channel,
        regions: &[usize],
    ) -> Result<Vec<Segment>, FitError> {
        let cuts = self.cuts(regions);
        let pieces = curve::pieces(&self.grid, &self.free_pulls(channel), &cuts)
            .map_err(|source| self.failed(channel, source))?;
        let mut segments: Vec<Segment> = pieces
            .iter()
            .map(|piece| self.force_segment(channel, piece, None))
            .collect();
        for (cells, points, note) in [
            (self.held_cells, Some(&self.held), HELD),
            (self.left_out, None, LEFT_OUT),
        ] {
            let Some((from, to)) = cells else { continue };
            let (from, to) = (self.grid.edge(from), self.grid.edge(to));
            let piece = match points {
                Some(points) => self.constant_piece(channel, points, from, to),
                None => self.continued_piece(&pieces, from, to),
            };
            segments = with_stretch(segments, self.force_segment(channel, &piece, Some(note)));
        }
        if self.contact.iter().any(|pull| !pull.is_empty()) {
            let (from, to) = self.contact_ends();
            let piece = self.constant_piece(channel, &self.contact, from, to);
            segments = with_stretch(segments, self.force_segment(channel, &piece, Some(CONTACT)));
        }
        Ok(segments)
    }

    /// Where regions end in any case: at a held stretch, and where the give of grasp and stop ends
    /// near a limit, since within it the free and the folded account of the state differ.
    fn cuts(&self, regions: &[usize]) -> Vec<usize> {
        let joint = &self.task.joint;
        let give = self.task.control.map_or(0.0, |control| {
            ACCOUNTS * control.force_threshold_n / control.contact_stiffness_n_per_m
        }) * joint.per_metre();
        let mut fixed = vec![
            self.grid.cell(joint.lower + give),
            self.grid.cell(joint.upper - give) + 1,
        ];
        let held = self.held_cells.unwrap_or((0, 0));
        fixed.extend([held.0, held.1]);
        let apart = |cell: &usize| fixed.iter().all(|at| at.abs_diff(*cell) >= APART);
        let inside = |cell: &usize| !(held.0..held.1).contains(cell);
        let mut cuts: Vec<usize> = regions.iter().copied().filter(apart).collect();
        cuts.extend(&fixed);
        cuts.retain(|cell| {
            *cell > 0 && *cell < self.grid.len() && (inside(cell) || *cell == held.0)
        });
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    }

    fn contact_ends(&self) -> (f64, f64) {
        let joint = &self.task.joint;
        let width = CONTACT_SHARE * joint.range();
        if self.opens() {
            (joint.upper - width, joint.upper)
        } else {
            (joint.lower, joint.lower + width)
        }
    }

    /// Mean and spread of what is felt at one place.
    fn constant_piece(&self, channel: Channel, pulls: &[Vec<&Point>], from: f64, to: f64) -> Piece {
        let forces: Vec<Vec<f64>> = pulls
            .iter()
            .map(|points| {
                let settled = points.iter().filter(|point| point.settled);
                settled.map(|point| force(point, channel)).collect()
            })
            .collect();
        let readings: usize = forces.iter().map(Vec::len).sum();
        let mean = forces.iter().flatten().sum::<f64>() / readings.max(1) as f64;
        let residuals: Vec<Vec<f64>> = forces
            .iter()
            .map(|pull| pull.iter().map(|force| force - mean).collect())
            .collect();
        Piece {
            from,
            to,
            position: vec![0.5 * (from + to)],
            mean_n: vec![mean],
            sigma_n: curve::sigma(&residuals).max(curve::SIGMA_FLOOR_N),
            readings,
        }
    }

    /// What was felt last, where the action was not carried on.
    fn continued_piece(&self, pieces: &[Piece], from: f64, to: f64) -> Piece {
        let edge = if self.opens() { from } else { to };
        let around = pieces
            .iter()
            .find(|piece| (piece.from..=piece.to).contains(&edge));
        let (mean_n, sigma_n) = around.map_or((0.0, curve::SIGMA_FLOOR_N), |piece| {
            (piece.mean_at(edge), piece.sigma_n)
        });
        Piece {
            from,
            to,
            position: vec![0.5 * (from + to)],
            mean_n: vec![mean_n],
            sigma_n,
            readings: 0,
        }
    }

    fn force_segment(&self, channel: Channel, piece: &Piece, note: Option<&str>) -> Segment {
        Segment {
            action: self.action.name.clone(),
            channel,
            from: piece.from,
            to: piece.to,
            values: Values::Force {
                position: piece.position.clone(),
                mean_n: piece.mean_n.clone(),
                sigma_n: self.sigmas(piece),
            },
            note: note.map(str::to_owned),
        }
    }

    /// One sigma for the piece, or one for each position where the mean is steep: a particle stands
    /// off the true state, and the force differs by its slope times that distance.
    fn sigmas(&self, piece: &Piece) -> Vec<f64> {
        let place =
            PLACE_SHARE * Cloud::new(&self.task.joint, self.task.belief.particles).spacing();
        let count = piece.position.len();
        let slope = |from: usize, to: usize| {
            (piece.mean_n[to] - piece.mean_n[from]) / (piece.position[to] - piece.position[from])
        };
        let steepest = |index: usize| {
            let before = index
                .checked_sub(1)
                .map_or(0.0, |before| slope(before, index).abs());
            let after = if index + 1 < count {
                slope(index, index + 1).abs()
            } else {
                0.0
            };
            before.max(after)
        };
        let added: Vec<f64> = (0..count).map(|index| steepest(index) * place).collect();
        if added
            .iter()
            .all(|&added| added <= SLOPE_SHARE * piece.sigma_n)
        {
            return vec![piece.sigma_n];
        }
        added
            .iter()
            .map(|added| piece.sigma_n.hypot(*added))
            .collect()
    }

    fn motion_segments(&self) -> Vec<Segment> {
        let stop_n = stop_force_n(self.task, self.action);
        let joint = &self.task.joint;
        let ahead = if self.opens() {
            joint.upper
        } else {
            joint.lower
        };
        let seen = self.seen();
        let contact = CONTACT_SHARE * joint.range();
        let (mut pulls, mut at_limit) = (Vec::new(), (0, 0));
        for ((free, held), contacts) in self.free.iter().zip(&self.held).zip(&self.contact) {
            let mut readings = Vec::new();
            for point in free.iter().chain(held).chain(contacts) {
                let moves = point.force_before_n <= stop_n;
                if (point.before - ahead).abs() <= contact {
                    at_limit.0 += usize::from(moves && point.settled);
                    at_limit.1 += usize::from(point.settled);
                } else if point.settled || !seen[self.grid.cell(point.before)] {
                    readings.push((point.before, moves));
                }
            }
            pulls.push(readings);
        }
        let mut segments: Vec<Segment> = motion::stretches(&self.grid, &pulls)
            .iter()
            .map(|stretch| {
                let (from, to) = (self.grid.edge(stretch.from), self.grid.edge(stretch.to));
                self.motion_segment(from, to, stretch.probability, None)
            })
            .collect();
        for (cells, note) in [(self.held_cells, HELD), (self.left_out, LEFT_OUT)] {
            if let Some((from, to)) = cells {
                let (from, to) = (self.grid.edge(from), self.grid.edge(to));
                let stretch = self.motion_segment(from, to, MARGIN, Some(note));
                segments = with_stretch(segments, stretch);
            }
        }
        if at_limit.1 > 0 {
            let (from, to) = self.contact_ends();
            let probability = probability(at_limit.0, at_limit.1);
            let stretch = self.motion_segment(from, to, probability, Some(CONTACT));
            segments = with_stretch(segments, stretch);
        }
        segments
    }

    fn motion_segment(&self, from: f64, to: f64, probability: f64, note: Option<&str>) -> Segment {
        Segment {
            action: self.action.name.clone(),
            channel: Channel::Moves,
            from,
            to,
            values: Values::Moves { probability },
            note: note.map(str::to_owned),
        }
    }
}

/// Where a channel of a reading belongs, and its value: a force at the state it was felt at, m_p (0
/// or 1) at the state before, since the force there decides.
pub fn value(task: &Task, action: usize, point: &Point, channel: Channel) -> (f64, f64) {
    match channel {
        Channel::Moves => {
            let moves = point.force_before_n <= stop_force_n(task, &task.actions[action]);
            (point.before, f64::from(u8::from(moves)))
        }
        channel => (point.state, force(point, channel)),
    }
}

fn force(point: &Point, channel: Channel) -> f64 {
    let [along, up, normal] = point.forces_n;
    match channel {
        Channel::Along | Channel::Moves => along,
        Channel::Up => up,
        Channel::Normal => normal,
    }
}

/// The force above which an action stands still, N: F_t in safe mode; in high-force mode where the
/// guard would stop it.
fn stop_force_n(task: &Task, action: &Action) -> f64 {
    let Some(control) = task.control else {
        return f64::INFINITY;
    };
    if action.is_high_force() {
        control.force_limit_n - control.stop_overshoot_n(control.high_speed_m_s)
    } else {
        control.force_threshold_n
    }
}
