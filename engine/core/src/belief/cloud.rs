//! Where the particles are.

use crate::Joint;
use crate::vector::{Arithmetic, VectorUnit, dispatched};

/// N particles that started evenly over the prior and have moved together ever since, each
/// staying at a limit that it was pushed past; always in ascending order.
///
/// On a continuous joint, particle i is at clamp(first + i·spacing, low, high): moving by d and
/// staying inside the limits keeps that form, so four numbers describe them all and a model can
/// answer for the whole grid without look-ups.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    unit: VectorUnit,
    first: f64,
    spacing: f64,
    low: f64,
    high: f64,
    limits: (f64, f64),
    integer: bool,
    states: Vec<f32>,
}

impl Cloud {
    /// The prior, covered evenly from end to end: joints are often left at a limit, and a particle
    /// must be there. On an integer joint each state has as many particles as any other, give or
    /// take one.
    pub fn new(joint: &Joint, particles: usize) -> Self {
        Self::on(VectorUnit::best(), joint, particles)
    }

    /// The same, computed on a chosen vector unit.
    pub fn on(unit: VectorUnit, joint: &Joint, particles: usize) -> Self {
        let (from, to) = joint.start;
        let integer = joint.is_integer();
        let spacing = if integer {
            (to - from + 1.0) / particles as f64
        } else {
            (to - from) / (particles - 1) as f64
        };
        let mut cloud = Self {
            unit,
            first: from,
            spacing,
            low: joint.lower,
            high: joint.upper,
            limits: (joint.lower, joint.upper),
            integer,
            states: vec![0.0; particles],
        };
        if integer {
            for (index, state) in cloud.states.iter_mut().enumerate() {
                // Each whole number owns the half-unit on either side of it.
                let place = from - 0.5 + (index as f64 + 0.5) * spacing;
                *state = place.round().clamp(joint.lower, joint.upper) as f32;
            }
        } else {
            cloud.place();
        }
        cloud
    }

    /// Distance between neighbours inside the limits.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The particles, ascending.
    pub fn states(&self) -> &[f32] {
        &self.states
    }

    /// State of particle 0 if no limit had ever stopped it; `None` where the particles are not on
    /// a grid.
    pub fn grid_first(&self) -> Option<f64> {
        (!self.integer).then_some(self.first)
    }

    /// Where the particles gather that a limit has stopped: (low, how many are there) and (high,
    /// how many are there). Only on a grid.
    pub fn gathered(&self) -> [(f64, usize); 2] {
        let count = self.states.len();
        let below = ((self.low - self.first) / self.spacing)
            .ceil()
            .clamp(0.0, count as f64) as usize;
        let reached = ((self.high - self.first) / self.spacing).floor() + 1.0;
        let above = count - reached.clamp(0.0, count as f64) as usize;
        [(self.low, below), (self.high, above)]
    }

    /// Moves every particle by `displacement`; who would pass a limit stays at it.
    pub fn shift(&mut self, displacement: f64) {
        let (lower, upper) = self.limits;
        if self.integer {
            for state in &mut self.states {
                *state = (f64::from(*state) + displacement).clamp(lower, upper) as f32;
            }
            return;
        }
        self.first += displacement;
        self.low = (self.low + displacement).clamp(lower, upper);
        self.high = (self.high + displacement).clamp(lower, upper);
        self.place();
    }

    fn place(&mut self) {
        let (first, spacing) = (self.first as f32, self.spacing as f32);
        place_on_grid(
            self.unit,
            &mut self.states,
            first,
            spacing,
            self.low as f32,
            self.high as f32,
        );
    }
}

#[inline(always)]
fn place_body<A: Arithmetic>(states: &mut [f32], first: f32, spacing: f32, low: f32, high: f32) {
    for (index, state) in states.iter_mut().enumerate() {
        let place = A::multiply_add(index as i32 as f32, spacing, first);
        // Not `clamp`, which may panic and so keeps the loop from becoming vector code.
        *state = place.max(low).min(high);
    }
}

dispatched! {
    /// Places particle i at clamp(first + i·spacing, low, high).
    fn place_on_grid(states: &mut [f32], first: f32, spacing: f32, low: f32, high: f32) = place_body
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::JointKind;

    fn joint(integer: bool) -> Joint {
        Joint {
            kind: JointKind::Abstract { integer },
            lower: 0.0,
            upper: 10.0,
            start: (0.0, 10.0),
        }
    }

    #[test]
    fn four_numbers_describe_what_moving_each_particle_alone_gives() {
        let mut cloud = Cloud::new(&joint(false), 37);
        let mut alone: Vec<f64> = cloud
            .states()
            .iter()
            .map(|&state| f64::from(state))
            .collect();
        for displacement in [
            0.3, -0.35, 4.0, 7.5, -2.2, -3.0, 1.0, -20.0, 0.4, -0.1, 30.0, -5.0,
        ] {
            cloud.shift(displacement);
            for state in &mut alone {
                *state = (*state + displacement).clamp(0.0, 10.0);
            }
            for (index, (&found, &expected)) in cloud.states().iter().zip(&alone).enumerate() {
                let error = (f64::from(found) - expected).abs();
                assert!(
                    error < 1e-5,
                    "particle {index} at {found}, alone at {expected}, after {displacement}"
                );
            }
            let [(low, below), (high, above)] = cloud.gathered();
            let at = |place: f64| {
                alone
                    .iter()
                    .filter(|&&state| (state - place).abs() < 1e-9)
                    .count()
            };
            if low < high {
                assert!(
                    below <= at(low) && at(low) <= below + 1,
                    "{below} gathered at {low}, expected {}",
                    at(low)
                );
                assert!(
                    above <= at(high) && at(high) <= above + 1,
                    "{above} gathered at {high}, expected {}",
                    at(high)
                );
            }
        }
    }

    #[test]
    fn integer_states_share_the_particles_evenly() {
        let cloud = Cloud::new(&joint(true), 100);
        for state in 0..=10 {
            let count = cloud
                .states()
                .iter()
                .filter(|&&found| found == state as f32)
                .count();
            assert!((9..=10).contains(&count), "{count} particles at {state}");
        }
    }

    #[test]
    fn particles_cover_the_prior_from_end_to_end() {
        let cloud = Cloud::new(&joint(false), 5);
        assert_eq!(cloud.states(), [0.0, 2.5, 5.0, 7.5, 10.0]);
    }
}
