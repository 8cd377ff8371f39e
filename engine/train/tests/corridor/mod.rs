//! A corridor of nine places: pays 1 for stopping at place 6 and −1 elsewhere, −0.01 per move.
//!
//! A move slips to the other side one time in ten, and cannot be made through a wall. Episodes
//! start anywhere and are truncated after 20 steps.

use pubs_train::{End, Environments, StepOutcome, rng};
use rand::RngExt;

pub const STATES: usize = 9;
pub const ACTIONS: usize = 3;
pub const DISCOUNT: f32 = 0.9;
const GOAL: usize = 6;
const SLIP: f64 = 0.1;
const LONGEST: usize = 20;

/// What goes wrong after a hundred steps.
#[derive(Clone, Copy, PartialEq)]
pub enum Fault {
    None,
    BadReward,
    HugeReward,
    BadFeature,
    NothingAllowed,
    Broken,
}

#[derive(Debug, thiserror::Error)]
#[error("the corridor is closed")]
pub struct Closed;

pub struct Corridor {
    places: Vec<usize>,
    steps: Vec<usize>,
    last: Vec<usize>,
    generator: rng::Generator,
    done: usize,
    pub pays_every_step: bool,
    pub fault: Fault,
}

impl Corridor {
    pub fn new(count: usize, seed: u64) -> Self {
        let mut generator = rng::stream(seed, "corridor");
        Self {
            places: (0..count)
                .map(|_| generator.random_range(0..STATES))
                .collect(),
            steps: vec![0; count],
            last: vec![0; count],
            generator,
            done: 0,
            pays_every_step: false,
            fault: Fault::None,
        }
    }

    fn has(&self, fault: Fault) -> bool {
        self.fault == fault && self.done >= 100
    }

    fn walk(&mut self, index: usize, action: usize) -> StepOutcome {
        let place = self.places[index];
        if action == 0 && !self.pays_every_step {
            let success = place == GOAL;
            let reward = if success { 1.0 } else { -1.0 };
            return StepOutcome {
                reward,
                end: Some(End::Terminated),
                success,
                violation: false,
            };
        }
        let slips = self.generator.random_bool(SLIP);
        self.places[index] = moved(place, (action == 2) != slips);
        let reward = if self.pays_every_step { 1.0 } else { -0.01 };
        let end = (self.steps[index] + 1 == LONGEST).then_some(End::Truncated);
        StepOutcome {
            reward,
            end,
            ..StepOutcome::default()
        }
    }
}

impl Environments for Corridor {
    type Error = Closed;

    fn count(&self) -> usize {
        self.places.len()
    }

    fn features(&self) -> usize {
        1
    }

    fn actions(&self) -> usize {
        ACTIONS
    }

    fn observe(&self, features: &mut [f32], allowed: &mut [bool]) {
        for (i, place) in self.places.iter().enumerate() {
            features[i] = *place as f32;
            allowed[i * ACTIONS..][..ACTIONS].copy_from_slice(&mask(*place));
        }
        if self.has(Fault::BadFeature) {
            features[0] = f32::NAN;
        }
        if self.has(Fault::NothingAllowed) {
            allowed[..ACTIONS].fill(false);
        }
    }

    fn step(&mut self, actions: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), Closed> {
        if self.has(Fault::Broken) {
            return Err(Closed);
        }
        for (i, (action, outcome)) in actions.iter().zip(outcomes.iter_mut()).enumerate() {
            assert!(
                mask(self.places[i])[*action],
                "{action} is masked at {}",
                self.places[i]
            );
            *outcome = self.walk(i, *action);
            self.steps[i] += 1;
            if outcome.end.is_some() {
                self.last[i] = self.places[i];
                self.places[i] = self.generator.random_range(0..STATES);
                self.steps[i] = 0;
            }
        }
        if self.has(Fault::BadReward) {
            outcomes[0].reward = f32::NAN;
        }
        if self.has(Fault::HugeReward) {
            outcomes[0].reward = 1e30;
        }
        self.done += 1;
        Ok(())
    }

    fn last_features(&self, index: usize, features: &mut [f32]) {
        features[0] = self.last[index] as f32;
    }
}

fn mask(place: usize) -> [bool; ACTIONS] {
    [true, place > 0, place + 1 < STATES]
}

fn moved(place: usize, up: bool) -> usize {
    if up {
        (place + 1).min(STATES - 1)
    } else {
        place.saturating_sub(1)
    }
}

pub fn all_features() -> Vec<f32> {
    (0..STATES).map(|place| place as f32).collect()
}

pub fn all_masks() -> Vec<bool> {
    (0..STATES).flat_map(mask).collect()
}

/// Expected discounted return of an action, the rest being worth `values`.
fn worth(place: usize, action: usize, values: &[f64]) -> f64 {
    match action {
        0 if place == GOAL => 1.0,
        0 => -1.0,
        _ => {
            let up = action == 2;
            let next = (1.0 - SLIP) * values[moved(place, up)] + SLIP * values[moved(place, !up)];
            -0.01 + f64::from(DISCOUNT) * next
        }
    }
}

fn iterate(choose: impl Fn(usize, &[f64]) -> f64) -> f64 {
    let mut values = vec![0.0; STATES];
    for _ in 0..1000 {
        values = (0..STATES).map(|place| choose(place, &values)).collect();
    }
    values.iter().sum::<f64>() / STATES as f64
}

/// Mean over the places of the best discounted return there is (without the cap on steps).
pub fn value_iteration() -> f64 {
    iterate(|place, values| {
        let allowed = (0..ACTIONS).filter(|action| mask(place)[*action]);
        allowed
            .map(|action| worth(place, action, values))
            .fold(f64::MIN, f64::max)
    })
}

/// The same for a policy that takes `chosen[place]`.
pub fn value_of(chosen: &[usize]) -> f64 {
    iterate(|place, values| worth(place, chosen[place], values))
}
