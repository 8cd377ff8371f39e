//! Safety violations per goal and method, Fig. 4 top.

use super::cell::{GoalName, Judged};
use super::paper;
use super::results::Results;
use super::seeds::Training;
use super::tables::{SHIELDED, under_shield};

/// The violations of one method at one goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Violations {
    /// The method.
    pub label: String,
    /// One per object; `None` where nothing has been run.
    pub objects: [Option<Count>; 4],
}

/// The violations on one object.
#[derive(Debug, Clone, PartialEq)]
pub struct Count {
    /// Of the best seed.
    pub best: u64,
    /// Of every seed.
    pub seeds: Vec<u64>,
    /// Trials of each.
    pub trials: u64,
}

impl Count {
    /// Mean over the seeds.
    pub fn mean(&self) -> f64 {
        self.seeds.iter().sum::<u64>() as f64 / self.seeds.len() as f64
    }
}

impl Violations {
    /// Summed over the objects that have been run, best seeds; `None` where none has.
    pub fn best(&self) -> Option<u64> {
        let counts = self.objects.iter().flatten();
        counts.map(|count| count.best).reduce(|a, b| a + b)
    }

    /// Summed likewise, means over all seeds.
    pub fn mean(&self) -> Option<f64> {
        let counts = self.objects.iter().flatten();
        counts.map(Count::mean).reduce(|a, b| a + b)
    }

    /// How many objects have been run.
    pub fn run(&self) -> usize {
        self.objects.iter().flatten().count()
    }
}

/// The rows of one goal: the paper's methods, and PuBS under the shield after PuBS.
pub fn violations(results: &Results, goal: GoalName) -> Vec<Violations> {
    let plain = |judged: &Judged| Some(judged.plain.safety_violations);
    let shielded = |judged: &Judged| Some(judged.shielded.as_ref()?.safety_violations);
    let mut rows: Vec<_> = paper::METHODS
        .into_iter()
        .map(|method| Violations {
            label: method.to_string(),
            objects: counts(results, |object| Training::new(object, goal, method), plain),
        })
        .collect();
    let beside = Violations {
        label: SHIELDED.to_owned(),
        objects: counts(results, |object| under_shield(object, goal), shielded),
    };
    rows.insert(1, beside);
    rows
}

fn counts(
    results: &Results,
    of: impl Fn(&'static str) -> Training<'static>,
    count: impl Fn(&Judged) -> Option<u64>,
) -> [Option<Count>; 4] {
    paper::OBJECTS.map(|object| {
        let seeds = of(object).seeds(results)?;
        Some(Count {
            best: count(seeds.best.fresh)?,
            seeds: seeds
                .all
                .iter()
                .filter_map(|seed| count(seed.fresh))
                .collect(),
            trials: seeds.best.fresh.plain.trials,
        })
    })
}
