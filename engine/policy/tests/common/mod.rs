//! Networks, contracts and inputs for the tests of this crate.
#![allow(dead_code, clippy::unwrap_used)]

use pubs_policy::{
    Contract, Dense, Existing, Feature, FeatureName, Goal, LstmCell, Method, Network, Policy,
    PolicyFile, Reference, Runtime, Shield, export,
};
use serde_json::{Value, json};

/// Knuth's 64-bit linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    pub fn below(&mut self, limit: usize) -> usize {
        self.bits() as usize % limit
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f64 {
        self.bits() as f64 / (1_u64 << 30) as f64 - 1.0
    }
}

pub const WIDTHS: [usize; 5] = [3, 64, 64, 64, 5];

pub fn network(seed: u64, widths: &[usize]) -> Network {
    let mut random = Random(seed);
    let layers = widths
        .windows(2)
        .map(|pair| dense(&mut random, pair[0], pair[1]))
        .collect();
    Network {
        inputs: features(widths[0]),
        lstm: Vec::new(),
        layers,
    }
}

/// LSTM layers of these widths on three inputs, then a perceptron: 16 tanh units and five actions.
pub fn recurrent(seed: u64, lstm: &[usize]) -> Network {
    let mut random = Random(seed);
    let mut inputs = 3;
    let mut layers = Vec::new();
    for width in lstm {
        layers.push(lstm_cell(&mut random, inputs, *width));
        inputs = *width;
    }
    Network {
        inputs: features(3),
        lstm: layers,
        layers: vec![dense(&mut random, inputs, 16), dense(&mut random, 16, 5)],
    }
}

fn lstm_cell(random: &mut Random, inputs: usize, width: usize) -> LstmCell {
    let spread = 2.0 / (width as f64).sqrt();
    let mut values = |count: usize| {
        (0..count)
            .map(|_| (spread * random.signed()) as f32)
            .collect()
    };
    LstmCell {
        inputs,
        width,
        weights_input: values(4 * width * inputs),
        weights_hidden: values(4 * width * width),
        bias: values(4 * width),
    }
}

fn dense(random: &mut Random, inputs: usize, outputs: usize) -> Dense {
    let spread = 2.0 / (inputs as f64).sqrt();
    let mut values = |count: usize| {
        (0..count)
            .map(|_| (spread * random.signed()) as f32)
            .collect()
    };
    Dense {
        inputs,
        outputs,
        weights: values(inputs * outputs),
        bias: values(outputs),
    }
}

fn features(count: usize) -> Vec<Feature> {
    let feature = |name, unit: &str, lower, upper, offset, scale| Feature {
        name,
        unit: unit.to_owned(),
        lower,
        upper,
        offset,
        scale,
    };
    let all = [
        feature(FeatureName::MeanState, "rad", 0.0, 2.25, 1.125, 0.75),
        feature(FeatureName::Entropy, "1", 0.0, 1.0, 0.5, 2.0),
        feature(FeatureName::MeanMinusGoal, "rad", -2.25, 2.25, 0.0, 0.5),
    ];
    all.into_iter().cycle().take(count).collect()
}

pub fn task() -> Value {
    json!({
        "joint": {"type": "revolute", "lower": 0.0, "upper": 2.25},
        "actions": [{"name": "stop"}, {"name": "safe_open"}],
        "control": {"safe_speed_m_s": 0.05, "high_speed_m_s": 0.15, "rate_hz": 100},
        "belief": {"particles": 300, "tempering": 1.0},
    })
}

pub fn contract(network: &Network) -> Contract {
    let mut contract = Contract {
        format_version: network.format_version(),
        object: "door2".into(),
        task_hash: String::new(),
        task: String::new(),
        observation_hash: "0b5e".repeat(16),
        goal: Goal::Fixed {
            value: 1.125,
            fraction: 0.5,
        },
        tolerance: 0.125,
        inputs: network.inputs.clone(),
        actions: (0..network.actions())
            .map(|action| format!("action{action}"))
            .collect(),
        shield: Some(Shield {
            mass: 0.001,
            flattening: 0.3,
        }),
        discount: 0.99,
        policy_rate_hz: 10.0,
        seed: u64::MAX,
        steps: 500_000,
        recipe: "default".into(),
        evaluation_reward: 0.875,
        engine_version: "0.1.0".into(),
        method: Method::Pubs,
        state: network.state(),
    };
    contract.set_task(&task());
    contract
}

/// `[rows][features]`, spread over twice the ranges of training.
pub fn inputs(seed: u64, network: &Network, rows: usize) -> Vec<f32> {
    let mut random = Random(seed);
    let row = |_| {
        let mut value = |feature: &Feature| {
            let middle = (feature.lower + feature.upper) / 2.0;
            (middle + (feature.upper - feature.lower) * random.signed()) as f32
        };
        network.inputs.iter().map(&mut value).collect::<Vec<f32>>()
    };
    (0..rows).flat_map(row).collect()
}

pub fn logits(network: &Network, inputs: &[f32]) -> Vec<f32> {
    let mut logits = vec![0.0; inputs.len() / network.inputs.len() * network.actions()];
    network.forward(inputs, &mut logits);
    logits
}

/// The logits of episodes of so many steps, whose inputs stand one after the other.
pub fn episode_logits(network: &Network, inputs: &[f32], steps: usize) -> Vec<f32> {
    let mut logits = vec![0.0; inputs.len() / network.inputs.len() * network.actions()];
    let mut state = vec![0.0; network.state_width()];
    let rows = inputs.chunks_exact(network.inputs.len());
    for (row, (input, out)) in rows
        .zip(logits.chunks_exact_mut(network.actions()))
        .enumerate()
    {
        if row % steps == 0 {
            state.fill(0.0);
        }
        network.forward_with_state(input, &mut state, out);
    }
    logits
}

/// Steps of the reference's episodes.
pub fn steps(network: &Network) -> usize {
    if network.lstm.is_empty() { 1 } else { 50 }
}

/// Writes a policy and gives its bytes too.
pub fn written(
    directory: &std::path::Path,
    network: &Network,
    runtime: &Runtime,
) -> (PolicyFile, Vec<u8>) {
    let path = directory.join("door2.onnx");
    let inputs = inputs(1, network, 1000);
    let steps = steps(network);
    let logits = episode_logits(network, &inputs, steps);
    let reference = Reference {
        inputs: &inputs,
        logits: &logits,
        steps,
    };
    let file = export::write(
        &path,
        network,
        &contract(network),
        reference,
        runtime,
        Existing::Replace,
    )
    .unwrap();
    let bytes = std::fs::read(path).unwrap();
    (file, bytes)
}

/// Episodes side by side through the file and the plain forward pass; the largest differences of
/// logits and of state.
pub fn worst_over_steps(
    policy: &mut Policy,
    network: &Network,
    episodes: usize,
    steps: usize,
) -> (f32, f32) {
    let mut state = vec![0.0; episodes * network.state_width()];
    let mut wanted_state = state.clone();
    let mut found = Vec::new();
    let mut wanted = vec![0.0; episodes * network.actions()];
    let largest = |a: &[f32], b: &[f32]| {
        assert_eq!(a.len(), b.len());
        a.iter()
            .zip(b)
            .fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()))
    };
    let (mut of_logits, mut of_state) = (0.0_f32, 0.0_f32);
    for step in 0..steps {
        let inputs = inputs(step as u64, network, episodes);
        policy
            .logits_with_state(&inputs, episodes, &mut state, &mut found)
            .unwrap();
        network.forward_with_state(&inputs, &mut wanted_state, &mut wanted);
        of_logits = of_logits.max(largest(&found, &wanted));
        of_state = of_state.max(largest(&state, &wanted_state));
    }
    (of_logits, of_state)
}
