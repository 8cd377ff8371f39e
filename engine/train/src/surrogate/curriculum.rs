//! Where training episodes start: easy at first.

use pubs_core::Joint;
use rand::{Rng, RngExt};

use super::draw_start;

/// Where training episodes start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curriculum {
    /// At either end of the prior until so many episodes have ended in the goal region, then
    /// anywhere in the prior, §IV-A.3.
    Ends {
        /// Episodes.
        successes: u32,
    },
    /// No farther than a reach from the end of the prior nearest to the goal. The reach is 0 at first
    /// and grows by a twentieth of the prior each time this share of the latest 100 episodes ended in
    /// the goal region.
    ///
    /// Where all there is to learn lies at the limits, a policy that knows nothing finds a limit
    /// from there, learns what to do with it, and has one step farther to walk each time. It is
    /// always the same end, since a policy that must look for two learns to turn round.
    Widening {
        /// From 0 to 1.
        success_rate: f32,
    },
}

/// Episodes over which the success rate of a reach is taken.
const WINDOW: u32 = 100;
/// Growths of the reach until it covers the prior.
const GROWTHS: u32 = 20;

/// How far a curriculum has come.
#[derive(Debug, Clone)]
pub(super) struct Starts {
    curriculum: Curriculum,
    growths: u32,
    episodes: u32,
    successes: u32,
}

impl Starts {
    pub fn new(curriculum: Curriculum) -> Self {
        Self {
            curriculum,
            growths: 0,
            episodes: 0,
            successes: 0,
        }
    }

    /// A start for an episode with this goal.
    pub fn draw(&self, joint: &Joint, goal: f64, rng: &mut impl Rng) -> f64 {
        let (from, to) = joint.start;
        match self.curriculum {
            Curriculum::Ends { successes } if self.successes < successes => {
                if rng.random() {
                    to
                } else {
                    from
                }
            }
            Curriculum::Widening { .. } if self.growths < GROWTHS => {
                let reach = f64::from(self.growths) / f64::from(GROWTHS) * (to - from);
                let near_lower = (goal - from).abs() < (to - goal).abs();
                let start = if near_lower {
                    (from, from + reach)
                } else {
                    (to - reach, to)
                };
                let near = Joint {
                    start,
                    ..joint.clone()
                };
                draw_start(&near, rng)
            }
            _ => draw_start(joint, rng),
        }
    }

    /// An episode has ended.
    pub fn record(&mut self, success: bool) {
        self.successes += u32::from(success);
        let Curriculum::Widening { success_rate } = self.curriculum else {
            return;
        };
        self.episodes += 1;
        if self.episodes == WINDOW {
            let enough = self.successes as f32 >= success_rate * WINDOW as f32;
            self.growths += u32::from(enough);
            (self.episodes, self.successes) = (0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use pubs_core::JointKind;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;

    fn joint() -> Joint {
        Joint {
            kind: JointKind::Abstract { integer: true },
            lower: 0.0,
            upper: 140.0,
            start: (20.0, 120.0),
        }
    }

    /// The smallest and the largest of many starts.
    fn extent(starts: &Starts, goal: f64) -> (f64, f64) {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let drawn = (0..5000).map(|_| starts.draw(&joint(), goal, &mut rng));
        drawn.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
            (least.min(x), most.max(x))
        })
    }

    #[test]
    fn starts_widen_from_the_end_nearest_to_the_goal_as_success_grows() {
        let widening = || Starts::new(Curriculum::Widening { success_rate: 0.9 });
        let mut starts = widening();
        assert_eq!(extent(&starts, 80.0), (120.0, 120.0), "nearest: 120");
        assert_eq!(extent(&starts, 60.0), (20.0, 20.0), "nearest: 20");

        let episodes = |starts: &mut Starts, successes| {
            (0..100).for_each(|index| starts.record(index < successes));
        };
        episodes(&mut starts, 89);
        assert_eq!(extent(&starts, 80.0), (120.0, 120.0), "89 of 100");
        episodes(&mut starts, 90);
        assert_eq!(extent(&starts, 80.0), (115.0, 120.0), "90 of 100");
        assert_eq!(extent(&starts, 60.0), (20.0, 25.0), "90 of 100");
        for _ in 1..20 {
            episodes(&mut starts, 100);
        }
        assert_eq!(extent(&starts, 80.0), (20.0, 120.0), "grown 20 times");
        episodes(&mut starts, 0);
        assert_eq!(extent(&starts, 80.0), (20.0, 120.0), "never narrower");
    }

    #[test]
    fn starts_leave_the_ends_after_enough_successes() {
        let mut starts = Starts::new(Curriculum::Ends { successes: 2 });
        let only_ends = |starts: &Starts| {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
            let mut drawn = (0..1000).map(|_| starts.draw(&joint(), 80.0, &mut rng));
            drawn.all(|start| start == 20.0 || start == 120.0)
        };
        assert_eq!(extent(&starts, 80.0), (20.0, 120.0), "both ends");
        starts.record(true);
        starts.record(false);
        assert!(only_ends(&starts), "one success is one too few");
        starts.record(true);
        assert!(!only_ends(&starts), "two successes are enough");
    }
}
