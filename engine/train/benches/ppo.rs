//! Speed of the kernels on each vector unit, and of whole trainings on a task that costs next to
//! nothing (the median of three, or of as many as the argument says).
//!
//! `cargo bench -p pubs-train --bench ppo -- 5`

// Benchmarks see the public interface only; the kernels are not part of it.
#[allow(dead_code)]
#[path = "../src/kernels/mod.rs"]
mod kernels;

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::time::Instant;

use kernels::buffer::Buffer;
use kernels::matrix::{Left, Shape, Start, multiply};
use kernels::tanh::apply_tanh;
use pubs_train::{
    End, Environments, InputScaling, Lstm, Progress, Recipe, Settings, StepOutcome, VectorUnit,
    train, train_recurrent,
};

const FEATURES: usize = 3;
const LAYERS: [usize; 3] = [64, 64, 64];
/// Units of a recurrent layer.
const WIDTH: usize = 256;

/// Walks on [0, 1] from a place that a counter picks; action 0 stops, the others move by
/// −0.05, −0.2, 0.05 and 0.2. The third feature is there for the width of the real task.
struct Walk {
    places: Vec<f32>,
    episodes: u32,
}

impl Walk {
    const MOVES: [f32; 5] = [0.0, -0.05, -0.2, 0.05, 0.2];

    fn new(count: usize) -> Self {
        Self {
            places: (0..count).map(|i| i as f32 / count as f32).collect(),
            episodes: 0,
        }
    }
}

impl Environments for Walk {
    type Error = Infallible;

    fn count(&self) -> usize {
        self.places.len()
    }

    fn features(&self) -> usize {
        FEATURES
    }

    fn actions(&self) -> usize {
        Self::MOVES.len()
    }

    fn observe(&self, features: &mut [f32], allowed: &mut [bool]) {
        allowed.fill(true);
        for (row, place) in features.chunks_exact_mut(FEATURES).zip(&self.places) {
            row.copy_from_slice(&[*place, place * place, place - 0.5]);
        }
    }

    fn step(&mut self, actions: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), Infallible> {
        for ((place, action), outcome) in self.places.iter_mut().zip(actions).zip(outcomes) {
            *outcome = StepOutcome {
                reward: -0.001,
                ..StepOutcome::default()
            };
            *place = (*place + Self::MOVES[*action]).clamp(0.0, 1.0);
            if *action == 0 {
                outcome.success = (*place - 0.5).abs() < 0.1;
                outcome.reward = if outcome.success { 1.0 } else { -1.0 };
                outcome.end = Some(End::Terminated);
                self.episodes = self.episodes.wrapping_add(1);
                *place = self.episodes.wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32;
            }
        }
        Ok(())
    }

    fn last_features(&self, _index: usize, _features: &mut [f32]) {}
}

fn main() {
    let runs = std::env::args()
        .filter_map(|argument| argument.parse().ok())
        .next()
        .unwrap_or(3);
    for unit in VectorUnit::available() {
        time_kernels(unit);
    }
    for recipe in Recipe::all() {
        print_times(recipe.name, recipe.steps, runs, || time(&recipe));
    }
    for layers in [1, 2] {
        let recipe = Recipe {
            steps: 20_480,
            ..Recipe::baseline().recurrent()
        };
        let name = format!("lstm{layers}");
        let median = print_times(&name, recipe.steps, runs, || {
            time_recurrent(&recipe, layers)
        });
        let rate = flop_per_step(&recipe, layers) * recipe.steps as f64 / median.total_s;
        println!("{:5.1} GFLOP/s", rate / 1e9);
    }
}

/// Prints and returns the median of several runs.
fn print_times(name: &str, steps: usize, runs: usize, run: impl FnMut() -> Times) -> Times {
    let mut times: Vec<_> = std::iter::repeat_with(run).take(runs).collect();
    times.sort_by(|a, b| a.total_s.total_cmp(&b.total_s));
    let median = times[times.len() / 2];
    println!(
        "{} {name:8} {:6.2} s = {:5.2} learning + {:4.2} rollouts, {:7.0} steps/s",
        VectorUnit::best(),
        median.total_s,
        median.learning_s,
        median.rollout_s,
        steps as f64 / median.total_s
    );
    median
}

/// Prints the speed of the product of two 64 × 64 matrices and of tanh: of many repetitions the
/// fastest, which nothing else on the machine disturbed.
fn time_kernels(unit: VectorUnit) {
    const SIDE: usize = 64;
    const REPETITIONS: usize = 2000;
    let (a, b) = (filled(0.5), filled(0.25));
    let mut c = filled(0.0);
    let shape = Shape {
        rows: SIDE,
        depth: SIDE,
        columns: SIDE,
    };
    let left = Left::Rows {
        values: &a,
        stride: SIDE,
    };
    let product_s = fastest(REPETITIONS, || {
        multiply(unit, shape, left, &b, Start::Zero, &mut c)
    });
    let mut values = filled(1.0);
    let tanh_s = fastest(REPETITIONS, || apply_tanh(unit, &mut values));
    println!(
        "{unit:8} {:5.1} GFLOP/s, tanh {:.3} ns",
        2.0 * (SIDE * SIDE * SIDE) as f64 / product_s / 1e9,
        tanh_s * 1e9 / (SIDE * SIDE) as f64
    );

    fn filled(value: f32) -> Buffer {
        let mut buffer = Buffer::zeros(SIDE * SIDE);
        buffer.fill(value);
        buffer
    }
}

/// The shortest of several runs, s.
fn fastest(repetitions: usize, mut run: impl FnMut()) -> f64 {
    let times = (0..repetitions).map(|_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

#[derive(Clone, Copy)]
struct Times {
    total_s: f64,
    learning_s: f64,
    rollout_s: f64,
}

fn settings(recipe: &Recipe) -> Settings {
    Settings {
        recipe: recipe.clone(),
        layers: LAYERS.to_vec(),
        scaling: InputScaling::identity(FEATURES),
        discount: 0.99,
        seed: 1,
        unit: VectorUnit::best(),
    }
}

fn time(recipe: &Recipe) -> Times {
    let mut walk = Walk::new(recipe.environments);
    let result = train(&mut walk, &settings(recipe), |_| ControlFlow::Continue(()));
    let trained = result.unwrap_or_else(|error| panic!("training failed: {error}"));
    Times {
        total_s: trained.progress.time_s,
        learning_s: trained.learning_s,
        rollout_s: trained.rollout_s,
    }
}

fn time_recurrent(recipe: &Recipe, layers: usize) -> Times {
    let width = WIDTH;
    let mut walk = Walk::new(recipe.environments);
    let report = |_: &Progress| ControlFlow::Continue(());
    let result = train_recurrent(&mut walk, &settings(recipe), Lstm { layers, width }, report);
    let trained = result.unwrap_or_else(|error| panic!("training failed: {error}"));
    Times {
        total_s: trained.progress.time_s,
        learning_s: trained.learning_s,
        rollout_s: trained.rollout_s,
    }
}

/// Multiplications and additions of the matrix products, for one step of the environment: two
/// networks forward once in the rollout, and forward and twice as much backward in every epoch.
fn flop_per_step(recipe: &Recipe, layers: usize) -> f64 {
    let lstm = 4 * WIDTH * (FEATURES + WIDTH + (layers - 1) * 2 * WIDTH);
    let widths = [&[WIDTH], &LAYERS[..], &[Walk::MOVES.len()]].concat();
    let dense: usize = widths.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let passes = 1 + 3 * recipe.epochs;
    (2 * 2 * (lstm + dense) * passes) as f64
}
