//! Whether the handle is still in the fingers and still moves: what no single reading can show.
//!
//! | trip | when | noticed after |
//! |---|---|---|
//! | [`Trip::LostGrasp`] | over the last [`WINDOW_S`] of motion, all one way, less than [`LOST_SHARE`] of the force was felt that the object never falls below over such a way | 0.5 s of motion |
//! | [`Trip::Held`] | an action pushed with more than half of F_t and the handle stayed within [`HELD_M`] | [`HELD_S`] of pushing |
//!
//! What is felt is the length of (f_d, f_z, f_n), each averaged over [`GROUP`] periods against the
//! sensor's noise, and that averaged over the window: a catch that pulls where friction pushed is
//! felt, too.

use std::collections::VecDeque;

use pubs_core::Task;
use pubs_core::belief::{Model, ModelError};
use pubs_core::controller::Control;
use pubs_plugin::{Support, Transitions};

use crate::guard::Trip;
use crate::messages::Sample;

/// Time of motion over which forces are averaged, s.
pub const WINDOW_S: f64 = 0.5;

/// A window must cover this share of the way at safe speed: a handle that lingers near a catch may
/// feel like nothing.
const WAY_SHARE: f64 = 0.8;

/// Control periods whose forces are averaged before their length is taken.
pub const GROUP: usize = 5;

/// Share of the least force below which the fingers hold nothing.
pub const LOST_SHARE: f64 = 0.5;

/// An object that may be felt less than this says nothing of the grasp, N.
const LEAST_TELLING_N: f64 = 0.6;

/// A handle that stays within this has not moved, m: grasp and stops give way by less.
pub const HELD_M: f64 = 0.01;

/// A handle may be pushed hard without moving for so long, s.
pub const HELD_S: f64 = 2.0;

/// Share of F_t above which an action pushes hard: no free motion comes near it.
const HARD_SHARE: f64 = 0.5;

/// States at which a model is asked.
const STATES: usize = 400;

/// Watches the samples of a run.
#[derive(Debug, Clone)]
pub struct GripWatch {
    stop: usize,
    rate_hz: f64,
    per_metre: f64,
    hard_n: f64,
    way_m: f64,
    least_n: Option<f64>,
    felt: VecDeque<Felt>,
    held: Option<Held>,
}

/// One control period in motion.
#[derive(Debug, Clone, Copy)]
struct Felt {
    displacement: f64,
    forces_n: [f64; 3],
}

/// Where the handle was when it last moved, and for how many periods it has been pushed since.
#[derive(Debug, Clone, Copy)]
struct Held {
    displacement: f64,
    periods: u32,
}

impl GripWatch {
    /// A watch for a task's object as its model knows it.
    ///
    /// # Errors
    /// Where the model cannot answer.
    pub fn new(task: &Task, control: &Control, model: &dyn Model) -> Result<Self, ModelError> {
        let least_n = least_felt_n(task, control, model)?;
        Ok(Self {
            stop: task.stop,
            rate_hz: control.rate_hz,
            per_metre: task.joint.per_metre(),
            hard_n: HARD_SHARE * control.force_threshold_n,
            way_m: WAY_SHARE * WINDOW_S * control.safe_speed_m_s,
            least_n: least_n.filter(|least_n| *least_n >= LEAST_TELLING_N),
            felt: VecDeque::new(),
            held: None,
        })
    }

    /// The next control period; `stopping` where the arm comes to rest whatever is ordered.
    pub fn see(&mut self, sample: &Sample, stopping: bool) -> Option<Trip> {
        let moves = !stopping && sample.action != self.stop;
        self.lost(sample).or_else(|| self.is_held(sample, moves))
    }

    fn lost(&mut self, sample: &Sample) -> Option<Trip> {
        let least_n = self.least_n?;
        if sample.speed_m_s == 0.0 {
            return None;
        }
        let window = (WINDOW_S * self.rate_hz).ceil() as usize;
        self.felt.push_back(Felt {
            displacement: sample.displacement,
            forces_n: sample.forces_n,
        });
        if self.felt.len() > window {
            self.felt.pop_front();
        }
        let felt_n = felt_n(self.felt.make_contiguous());
        let from = self.felt.front().map_or(0.0, |felt| felt.displacement);
        let way_m = (sample.displacement - from).abs() / self.per_metre;
        let lost =
            self.felt.len() == window && way_m >= self.way_m && felt_n < LOST_SHARE * least_n;
        lost.then_some(Trip::LostGrasp { felt_n, least_n })
    }

    fn is_held(&mut self, sample: &Sample, moves: bool) -> Option<Trip> {
        if !moves {
            self.held = None;
            return None;
        }
        let fresh = Held {
            displacement: sample.displacement,
            periods: 0,
        };
        let held = self.held.get_or_insert(fresh);
        let moved_m = (sample.displacement - held.displacement).abs() / self.per_metre;
        if moved_m > HELD_M {
            *held = fresh;
        }
        // A reversal takes force too, so only what is steady counts.
        if sample.settled && sample.forces_n[0] > self.hard_n {
            held.periods += 1;
        }
        let held_s = f64::from(held.periods) / self.rate_hz;
        (held_s > HELD_S).then_some(Trip::Held { held_s })
    }
}

/// Length of the forces, averaged over groups and then over these.
fn felt_n(window: &[Felt]) -> f64 {
    let lengths = window.chunks(GROUP).map(|group| {
        let mut sum = [0.0; 3];
        for felt in group {
            for (sum, force_n) in sum.iter_mut().zip(felt.forces_n) {
                *sum += force_n;
            }
        }
        length(sum)
    });
    lengths.sum::<f64>() / window.len().max(1) as f64
}

/// The least force that the object is felt by, averaged over the way that a watch's window covers
/// at safe speed, over all moves and states; `None` where the model has no moments of forces.
fn least_felt_n(
    task: &Task,
    control: &Control,
    model: &dyn Model,
) -> Result<Option<f64>, ModelError> {
    let names = ["f_d", "f_z", "f_n"];
    let channels = model.channels();
    let forces: Vec<usize> = names
        .iter()
        .filter_map(|name| channels.iter().position(|channel| channel.name == *name))
        .collect();
    if forces.is_empty() {
        return Ok(None);
    }
    let states: Vec<f32> = (0..STATES)
        .map(|index| task.joint.at_fraction(index as f64 / (STATES - 1) as f64) as f32)
        .collect();
    let spacing_m = task.joint.range() / task.joint.per_metre() / (STATES - 1) as f64;
    let window = (control.safe_speed_m_s * WINDOW_S / spacing_m).ceil() as usize;
    let window = window.clamp(1, STATES);
    let mut mean = vec![0.0_f32; channels.len() * STATES];
    let mut sigma = mean.clone();
    let mut least_n = f64::INFINITY;
    for (action, _) in task.movements() {
        let transitions = Transitions {
            action,
            before: &states,
            after: &states,
        };
        if model.moments(transitions, &mut mean, &mut sigma)? == Support::Absent {
            return Ok(None);
        }
        let forces: Vec<&[f32]> = forces
            .iter()
            .map(|&channel| &mean[channel * STATES..(channel + 1) * STATES])
            .collect();
        let lengths: Vec<f64> = (0..STATES)
            .map(|state| {
                let squares = forces
                    .iter()
                    .map(|force_n| f64::from(force_n[state]).powi(2));
                squares.sum::<f64>().sqrt()
            })
            .collect();
        for part in lengths.windows(window) {
            least_n = least_n.min(part.iter().sum::<f64>() / window as f64);
        }
    }
    Ok(Some(least_n))
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const RATE_HZ: f64 = 100.0;

    fn watch(least_n: Option<f64>) -> GripWatch {
        GripWatch {
            stop: 0,
            rate_hz: RATE_HZ,
            per_metre: 1.0,
            hard_n: 7.5,
            way_m: 0.02,
            least_n,
            felt: VecDeque::new(),
            held: None,
        }
    }

    /// When and why the watch trips, s.
    fn trips_after(
        mut watch: GripWatch,
        seconds: f64,
        sample: impl Fn(f64) -> Sample,
    ) -> Option<(f64, Trip)> {
        (1..=(seconds * RATE_HZ) as u32).find_map(|tick| {
            let time_s = f64::from(tick) / RATE_HZ;
            watch.see(&sample(time_s), false).map(|trip| (time_s, trip))
        })
    }

    fn moving(time_s: f64, forces_n: [f64; 3]) -> Sample {
        Sample {
            displacement: 0.05 * time_s,
            action: 1,
            forces_n,
            speed_m_s: 0.05,
            ..Sample::default()
        }
    }

    #[test]
    fn a_lost_grasp_is_noticed_after_half_a_second_of_feeling_nothing() {
        let nothing = [0.1, -0.1, 0.0];
        let (after_s, trip) =
            trips_after(watch(Some(2.0)), 2.0, |time_s| moving(time_s, nothing)).unwrap();
        assert!((after_s - WINDOW_S).abs() < 1e-9, "after {after_s} s");
        assert!(matches!(trip, Trip::LostGrasp { .. }), "{trip:?}");
        // 3 N until 1 s, then nothing: the average falls below 1 N when a third is left, 2/3 of
        // the window later.
        let slips = |time_s| {
            let felt = if time_s <= 1.0 {
                [3.0, 0.0, 0.0]
            } else {
                [0.0; 3]
            };
            moving(time_s, felt)
        };
        let (after_s, _) = trips_after(watch(Some(2.0)), 2.0, slips).unwrap();
        assert!((after_s - 1.34).abs() < 0.011, "after {after_s} s");
    }

    #[test]
    fn what_is_felt_or_cannot_be_told_trips_nothing() {
        let cases = [
            (Some(2.0), [1.2, 0.0, 0.0], "more than half of the least"),
            (Some(2.0), [0.0, 0.0, -1.5], "felt across the path"),
            (None, [0.0; 3], "an object that may be felt as nothing"),
        ];
        let lingers = |time_s| Sample {
            displacement: 0.01,
            ..moving(time_s, [0.0; 3])
        };
        assert_eq!(trips_after(watch(Some(2.0)), 3.0, lingers), None);
        for (least_n, forces_n, name) in cases {
            let tripped = trips_after(watch(least_n), 3.0, |time_s| moving(time_s, forces_n));
            assert_eq!(tripped, None, "{name}");
        }
    }

    #[test]
    fn a_handle_is_held_only_while_it_is_pushed_hard_and_stays() {
        let pushed = |displacement, force_n| Sample {
            displacement,
            action: 1,
            forces_n: [force_n, 0.0, 0.0],
            settled: true,
            ..Sample::default()
        };
        let (after_s, trip) = trips_after(watch(None), 5.0, |_| pushed(0.1, 15.0)).unwrap();
        assert!((after_s - HELD_S).abs() < 0.02, "after {after_s} s");
        assert!(matches!(trip, Trip::Held { .. }), "{trip:?}");
        let gives_way = |time_s: f64| pushed(0.02 * time_s, 15.0);
        assert_eq!(trips_after(watch(None), 5.0, gives_way), None, "it moves");
        let free = |_| pushed(0.1, 3.0);
        assert_eq!(trips_after(watch(None), 5.0, free), None, "not pushed");
        let dithers = |_| Sample {
            settled: false,
            ..pushed(0.1, 15.0)
        };
        assert_eq!(trips_after(watch(None), 5.0, dithers), None, "it turns");
    }
}
