//! Recurrent PPO on a task that asks for memory, and what its training promises besides.
#![allow(clippy::unwrap_used)]

mod recall;

use std::ops::ControlFlow;

use pubs_train::{
    InputScaling, Lstm, Recipe, RecurrentPolicy, Settings, TrainedRecurrent, VectorUnit, train,
    train_recurrent,
};
use recall::{ACTIONS, FEATURES, LENGTH, Recall, observation};

const LSTM: Lstm = Lstm {
    layers: 1,
    width: 32,
};

fn settings(steps: usize, seed: u64) -> Settings {
    Settings {
        recipe: Recipe {
            steps,
            ..Recipe::baseline().recurrent()
        },
        layers: vec![32],
        scaling: InputScaling::identity(FEATURES),
        discount: 0.9,
        seed,
        unit: VectorUnit::best(),
    }
}

fn trained(settings: &Settings, lstm: Lstm) -> TrainedRecurrent {
    let mut recall = Recall::new(settings.recipe.environments, settings.seed);
    train_recurrent(&mut recall, settings, lstm, |_| ControlFlow::Continue(())).unwrap()
}

/// The more probable action at the end of an episode with this sign.
fn recalled(policy: &mut RecurrentPolicy, sign: bool) -> usize {
    let mut state = vec![0.0; policy.state_size()];
    let mut logits = [0.0; ACTIONS];
    for step in 0..LENGTH {
        policy.logits(&observation(sign, step), &mut state, &mut logits);
    }
    usize::from(logits[1] > logits[0])
}

#[test]
fn recalls_what_a_perceptron_cannot() {
    let settings = settings(60_000, 1);
    for layers in [1, 2] {
        let lstm = Lstm { layers, ..LSTM };
        let TrainedRecurrent {
            mut policy,
            progress,
            ..
        } = trained(&settings, lstm);
        let recalled = [false, true].map(|sign| recalled(&mut policy, sign));
        assert_eq!(recalled, [0, 1], "{layers} layers: {progress:?}");
        let success = progress.success_rate.unwrap();
        assert!(success > 0.97, "{layers} layers: {progress:?}");
    }
    let mut recall = Recall::new(settings.recipe.environments, 1);
    let without = train(&mut recall, &settings, |_| ControlFlow::Continue(())).unwrap();
    let success = without.progress.success_rate.unwrap();
    assert!(success < 0.6, "the task asks for no memory: {success}");
}

#[test]
fn one_seed_gives_the_same_weights_and_another_does_not() {
    for unit in VectorUnit::available() {
        let with = |seed| {
            let settings = Settings {
                unit,
                ..settings(8192, seed)
            };
            let trained = trained(&settings, Lstm { layers: 2, ..LSTM });
            let policy = &trained.policy;
            (
                (policy.lstm_layers(), policy.dense_layers()),
                (trained.value_lstm, trained.value),
            )
        };
        let (first, again, other) = (with(1), with(1), with(2));
        assert_eq!(first.0, again.0, "{unit}: policy");
        assert_eq!(first.1, again.1, "{unit}: value");
        assert_ne!(first.0, other.0, "{unit}: two seeds");
    }
}

#[test]
fn layers_have_the_shapes_and_the_spread_of_pytorch() {
    let lstm = Lstm {
        layers: 2,
        width: 20,
    };
    let mut settings = settings(2048, 1);
    // So little learning that the weights are still the first ones.
    settings.recipe.learning_rate.start = 1e-12;
    let trained = trained(&settings, lstm);
    let bound = 1.0 / (lstm.width as f32).sqrt();
    let layers = trained.policy.lstm_layers();
    assert_eq!(layers.len(), 2);
    assert_eq!(trained.policy.state_size(), 2 * 2 * 20);
    for (layer, inputs) in layers.iter().zip([FEATURES, 20]) {
        assert_eq!((layer.inputs, layer.width), (inputs, 20));
        let matrices = [
            (&layer.weights_input, 80 * inputs, 1.0),
            (&layer.weights_hidden, 80 * 20, 1.0),
            // The sum of two.
            (&layer.bias, 80, 2.0),
        ];
        for (numbers, count, terms) in matrices {
            assert_eq!(numbers.len(), count);
            let largest = numbers.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
            assert!(
                largest < terms * bound + 1e-6 && largest > 0.6 * terms * bound,
                "{largest} of {terms} · {bound}"
            );
            let square = numbers.iter().map(|x| x * x).sum::<f32>() / count as f32;
            let expected = terms * bound * bound / 3.0;
            assert!(
                (square / expected - 1.0).abs() < 0.35,
                "mean square {square}, not {expected}"
            );
        }
    }
    let dense = trained.policy.dense_layers();
    let shapes: Vec<_> = dense.iter().map(|l| (l.inputs, l.outputs)).collect();
    assert_eq!(shapes, [(20, 32), (32, ACTIONS)]);
}

#[test]
fn faults_are_named() {
    let good = settings(2048, 1);
    let mut no_steps = good.clone();
    no_steps.recipe.rollout = 0;
    let none = Lstm { layers: 0, ..LSTM };
    let empty = Lstm { width: 0, ..LSTM };
    let cases = [
        (&good, none, "there are 0 recurrent layers of width 32"),
        (&good, empty, "there are 1 recurrent layers of width 0"),
        (&no_steps, LSTM, "rollout is 0"),
    ];
    for (settings, lstm, expected) in cases {
        let mut recall = Recall::new(32, 1);
        let result = train_recurrent(&mut recall, settings, lstm, |_| ControlFlow::Continue(()));
        let error = result.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nshould say: {expected}");
    }
}
