//! The seeds of one training, and the best of them, §IV-A.3.

use super::cell::{CellResult, EntropyInput, Figures, GoalName, Judged, Method, Unit};
use super::paper::Estimate;
use super::results::Results;
use super::unit::explored_under_shield;

/// All seeds of a training.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Training<'a> {
    /// Name of the object.
    pub task: &'a str,
    /// Its goal.
    pub goal: GoalName,
    /// How it is trained.
    pub method: Method,
    /// What stands for the entropy; without meaning for a method that has no belief.
    pub entropy: EntropyInput,
    /// Filter updates per policy step; `None`: as the object file says.
    pub belief_frequency: Option<u32>,
    /// Whether the shield is there in training already.
    pub shielded: bool,
}

/// What was found of them: one at least.
#[derive(Debug, Clone, PartialEq)]
pub struct Seeds<'r> {
    /// The best: the greatest mean reward on the trials of the selection.
    pub best: Seed<'r>,
    /// All, in order of their ids.
    pub all: Vec<Seed<'r>>,
}

/// One seed of a training.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed<'r> {
    /// Its number.
    pub seed: u64,
    /// On the trials by which the best is chosen.
    pub selection: &'r Judged,
    /// On the trials that are reported.
    pub fresh: &'r Judged,
}

/// Which mean reward the paper reports of a task: undiscounted for Light-Dark, discounted for the
/// others.
pub fn reward(task: &str, figures: &Figures) -> Estimate {
    let [mean, se] = if is_light_dark(task) {
        [figures.mean_reward, figures.mean_reward_se]
    } else {
        [
            figures.mean_discounted_reward,
            figures.mean_discounted_reward_se,
        ]
    };
    Estimate { mean, se }
}

/// Light-Dark, or a variant of it.
pub fn is_light_dark(task: &str) -> bool {
    task.starts_with("light_dark")
}

impl<'a> Training<'a> {
    /// With the belief's entropy where there is a belief, and the object file's frequency.
    pub fn new(task: &'a str, goal: GoalName, method: Method) -> Self {
        let entropy = if method.has_belief() {
            EntropyInput::Belief
        } else {
            EntropyInput::None
        };
        Self {
            task,
            goal,
            method,
            entropy,
            belief_frequency: None,
            shielded: explored_under_shield(task),
        }
    }

    /// The unit of one seed.
    pub fn unit(&self, seed: u64) -> Unit {
        Unit::Training {
            task: self.task.to_owned(),
            goal: self.goal,
            method: self.method,
            entropy: self.entropy,
            belief_frequency: self.belief_frequency,
            shielded: self.shielded,
            seed,
        }
    }

    /// Its seeds; `None` where none has been run.
    pub fn seeds<'r>(&self, results: &'r Results) -> Option<Seeds<'r>> {
        let all: Vec<_> = results
            .cells()
            .filter_map(|(_, cell)| match (&cell.unit, &cell.result) {
                (
                    Unit::Training { seed, .. },
                    CellResult::Training {
                        selection, fresh, ..
                    },
                ) if self.is_that_of(&cell.unit) => Some(Seed {
                    seed: *seed,
                    selection,
                    fresh,
                }),
                _ => None,
            })
            .collect();
        // By what the tables show of it: a task that is explored under the shield is shown without.
        let with_shield = self.shielded && !explored_under_shield(self.task);
        let chosen_by = |seed: &Seed| {
            let Judged { plain, shielded } = seed.selection;
            let own = shielded.as_ref().filter(|_| with_shield);
            reward(self.task, own.unwrap_or(plain)).mean
        };
        let best = all
            .iter()
            .copied()
            .max_by(|a, b| chosen_by(a).total_cmp(&chosen_by(b)))?;
        Some(Seeds { best, all })
    }

    fn is_that_of(&self, unit: &Unit) -> bool {
        let Unit::Training {
            task,
            goal,
            method,
            entropy,
            belief_frequency,
            shielded,
            seed: _,
        } = unit
        else {
            return false;
        };
        let entropy = !self.method.has_belief() || *entropy == self.entropy;
        let shielded = *shielded == self.shielded;
        let what = (task.as_str(), *goal, *method, *belief_frequency);
        entropy && shielded && what == (self.task, self.goal, self.method, self.belief_frequency)
    }
}
