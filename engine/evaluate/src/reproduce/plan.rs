//! Which units of work make up the paper's evaluation.

use std::collections::BTreeSet;
use std::str::FromStr;

use super::heatmap::PICTURES;
use super::paper::{FREQUENCIES, GOALS, OBJECTS};
use super::seeds::Training;
use super::unit::{EntropyInput, GoalName, Method, SolverMethod, Unit};

/// The benchmarks.
const BENCHMARKS: [&str; 2] = ["sim_object", "light_dark"];

/// A table or a figure of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Discounted rewards of method and baselines; Fig. 4 (top) comes with it.
    Table1,
    /// Light-Dark against the frequency of the belief, Fig. 4 (bottom).
    Figure4,
    /// Offline solvers.
    Table2,
    /// Ablations of the entropy.
    Table3,
    /// Behaviour over mean and entropy.
    Figure5,
    /// Trials on the (virtual) arm.
    Table4,
}

/// How much to run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// Parts; all where empty.
    pub parts: BTreeSet<Part>,
    /// Trainings of each kind; the paper's five.
    pub seeds: u64,
    /// Trainings of each kind with an LSTM, which take ten times as long and more.
    pub recurrent_seeds: u64,
    /// Time limit of a solver, s.
    pub timeout_s: f64,
    /// Trials on the arm.
    pub arm_trials: u64,
}

/// All units of the asked-for parts, each once, those that others need before them and the long
/// ones last.
pub fn plan(options: &PlanOptions) -> Vec<Unit> {
    let asked = |part: Part| options.parts.is_empty() || options.parts.contains(&part);
    let mut units = Vec::new();
    if asked(Part::Table1) {
        units.extend(table_1(options, Method::Pubs, false));
        units.extend(table_1(options, Method::Pubs, true));
        units.extend(table_1(options, Method::Ppo, false));
    }
    if asked(Part::Table2) {
        units.extend(table_2(options));
    }
    if asked(Part::Figure4) {
        units.extend(figure_4(options));
    }
    if asked(Part::Table3) {
        units.extend(table_3(options));
    }
    if asked(Part::Figure5) {
        units.extend(figure_5(options));
    }
    if asked(Part::Table4) {
        units.extend(table_4(options));
    }
    if asked(Part::Table1) {
        units.extend(table_1(options, Method::Lstm1, false));
        units.extend(table_1(options, Method::Lstm2, false));
    }
    let mut seen = BTreeSet::new();
    units.retain(|unit| seen.insert(unit.id()));
    units
}

fn table_1(options: &PlanOptions, method: Method, shielded: bool) -> Vec<Unit> {
    let seeds = match method.lstm_layers() {
        0 => options.seeds,
        _ => options.recurrent_seeds,
    };
    let of_seed = |seed| {
        let of_goal = move |goal| {
            OBJECTS.map(|task| {
                let training = Training {
                    shielded,
                    ..Training::new(task, goal, method)
                };
                training.unit(seed)
            })
        };
        GOALS.into_iter().flat_map(of_goal)
    };
    (1..=seeds).flat_map(of_seed).collect()
}

fn table_2(options: &PlanOptions) -> Vec<Unit> {
    let solvers = BENCHMARKS.into_iter().flat_map(|task| {
        [SolverMethod::Sarsop, SolverMethod::Qmdp].map(|method| Unit::Solver {
            task: task.to_owned(),
            method,
            timeout_s: options.timeout_s,
            belief_frequency: None,
        })
    });
    solvers.chain(benchmarks(options)).collect()
}

fn benchmarks(options: &PlanOptions) -> impl Iterator<Item = Unit> {
    let of_seed =
        |seed| BENCHMARKS.map(|task| Training::new(task, GoalName::Own, Method::Pubs).unit(seed));
    (1..=options.seeds).flat_map(of_seed)
}

fn figure_4(options: &PlanOptions) -> Vec<Unit> {
    // The object file itself stands for the fastest.
    let [slower @ .., _] = FREQUENCIES;
    let at = |frequency| Training {
        belief_frequency: Some(frequency),
        ..Training::new("light_dark", GoalName::Own, Method::Pubs)
    };
    let of_seed = |seed| slower.map(|frequency| at(frequency).unit(seed));
    let own = |unit: &Unit| unit.task() == "light_dark";
    let frequencies = (1..=options.seeds).flat_map(of_seed);
    frequencies
        .chain(table_2(options).into_iter().filter(own))
        .collect()
}

fn table_3(options: &PlanOptions) -> Vec<Unit> {
    let mut units = Vec::new();
    for seed in 1..=options.seeds {
        for entropy in EntropyInput::ALL {
            let objects = OBJECTS.map(|task| (task, GoalName::Middle));
            let benchmarks = BENCHMARKS.map(|task| (task, GoalName::Own));
            let tasks = objects.into_iter().chain(benchmarks);
            units.extend(tasks.map(|(task, goal)| {
                let training = Training {
                    entropy,
                    ..Training::new(task, goal, Method::Pubs)
                };
                training.unit(seed)
            }));
        }
    }
    units
}

fn figure_5(options: &PlanOptions) -> Vec<Unit> {
    let of_seed =
        |seed| PICTURES.map(|(task, goal, _)| Training::new(task, goal, Method::Pubs).unit(seed));
    (1..=options.seeds).flat_map(of_seed).collect()
}

/// The policies of the middle goal under the shield, as `run` has it, and the trials that take the
/// best of them.
fn table_4(options: &PlanOptions) -> Vec<Unit> {
    let of_seed = |seed| {
        OBJECTS.map(|task| {
            let training = Training {
                shielded: true,
                ..Training::new(task, GoalName::Middle, Method::Pubs)
            };
            training.unit(seed)
        })
    };
    let arm = |drift| {
        OBJECTS.map(|task| Unit::Arm {
            task: task.to_owned(),
            trials: options.arm_trials,
            drift,
        })
    };
    let policies = (1..=options.seeds).flat_map(of_seed);
    policies.chain(arm(false)).chain(arm(true)).collect()
}

impl Part {
    /// All parts with the words that name them.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Table1, "table1"),
        (Self::Figure4, "fig4"),
        (Self::Table2, "table2"),
        (Self::Table3, "table3"),
        (Self::Figure5, "fig5"),
        (Self::Table4, "table4"),
    ];
}

/// A word that names no part.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no part {found:?}; there are {}", Part::ALL.map(|(_, name)| name).join(", "))]
pub struct UnknownPart {
    found: String,
}

impl FromStr for Part {
    type Err = UnknownPart;

    fn from_str(text: &str) -> Result<Self, UnknownPart> {
        let found = Self::ALL.into_iter().find(|(_, name)| *name == text);
        found.map(|(part, _)| part).ok_or_else(|| UnknownPart {
            found: text.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(parts: &[Part]) -> usize {
        let options = PlanOptions {
            parts: parts.iter().copied().collect(),
            seeds: 5,
            recurrent_seeds: 1,
            timeout_s: 60.0,
            arm_trials: 20,
        };
        let units = plan(&options);
        let ids: BTreeSet<String> = units.iter().map(Unit::id).collect();
        assert_eq!(ids.len(), units.len(), "each unit once");
        units.len()
    }

    #[test]
    fn parts_have_as_many_units_as_the_paper_has_cells() {
        let cases = [
            // 12 cells of PuBS without and with shield and of PPO with five seeds, of two with one.
            (&[Part::Table1][..], 12 * (5 + 5 + 5 + 1 + 1)),
            // Two solvers and one method on two benchmarks.
            (&[Part::Table2], 2 * 2 + 2 * 5),
            // Three further frequencies, and Light-Dark of Table II.
            (&[Part::Figure4], 3 * 5 + 2 + 5),
            // Six tasks, three inputs.
            (&[Part::Table3], 6 * 3 * 5),
            (&[Part::Figure5], 3 * 5),
            // Four policies, trials with and without drift.
            (&[Part::Table4], 4 * 5 + 8),
            // Shared units count once.
            (&[], 12 * 17 + (2 * 2 + 2 * 5) + 3 * 5 + 6 * 2 * 5 + 8),
        ];
        for (parts, expected) in cases {
            assert_eq!(count(parts), expected, "{parts:?}");
        }
    }
}
