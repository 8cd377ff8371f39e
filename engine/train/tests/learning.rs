//! PPO against a task whose optimum value iteration finds, and what training promises besides.
#![allow(clippy::unwrap_used)]

mod corridor;

use std::ops::ControlFlow;

use corridor::{Corridor, Fault, value_iteration, value_of};
use pubs_train::{
    DenseLayer, InputScaling, Progress, Recipe, Settings, TrainError, Trained, VectorUnit, train,
};

fn settings(recipe: Recipe, seed: u64) -> Settings {
    Settings {
        recipe,
        layers: vec![32, 32],
        scaling: InputScaling {
            offset: vec![4.0],
            scale: vec![0.25],
        },
        discount: corridor::DISCOUNT,
        seed,
        unit: VectorUnit::best(),
    }
}

fn short(steps: usize) -> Recipe {
    Recipe {
        steps,
        ..Recipe::baseline()
    }
}

fn trained(settings: &Settings) -> Trained {
    let mut corridor = Corridor::new(settings.recipe.environments, settings.seed);
    train(&mut corridor, settings, |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn reaches_the_optimum_of_a_corridor() {
    let best = value_iteration();
    let paper = Recipe {
        steps: 200_000,
        ..Recipe::paper()
    };
    for (name, recipe) in [("standard", short(60_000)), ("paper", paper)] {
        let Trained {
            mut policy,
            progress,
            ..
        } = trained(&settings(recipe, 1));
        let mut chosen = vec![0; corridor::STATES];
        policy.choose(
            &corridor::all_features(),
            &corridor::all_masks(),
            &mut chosen,
        );
        let reached = value_of(&chosen);
        assert!(
            reached >= 0.98 * best,
            "{name}: {chosen:?} is worth {reached}, the optimum is {best}; {progress:?}"
        );
    }
}

/// Every state is worth 1 / (1 − γ) where each step pays 1 and episodes are only ever truncated.
#[test]
fn truncated_episodes_keep_the_value_of_their_last_state() {
    let recipe = Recipe {
        minibatch: 64,
        ..short(60_000)
    };
    let mut settings = settings(recipe, 1);
    settings.discount = 0.5;
    let mut corridor = Corridor::new(settings.recipe.environments, 1);
    corridor.pays_every_step = true;
    let trained = train(&mut corridor, &settings, |_| ControlFlow::Continue(())).unwrap();
    for place in 0..corridor::STATES {
        let value = evaluate(&trained.value, (place as f32 - 4.0) * 0.25);
        assert!(
            (value - 2.0).abs() < 0.02,
            "the value at {place} is {value}, not 2"
        );
    }
}

fn evaluate(layers: &[DenseLayer], input: f32) -> f32 {
    let mut values = vec![input];
    for (l, layer) in layers.iter().enumerate() {
        let rows = layer.weights.chunks(layer.inputs).zip(&layer.bias);
        let sum = |row: &[f32]| row.iter().zip(&values).map(|(w, x)| w * x).sum::<f32>();
        values = rows.map(|(row, bias)| sum(row) + bias).collect();
        if l + 1 < layers.len() {
            values.iter_mut().for_each(|x| *x = x.tanh());
        }
    }
    values[0]
}

#[test]
fn exported_layers_are_the_policy() {
    let mut trained = trained(&settings(short(2048), 1));
    let mut logits = vec![0.0; corridor::STATES * corridor::ACTIONS];
    trained
        .policy
        .logits(&corridor::all_features(), &mut logits);
    let mut layers = trained.policy.layers();
    for (place, row) in logits.chunks(corridor::ACTIONS).enumerate() {
        for (action, logit) in row.iter().enumerate() {
            // One output at a time, by making its row the last layer's only one.
            let last = layers.last_mut().unwrap();
            last.weights
                .rotate_left(if action == 0 { 0 } else { last.inputs });
            last.bias.rotate_left(usize::from(action > 0));
            let expected = evaluate(&layers, (place as f32 - 4.0) * 0.25);
            assert!(
                (logit - expected).abs() < 1e-5,
                "{place} {action}: {logit} {expected}"
            );
        }
        let last = layers.last_mut().unwrap();
        last.weights.rotate_left(last.inputs);
        last.bias.rotate_left(1);
    }
}

#[test]
fn one_seed_gives_the_same_weights_and_another_does_not() {
    for unit in VectorUnit::available() {
        let with = |seed| {
            trained(&Settings {
                unit,
                ..settings(short(8192), seed)
            })
        };
        let (first, again, other) = (with(1), with(1), with(2));
        assert_eq!(
            first.policy.layers(),
            again.policy.layers(),
            "{unit}: policy"
        );
        assert_eq!(first.value, again.value, "{unit}: value");
        assert_ne!(
            first.policy.layers(),
            other.policy.layers(),
            "{unit}: two seeds"
        );
    }
}

#[test]
fn progress_counts_steps_and_can_cancel() {
    let settings = settings(short(10_000), 1);
    let mut corridor = Corridor::new(8, 1);
    let mut last = Progress::default();
    let report = |progress: &Progress| {
        last = *progress;
        ControlFlow::Continue(())
    };
    train(&mut corridor, &settings, report).unwrap();
    assert_eq!(
        (last.steps, last.total_steps),
        (10_240, 10_240),
        "whole rollouts of 2,048"
    );
    assert!(last.episodes > 0 && last.mean_return.is_some(), "{last:?}");

    let result = train(&mut corridor, &settings, |_| ControlFlow::Break(()));
    assert!(
        matches!(result, Err(TrainError::Cancelled { .. })),
        "{result:?}"
    );
}

#[test]
fn faults_are_named() {
    let good = settings(short(4096), 1);
    let mut no_layers = good.clone();
    no_layers.layers.clear();
    let mut bad_discount = good.clone();
    bad_discount.discount = f32::NAN;
    let mut bad_rate = good.clone();
    bad_rate.recipe.learning_rate.start = f32::NAN;
    let mut other_count = good.clone();
    other_count.recipe.environments = 4;
    let mut other_inputs = good.clone();
    other_inputs.scaling = InputScaling::identity(2);
    let cases = [
        (&no_layers, Fault::None, "no hidden layer"),
        (&bad_discount, Fault::None, "the discount is NaN"),
        (&bad_rate, Fault::None, "learning_rate is NaN"),
        (
            &other_count,
            Fault::None,
            "the task has 8, the settings say 4",
        ),
        (
            &other_inputs,
            Fault::None,
            "the task has 1, the settings say 2",
        ),
        (
            &good,
            Fault::BadReward,
            "environment 0 gave a reward that is not finite at step",
        ),
        (
            &good,
            Fault::BadFeature,
            "environment 0 gave an observation that is not finite",
        ),
        (
            &good,
            Fault::NothingAllowed,
            "environment 0 gave a mask that allows no action",
        ),
        (
            &good,
            Fault::Broken,
            "an environment failed at step 800: the corridor is closed",
        ),
        (
            &good,
            Fault::HugeReward,
            "training diverged after 2048 steps",
        ),
    ];
    for (settings, fault, expected) in cases {
        let mut corridor = Corridor::new(8, 1);
        corridor.fault = fault;
        let error = train(&mut corridor, settings, |_| ControlFlow::Continue(())).unwrap_err();
        assert!(
            error.to_string().contains(expected),
            "{error}\nshould say: {expected}"
        );
    }
}

#[test]
fn a_recurrent_recipe_differs_in_its_rollouts_alone() {
    for recipe in Recipe::all() {
        let recurrent = recipe.clone().recurrent();
        let sequences = recurrent.minibatch / recurrent.rollout;
        assert_eq!(sequences * recurrent.rollout, recurrent.minibatch);
        assert!(sequences >= 4 && recurrent.environments.is_multiple_of(sequences));
        let again = Recipe {
            environments: recipe.environments,
            rollout: recipe.rollout,
            minibatch: recipe.minibatch,
            ..recurrent
        };
        assert_eq!(again, recipe);
    }
}

#[test]
fn recipes_are_found_by_name() {
    for recipe in Recipe::all() {
        assert_eq!(recipe.name.parse::<Recipe>().unwrap(), recipe);
    }
    let error = "fast".parse::<Recipe>().unwrap_err().to_string();
    assert_eq!(
        error,
        "there is no recipe \"fast\"; there are \"standard\", \"benchmark\", \"baseline\" and \"paper\""
    );
}
