//! Speed of training on a task that costs next to nothing. Run with `cargo bench -p pubs-train`;
//! prints the median of several runs for each recipe and vector unit.

use std::convert::Infallible;
use std::ops::ControlFlow;

use pubs_train::{End, Environments, InputScaling, Recipe, Settings, StepOutcome, VectorUnit, train};

/// Walks on [0, 1] from a place that a counter picks; action 0 stops, the others move by
/// −0.05, −0.2, 0.05 and 0.2. The third feature is there for the width of the real task.
struct Walk {
    places: Vec<f32>,
    episodes: u32,
}

impl Walk {
    const MOVES: [f32; 5] = [0.0, -0.05, -0.2, 0.05, 0.2];

    fn new(count: usize) -> Self {
        Self { places: (0..count).map(|i| i as f32 / count as f32).collect(), episodes: 0 }
    }
}

impl Environments for Walk {
    type Error = Infallible;

    fn count(&self) -> usize {
        self.places.len()
    }

    fn features(&self) -> usize {
        3
    }

    fn actions(&self) -> usize {
        Self::MOVES.len()
    }

    fn observe(&self, features: &mut [f32], allowed: &mut [bool]) {
        allowed.fill(true);
        for (row, place) in features.chunks_exact_mut(3).zip(&self.places) {
            row.copy_from_slice(&[*place, place * place, place - 0.5]);
        }
    }

    fn step(&mut self, actions: &[usize], outcomes: &mut [StepOutcome]) -> Result<(), Infallible> {
        for ((place, action), outcome) in self.places.iter_mut().zip(actions).zip(outcomes) {
            *outcome = StepOutcome { reward: -0.001, ..StepOutcome::default() };
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
    let runs = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(3);
    let with = |minibatch, recipe: Recipe| Recipe { minibatch, ..recipe };
    let cases = [
        ("standard, 64", with(64, Recipe::standard())),
        ("standard, 256", with(256, Recipe::standard())),
        ("paper", Recipe::paper()),
    ];
    let wanted = |unit: &VectorUnit| std::env::args().all(|a| a != "best") || *unit == VectorUnit::best();
    for unit in VectorUnit::available().into_iter().filter(wanted) {
        for (name, recipe) in &cases {
            let mut times: Vec<(f64, f64, f64)> = (0..runs).map(|_| time(recipe, unit)).collect();
            times.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (total_s, learning_s, rollout_s) = times[times.len() / 2];
            let steps_per_s = recipe.steps as f64 / total_s;
            println!(
                "{unit:8} {name:14} {total_s:6.2} s = {learning_s:5.2} learning + {rollout_s:4.2} \
                 rollouts, {steps_per_s:7.0} steps/s"
            );
        }
    }
}

/// Whole training, learning alone and rollouts alone, s.
fn time(recipe: &Recipe, unit: VectorUnit) -> (f64, f64, f64) {
    let settings = Settings {
        recipe: recipe.clone(),
        layers: vec![64, 64, 64],
        scaling: InputScaling::identity(3),
        discount: 0.99,
        seed: 1,
        unit,
    };
    let mut walk = Walk::new(recipe.environments);
    let trained = match train(&mut walk, &settings, |_| ControlFlow::Continue(())) {
        Ok(trained) => trained,
        Err(error) => panic!("training failed: {error}"),
    };
    eprintln!("{:?}", trained.progress);
    (trained.progress.time_s, trained.learning_s, trained.rollout_s)
}
