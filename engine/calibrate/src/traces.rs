//! From frames to readings at joint states.
//!
//! The zero is where the closed limit begins to press (`contact`). From it, two accounts of the
//! state are kept, because a filter may hold either. In the *free* account the state is the tool's
//! way from the zero. In the *folded* account it is what a particle does: it stays at a limit while
//! the tool presses on, and so is ahead by the give of grasp and stop once the tool has turned
//! round. Where a force is steep the two differ, and the spread between them is what a filter must
//! expect.

use pubs_core::Task;
use pubs_core::controller::Control;
use pubs_core::joint::{Direction, Path, Pose};
use pubs_plugin::Reading;
use pubs_run::recording::{Frame, Recording};

use crate::contact::rest_displacement;

/// A tool that stands against at least this share of the threshold is held.
const HELD_SHARE: f64 = 0.7;

/// What one reading says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Joint state at the filter update before (rad or m).
    pub before: f64,
    /// Joint state now.
    pub state: f64,
    /// (f_d, f_z, f_n), N.
    pub forces_n: [f64; 3],
    /// f_d at the filter update before, N.
    pub force_before_n: f64,
    /// Whether a filter would weigh it: the arm moved as asked at both updates.
    pub settled: bool,
    /// Whether the controller stood still because of the force.
    pub held: bool,
}

/// The readings of one stroke, by one account of the state.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Index of the action.
    pub action: usize,
    /// Which pull it belongs to: equal for all strokes of one demonstration.
    pub pull: u32,
    /// Whether states fold at limits, as particles do.
    pub folded: bool,
    /// In the order of time.
    pub points: Vec<Point>,
}

/// What a recording says about the object's limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Times the closed limit was touched.
    pub closed_touches: usize,
    /// Times the open limit was touched.
    pub open_touches: usize,
    /// Measured distance between the limits (rad or m), where both were touched.
    pub range: Option<f64>,
    /// Greatest difference between two touches of one limit (rad or m): the grasp slips, or the
    /// object shifts.
    pub scatter: f64,
}

/// Why a recording gives no states.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// An abstract object.
    #[error("object `{0}` has an abstract joint; only doors and drawers are calibrated")]
    Abstract(String),
    /// No frames.
    #[error("the recording holds no readings")]
    Empty,
    /// No limit was touched.
    #[error(
        "no limit is touched: nowhere does the force along a safe motion reach {0:.1} N while the arm stands still, so the zero of the joint is not known; \
         record again from limit to limit"
    )]
    NoTouch(f64),
}

/// A stroke: frames `from..to` under one movement action.
struct Stroke {
    from: usize,
    to: usize,
    action: usize,
    demonstration: u32,
}

/// Frames made ready: way and forces of each.
struct Ways<'a> {
    task: &'a Task,
    control: Control,
    frames: &'a [Frame],
    displacement: Vec<f64>,
    forces_n: Vec<[f64; 3]>,
}

/// The readings of a recording. `first_pull` is added to demonstration numbers, so that pulls of
/// several recordings stay apart.
///
/// # Errors
/// Where no limit is touched.
pub fn traces(
    task: &Task,
    recording: &Recording,
    first_pull: u32,
) -> Result<(Vec<Trace>, Limits), TraceError> {
    let ways = Ways::of(task, recording)?;
    let strokes = ways.strokes();
    let (zero, limits) = ways.zero(&strokes)?;
    let free: Vec<f64> = ways
        .displacement
        .iter()
        .map(|way| task.joint.lower + way - zero)
        .collect();
    let folded = folded(&free, task.joint.lower, task.joint.upper);
    let lag = (ways.control.rate_hz / task.belief.rate_hz)
        .round()
        .max(1.0) as usize;
    let mut traces = Vec::new();
    for stroke in strokes.iter().filter(|stroke| stroke.demonstration > 0) {
        for (folds, states) in [(false, &free), (true, &folded)] {
            let points = ways.points(stroke, states, lag, folds);
            if !points.is_empty() {
                traces.push(Trace {
                    action: stroke.action,
                    pull: first_pull + stroke.demonstration,
                    folded: folds,
                    points,
                });
            }
        }
    }
    Ok((traces, limits))
}

/// What a particle does that starts at the true state.
fn folded(free: &[f64], lower: f64, upper: f64) -> Vec<f64> {
    let mut state = free.first().copied().unwrap_or(lower).clamp(lower, upper);
    let mut last = free.first().copied().unwrap_or(lower);
    free.iter()
        .map(|&now| {
            state = (state + now - last).clamp(lower, upper);
            last = now;
            state
        })
        .collect()
}

impl<'a> Ways<'a> {
    fn of(task: &'a Task, recording: &'a Recording) -> Result<Self, TraceError> {
        let abstract_joint = || TraceError::Abstract(task.name.clone());
        let control = task.control.ok_or_else(abstract_joint)?;
        let frames = recording.frames.as_slice();
        let first = frames.first().ok_or(TraceError::Empty)?;
        let path = Path::at_grasp(&task.joint, &pose(&first.reading)).ok_or_else(abstract_joint)?;
        let displacement = frames
            .iter()
            .map(|frame| path.displacement(&pose(&frame.reading)))
            .collect();
        let forces_n = frames
            .iter()
            .map(|frame| forces_of(task, &path, frame))
            .collect();
        Ok(Self {
            task,
            control,
            frames,
            displacement,
            forces_n,
        })
    }

    fn strokes(&self) -> Vec<Stroke> {
        let mut strokes: Vec<Stroke> = Vec::new();
        for (index, frame) in self.frames.iter().enumerate() {
            match strokes.last_mut() {
                Some(stroke)
                    if stroke.to == index
                        && (stroke.action, stroke.demonstration)
                            == (frame.action, frame.demonstration) =>
                {
                    stroke.to = index + 1;
                }
                _ => strokes.push(Stroke {
                    from: index,
                    to: index + 1,
                    action: frame.action,
                    demonstration: frame.demonstration,
                }),
            }
        }
        strokes.retain(|stroke| !self.task.actions[stroke.action].is_stop());
        strokes
    }

    /// The displacement at the closed limit.
    fn zero(&self, strokes: &[Stroke]) -> Result<(f64, Limits), TraceError> {
        let (mut closed, mut open) = (Vec::new(), Vec::new());
        let touches: Vec<(f64, f64)> = strokes
            .iter()
            .filter_map(|stroke| Some((self.sign(stroke), self.touch(stroke)?)))
            .collect();
        let range = self.task.joint.range();
        let lowest = touches
            .iter()
            .map(|&(_, way)| way)
            .fold(f64::INFINITY, f64::min);
        for (sign, way) in touches {
            // A pull that a lock holds ends near the closed limit: it is no touch of the open one.
            if sign < 0.0 && way < lowest + 0.5 * range {
                closed.push(way);
            } else if sign > 0.0 && (way > lowest + 0.5 * range || closed.is_empty()) {
                open.push(way);
            }
        }
        let limits = Limits {
            closed_touches: closed.len(),
            open_touches: open.len(),
            range: median(&open)
                .zip(median(&closed))
                .map(|(open, closed)| open - closed),
            scatter: scatter(&closed).max(scatter(&open)),
        };
        let zero = median(&closed).or_else(|| Some(median(&open)? - range));
        let threshold_n = HELD_SHARE * self.control.force_threshold_n;
        Ok((zero.ok_or(TraceError::NoTouch(threshold_n))?, limits))
    }

    fn sign(&self, stroke: &Stroke) -> f64 {
        self.task.actions[stroke.action].sign()
    }

    /// Where a safe stroke that ends held began to press.
    fn touch(&self, stroke: &Stroke) -> Option<f64> {
        if self.task.actions[stroke.action].is_high_force() || !self.is_held(stroke.to - 1) {
            return None;
        }
        let approach: Vec<(f64, f64)> = (stroke.from..stroke.to)
            .map(|index| (self.displacement[index], self.forces_n[index][0]))
            .collect();
        let stiffness_n = self.control.contact_stiffness_n_per_m / self.task.joint.per_metre();
        rest_displacement(
            &approach,
            self.sign(stroke),
            self.control.force_threshold_n,
            stiffness_n,
        )
    }

    fn is_held(&self, index: usize) -> bool {
        let frame = &self.frames[index];
        // A reading just below the threshold lets the arm take a small step; it is held all the same.
        let slow = frame.speed_m_s.abs() < 0.5 * self.control.safe_speed_m_s;
        slow && self.forces_n[index][0] > HELD_SHARE * self.control.force_threshold_n
            && !self.task.actions[frame.action].is_stop()
            && !self.task.actions[frame.action].is_high_force()
    }

    fn points(&self, stroke: &Stroke, states: &[f64], lag: usize, folds: bool) -> Vec<Point> {
        let joint = &self.task.joint;
        let sign = self.sign(stroke);
        let leaves_a_press = |state: f64| {
            let behind = if sign > 0.0 {
                joint.lower - state
            } else {
                state - joint.upper
            };
            !folds && behind > 0.0
        };
        let inside = |state: f64| state.clamp(joint.lower, joint.upper);
        (stroke.from + lag..stroke.to)
            .filter(|&index| !leaves_a_press(states[index - lag]))
            .map(|index| Point {
                before: inside(states[index - lag]),
                state: inside(states[index]),
                forces_n: self.forces_n[index],
                force_before_n: self.forces_n[index - lag][0],
                settled: self.frames[index].settled && self.frames[index - lag].settled,
                held: self.is_held(index) && self.frames[index].settled,
            })
            .collect()
    }
}

fn pose(reading: &Reading) -> Pose {
    Pose::new(reading.position_m, reading.orientation_xyzw)
}

fn forces_of(task: &Task, path: &Path, frame: &Frame) -> [f64; 3] {
    let direction = Direction::of(task.actions[frame.action].sign());
    let pose = pose(&frame.reading);
    let force = pose.orientation * nalgebra::Vector3::from(frame.reading.force_n);
    path.frame(&pose, direction).decompose(&force)
}

fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        count if count % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

fn scatter(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high - low).max(0.0)
}
