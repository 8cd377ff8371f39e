//! Tables I to III as numbers.

use super::cell::{
    CellResult, EntropyInput, Figures, GoalName, Judged, Method, SolverMethod, Unit,
};
use super::matrix::{Column, Entry, Format, Matrix, Ours, Row};
use super::paper::{self, Estimate};
use super::results::Results;
use super::seeds::{Seeds, Training, is_light_dark, reward};

/// What PuBS under the shield is called.
pub const SHIELDED: &str = "PuBS with shield";

/// The solvers of Table II, in the order of its rows.
pub const SOLVERS: [SolverMethod; 2] = [SolverMethod::Sarsop, SolverMethod::Qmdp];

/// Table I at one goal.
pub fn table_i(results: &Results, goal: GoalName) -> Matrix {
    let of = |object, method| Training::new(object, goal, method).seeds(results);
    let mut rows: Vec<_> = paper::METHODS
        .into_iter()
        .map(|method| {
            let entry = |object| {
                let ours = plain_reward(object, of(object, method).as_ref());
                Entry::new(ours, paper::table_i(goal, method, object))
            };
            row(method.to_string(), paper::OBJECTS.map(entry))
        })
        .collect();
    let shielded = paper::OBJECTS.map(|object| {
        let seeds = under_shield(object, goal).seeds(results);
        Entry::new(shielded_reward(object, seeds.as_ref()), None)
    });
    rows.insert(1, beside(shielded));
    Matrix::new(paper::OBJECTS.map(reward_column).into(), rows)
}

/// Table II, or the same of other abstract objects: reward and success of each task.
pub fn table_ii(results: &Results, tasks: &[&str]) -> Matrix {
    let seeds = |task| Training::new(task, GoalName::Own, Method::Pubs).seeds(results);
    let pubs = tasks.iter().flat_map(|&task| {
        let seeds = seeds(task);
        let paper = paper::table_ii(task, None);
        let ours = [
            plain_reward(task, seeds.as_ref()),
            Ours::of_seeds(seeds.as_ref(), |judged| Some(success(&judged.plain))),
        ];
        reward_and_success(ours, paper)
    });
    let shielded = tasks.iter().flat_map(|&task| {
        let seeds = under_shield(task, GoalName::Own).seeds(results);
        let ours = [
            shielded_reward(task, seeds.as_ref()),
            Ours::of_seeds(seeds.as_ref(), |judged| {
                judged.shielded.as_ref().map(success)
            }),
        ];
        reward_and_success(ours, None)
    });
    let mut rows = vec![row("PuBS".to_owned(), pubs), beside(shielded)];
    for method in SOLVERS {
        let entries = tasks.iter().flat_map(|&task| {
            let ours = match solver(results, task, method, None) {
                None => [Ours::NotRun, Ours::NotRun],
                Some(found) => [reward(task, found.evaluation), success(found.evaluation)]
                    .map(|value| Ours::Found { value, seeds: None }),
            };
            reward_and_success(ours, paper::table_ii(task, Some(method)))
        });
        rows.push(row(method.to_string(), entries));
    }
    let columns = tasks.iter().flat_map(|&task| {
        let success = Column {
            title: format!("{}: success", name(task)),
            format: Format::Percent,
        };
        [reward_column(task), success]
    });
    Matrix::new(columns.collect(), rows)
}

/// Table III; rows and columns are swapped against the paper's.
pub fn table_iii(results: &Results) -> Matrix {
    let rows = paper::ENTROPIES.map(|entropy| {
        let entry = |task| {
            let goal = middle_or_own(task);
            let seeds = Training {
                entropy,
                ..Training::new(task, goal, Method::Pubs)
            }
            .seeds(results);
            let ours = plain_reward(task, seeds.as_ref());
            Entry::new(ours, paper::table_iii(task, entropy))
        };
        let label = match entropy {
            EntropyInput::Belief => "PuBS",
            EntropyInput::Random => "Random H",
            EntropyInput::None => "No H",
        };
        row(label.to_owned(), paper::ABLATED.map(entry))
    });
    Matrix::new(paper::ABLATED.map(reward_column).into(), rows.into())
}

/// What a solver reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved<'r> {
    /// Lower bound of the value of the first belief, discounted.
    pub lower: f64,
    /// Upper bound of it.
    pub upper: f64,
    /// Vectors of the policy.
    pub alpha_vectors: u64,
    /// Time of the solver alone, s.
    pub solve_s: f64,
    /// Trials of the policy.
    pub evaluation: &'r Figures,
}

/// The cell of a solver; `None` where it has not been run.
pub fn solver<'r>(
    results: &'r Results,
    task: &str,
    method: SolverMethod,
    belief_frequency: Option<u32>,
) -> Option<Solved<'r>> {
    let unit = Unit::Solver {
        task: task.to_owned(),
        method,
        // Not part of the id.
        timeout_s: 0.0,
        belief_frequency,
    };
    match &results.cell(&unit)?.result {
        CellResult::Solver {
            lower,
            upper,
            alpha_vectors,
            solve_s,
            evaluation,
            ..
        } => Some(Solved {
            lower: *lower,
            upper: *upper,
            alpha_vectors: *alpha_vectors,
            solve_s: *solve_s,
            evaluation,
        }),
        CellResult::Training { .. } | CellResult::Arm { .. } => None,
    }
}

/// Variants of Light-Dark of which something has been run.
pub fn light_dark_variants(results: &Results) -> Vec<&str> {
    let mut variants: Vec<_> = results
        .cells()
        .map(|(_, cell)| cell.unit.task())
        .filter(|&task| is_light_dark(task) && task != "light_dark")
        .collect();
    variants.sort_unstable();
    variants.dedup();
    variants
}

/// PuBS trained and judged under the shield; where no action is high-force there is none.
pub(super) fn under_shield(task: &str, goal: GoalName) -> Training<'_> {
    Training {
        shielded: !is_light_dark(task),
        ..Training::new(task, goal, Method::Pubs)
    }
}

/// A task's name as the paper writes it.
pub fn name(task: &str) -> String {
    match task {
        "sim_object" => "Sim Object".to_owned(),
        "light_dark" => "Light-Dark".to_owned(),
        _ if is_light_dark(task) => {
            let variant = task.trim_start_matches("light_dark").trim_matches('_');
            format!("Light-Dark, {}", variant.replace('_', " "))
        }
        _ => {
            let digits = task.trim_start_matches(|letter: char| !letter.is_ascii_digit());
            let word = &task[..task.len() - digits.len()];
            let (first, rest) = word.split_at(word.chars().next().map_or(0, char::len_utf8));
            let name = format!("{}{rest} {digits}", first.to_uppercase());
            name.trim_end().to_owned()
        }
    }
}

/// Success as an estimate, by the binomial's standard error.
pub(super) fn success(figures: &Figures) -> Estimate {
    let mean = figures.success_rate;
    Estimate {
        mean,
        se: (mean * (1.0 - mean) / figures.trials as f64).sqrt(),
    }
}

fn middle_or_own(task: &str) -> GoalName {
    if paper::OBJECTS.contains(&task) {
        GoalName::Middle
    } else {
        GoalName::Own
    }
}

fn plain_reward(task: &str, seeds: Option<&Seeds<'_>>) -> Ours {
    Ours::of_seeds(seeds, |judged: &Judged| Some(reward(task, &judged.plain)))
}

fn shielded_reward(task: &str, seeds: Option<&Seeds<'_>>) -> Ours {
    Ours::of_seeds(seeds, |judged: &Judged| {
        judged
            .shielded
            .as_ref()
            .map(|figures| reward(task, figures))
    })
}

fn reward_and_success([reward, success]: [Ours; 2], paper: Option<(Estimate, f64)>) -> [Entry; 2] {
    // The paper's success rates are of 10,000 trials.
    let share = paper.map(|(_, mean)| Estimate {
        mean,
        se: (mean * (1.0 - mean) / 1e4).sqrt(),
    });
    [
        Entry::new(reward, paper.map(|(reward, _)| reward)),
        Entry::new(success, share),
    ]
}

fn reward_column(task: &str) -> Column {
    Column {
        title: name(task),
        format: if is_light_dark(task) {
            Format::Decimals(1, 2)
        } else {
            Format::Decimals(3, 3)
        },
    }
}

fn row(label: String, entries: impl IntoIterator<Item = Entry>) -> Row {
    Row {
        label,
        compared: true,
        entries: entries.into_iter().collect(),
    }
}

/// PuBS under the shield stands beside the paper's methods.
fn beside(entries: impl IntoIterator<Item = Entry>) -> Row {
    Row {
        compared: false,
        ..row(SHIELDED.to_owned(), entries)
    }
}
