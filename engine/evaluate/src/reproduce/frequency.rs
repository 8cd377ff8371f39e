//! Light-Dark against the frequency of the belief, Fig. 4 bottom.

use super::cell::{Figures, GoalName, Method};
use super::paper::{Estimate, FREQUENCIES};
use super::results::Results;
use super::seeds::{Seeds, Training, reward};
use super::tables::{SOLVERS, solver, success};

const TASK: &str = "light_dark";

/// The frequency that the object file gives.
const IN_FILE: u32 = 10;

/// One line of the figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The method.
    pub label: String,
    /// One per frequency of [`FREQUENCIES`]; `None` where it has not been run.
    pub points: [Option<Point>; FREQUENCIES.len()],
}

/// What is reached at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Undiscounted.
    pub reward: Estimate,
    /// Share of trials.
    pub success: Estimate,
    /// How many seeds the best was chosen from; `None` where nothing is trained.
    pub seeds: Option<usize>,
}

/// PuBS, SARSOP and QMDP. A solver that was not run at a frequency stands with what it reaches on
/// the object as it is: its policy does not wait for the filter.
pub fn lines(results: &Results) -> Vec<Line> {
    let pubs = Line {
        label: Method::Pubs.to_string(),
        points: FREQUENCIES.map(|frequency| {
            let seeds = at(results, Some(frequency)).or_else(|| {
                let in_file = (frequency == IN_FILE).then(|| at(results, None));
                in_file.flatten()
            })?;
            let seeds_run = Some(seeds.all.len());
            Some(point(&seeds.best.fresh.plain, seeds_run))
        }),
    };
    let solvers = SOLVERS.map(|method| Line {
        label: method.to_string(),
        points: FREQUENCIES.map(|frequency| {
            let found = solver(results, TASK, method, Some(frequency))
                .or_else(|| solver(results, TASK, method, None))?;
            Some(point(found.evaluation, None))
        }),
    });
    [pubs].into_iter().chain(solvers).collect()
}

fn at(results: &Results, belief_frequency: Option<u32>) -> Option<Seeds<'_>> {
    let training = Training {
        belief_frequency,
        ..Training::new(TASK, GoalName::Own, Method::Pubs)
    };
    training.seeds(results)
}

fn point(figures: &Figures, seeds: Option<usize>) -> Point {
    Point {
        reward: reward(TASK, figures),
        success: success(figures),
        seeds,
    }
}
