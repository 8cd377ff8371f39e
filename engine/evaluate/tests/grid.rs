//! An object on a grid, against the object itself.
#![allow(clippy::unwrap_used, missing_docs)]

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use pubs_core::Task;
use pubs_core::belief::{Model, ModelError};
use pubs_core::object::{Overrides, load};
use pubs_core::task::compile;
use pubs_evaluate::grid::{Grid, GridError, GridOptions};
use pubs_evaluate::{AlphaContestant, EvaluationOptions, GoalChoice, evaluate};
use pubs_host::Registry;
use pubs_plugin::{Channel, ChannelKind, Support, Transitions};
use pubs_solve::{Method, SolveOptions, solve};

fn object(name: &str) -> (Arc<Task>, Arc<dyn Model>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../objects/{name}.toml"));
    let file = load(&path, &Overrides::none()).unwrap().file;
    let task = Arc::new(compile(&file).unwrap());
    let model: Arc<dyn Model> = match name {
        "sim_object" => Formula::new(|state| match state {
            1.0 | 100.0 => (10.0, 0.1),
            _ => (0.0, 0.1),
        }),
        "light_dark" => Formula::new(|state| (state, (state - 10.0).abs() + 0.001)),
        _ => {
            let registry = Registry::new(&[pubs_segments::table()], Vec::new());
            let plugin = registry.observation_model(&task.observation.model).unwrap();
            Arc::new(plugin.create(&task.model_setup(0)).unwrap())
        }
    };
    (task, model)
}

/// One channel whose mean and sigma follow from the state; the benchmarks' own models are loaded
/// libraries, which only the program has.
struct Formula {
    channels: Vec<Channel>,
    moments: fn(f32) -> (f32, f32),
}

impl Formula {
    fn new(moments: fn(f32) -> (f32, f32)) -> Arc<Self> {
        let channels = vec![Channel {
            name: "reading".to_owned(),
            kind: ChannelKind::Gaussian,
        }];
        Arc::new(Self { channels, moments })
    }
}

impl Model for Formula {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        let outputs = mean.iter_mut().zip(sigma);
        for (state, (mean, sigma)) in transitions.after.iter().zip(outputs) {
            (*mean, *sigma) = (self.moments)(*state);
        }
        Ok(Support::Given)
    }
}

fn grid(name: &str, bins: Option<usize>) -> Grid {
    let (task, model) = object(name);
    let options = GridOptions::of(&task, model.as_ref(), bins, None).unwrap();
    let goal = task
        .default_goal
        .unwrap_or_else(|| task.joint.at_fraction(0.5));
    Grid::new(&task, model.as_ref(), goal, options).unwrap()
}

#[test]
fn sim_object_has_its_hundred_states_and_two_observations() {
    let grid = grid("sim_object", None);
    let pomdp = &grid.pomdp;
    assert_eq!((pomdp.states().len(), pomdp.observations().len()), (101, 2));
    // State 99 is the joint's 100th: the sensor is high there, and only there and at the first.
    let high = grid.observe(&[10.0]);
    let low = grid.observe(&[0.0]);
    assert_ne!(high, low);
    let open = 1;
    for (state, expected) in [(0, high), (1, low), (50, low), (98, low), (99, high)] {
        let (seen, probability) = pomdp.observation(open, state).next().unwrap();
        assert_eq!(seen, expected, "state {state}");
        assert!(
            (probability - 1.0).abs() < 1e-9,
            "state {state}: {probability}"
        );
    }
    // High force by 25 from the 75th state stays inside, from the 77th it would leave.
    let high_open = 3;
    assert_eq!(pomdp.transition(high_open, 74).next(), Some((99, 1.0)));
    assert_eq!(pomdp.transition(high_open, 76).next(), Some((100, 1.0)));
    assert!((pomdp.reward(high_open, 76) + 1.001).abs() < 1e-12);
    assert!(
        (pomdp.reward(0, 49) - 0.999).abs() < 1e-12,
        "stop at the goal"
    );
    assert!((pomdp.reward(0, 0) + 1.001).abs() < 1e-12, "stop elsewhere");
}

#[test]
fn light_dark_reads_whole_numbers_and_starts_in_its_middle() {
    let grid = grid("light_dark", None);
    assert_eq!(grid.pomdp.states().len(), 122);
    assert_eq!(grid.options.observation_bins, 121);
    let start = grid.pomdp.start();
    let first = start.iter().position(|&p| p > 0.0).unwrap();
    let count = start.iter().filter(|&&p| p > 0.0).count();
    assert_eq!((first, count), (30, 61), "-30 to 30");
    // At the light, 10, sigma is 0.001: the reading is 10.
    let seen = grid.observe(&[10.0]);
    let (observation, probability) = grid.pomdp.observation(1, 70).next().unwrap();
    assert_eq!(observation, seen);
    assert!(probability > 0.999, "{probability}");
}

#[test]
fn a_door_on_a_grid_is_held_by_its_latch() {
    let grid = grid("door2", Some(126));
    let pomdp = &grid.pomdp;
    let chance = |action: usize, from: usize, to: usize| {
        let found = pomdp.transition(action, from).find(|&(next, _)| next == to);
        found.map_or(0.0, |(_, probability)| probability)
    };
    // The latch holds safe mode between 1.5 and 3.75 degrees; a state is a degree.
    let (safe_open, high_open) = (1, 3);
    let [held, free] = [safe_open, high_open].map(|action| chance(action, 2, 2));
    assert!(held > 0.9, "safe mode stays at the latch: {held}");
    assert!(free < 0.1, "high force leaves it: {free}");
    for action in 0..pomdp.actions().len() {
        for state in 0..pomdp.states().len() {
            let sum: f64 = pomdp.transition(action, state).map(|entry| entry.1).sum();
            assert!(
                (sum - 1.0).abs() < 1e-9,
                "action {action} state {state}: {sum}"
            );
        }
    }
}

#[test]
fn faulty_grids_say_why() {
    let (task, model) = object("sim_object");
    let fault = GridOptions::of(&task, model.as_ref(), Some(50), None).unwrap_err();
    assert!(matches!(fault, GridError::WholeStates { .. }), "{fault}");
    let (task, model) = object("door2");
    let fault = GridOptions::of(&task, model.as_ref(), Some(1), None).unwrap_err();
    assert!(matches!(fault, GridError::Bins(1)), "{fault}");
    let fault = GridOptions::of(&task, model.as_ref(), None, Some(0)).unwrap_err();
    assert!(matches!(fault, GridError::NoObservation), "{fault}");
    let options = GridOptions {
        bins: 20,
        observation_bins: 100,
    };
    let fault = Grid::new(&task, model.as_ref(), 0.5, options).unwrap_err();
    assert!(matches!(fault, GridError::Observations { .. }), "{fault}");
}

/// The exact model of Sim Object: what the trials of the object earn is what the solver promises.
#[test]
fn sarsop_earns_on_sim_object_what_it_promises() {
    let (task, model) = object("sim_object");
    let grid = grid("sim_object", None);
    let options = SolveOptions {
        method: Method::Sarsop,
        precision: 0.02,
        timeout: Some(Duration::from_secs(20)),
        ..SolveOptions::default()
    };
    let solution = solve(&grid.pomdp, &options, |_| {
        std::ops::ControlFlow::Continue(())
    });
    let contestant = AlphaContestant {
        policy: &solution.policy,
        grid: &grid,
    };
    let options = EvaluationOptions {
        trials: 4000,
        goal: GoalChoice::One(50.0),
        max_steps: 250,
        shield: None,
        seed: 5,
        threads: Some(1),
    };
    let found = evaluate(&task, &model, &contestant, &options)
        .unwrap()
        .figures;
    let (mean, error) = (
        found.mean_discounted_reward,
        found.mean_discounted_reward_se,
    );
    assert!(
        mean >= solution.lower - 4.0 * error && mean <= solution.upper + 4.0 * error,
        "{mean} ± {error} outside {} to {}",
        solution.lower,
        solution.upper
    );
    // Another solver reached 0.5832 with these sizes.
    assert!(mean > 0.57, "{mean} ± {error}");
    assert_eq!(found.success_rate, 1.0);
    assert_eq!(found.coverage_90, None);
}
