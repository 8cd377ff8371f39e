//! Time of one call of `moments` and `moments_grid`, for each vector unit: median of many batches.
//! Run it on a quiet machine: `cargo bench -p pubs-segments`.

use std::hint::black_box;
use std::time::Instant;

use pubs_plugin::{
    ActionSetup, BeliefSetup, GridTransitions, JointSetup, JointType, Mode, ModelSetup,
    ObservationModel, Transitions,
};
use pubs_segments::{Segments, VectorUnit};
use serde_json::{Value, json};

const CHANNELS: usize = 4;
const UPPER_DEG: f64 = 125.0;

fn main() {
    println!("ns for one call: median (least) of 51 batches");
    for unit in VectorUnit::ALL
        .into_iter()
        .filter(|unit| unit.is_available())
    {
        for count in [1, 2, 300, 3000] {
            let scattered = time_ns(count, moments_call(unit, count));
            println!("{unit:?}: moments      N = {count:4}: {scattered}");
        }
        for count in [300, 3000] {
            let gridded = time_ns(count, grid_call(unit, count));
            println!("{unit:?}: moments_grid N = {count:4}: {gridded}");
        }
    }
}

fn moments_call(unit: VectorUnit, count: usize) -> impl FnMut(usize) {
    let model = model(count.max(300), unit);
    let range = UPPER_DEG.to_radians() as f32;
    // In order, as particles are.
    let before: Vec<f32> = (0..count)
        .map(|i| (i as f32 + 0.5) / count as f32 * range)
        .collect();
    let after: Vec<f32> = before.iter().map(|state| state + 0.01).collect();
    let (mut mean, mut sigma) = (vec![0.0; CHANNELS * count], vec![0.0; CHANNELS * count]);
    move |turn| {
        let transitions = Transitions {
            action: 1 + turn % 4,
            before: black_box(&before),
            after: black_box(&after),
        };
        black_box(model.moments(transitions, &mut mean, &mut sigma)).ok();
        black_box((&mean, &sigma));
    }
}

fn grid_call(unit: VectorUnit, count: usize) -> impl FnMut(usize) {
    let model = model(count, unit);
    let spacing = (UPPER_DEG.to_radians() / count as f64) as f32;
    let (mut mean, mut sigma) = (vec![0.0; CHANNELS * count], vec![0.0; CHANNELS * count]);
    move |turn| {
        let before = black_box(spacing * (turn % 17) as f32 * 0.37);
        let grid = GridTransitions {
            action: 1 + turn % 4,
            before,
            after: before + 0.01,
            spacing,
            count,
        };
        black_box(model.moments_grid(grid, &mut mean, &mut sigma)).ok();
        black_box((&mean, &sigma));
    }
}

fn time_ns(count: usize, mut call: impl FnMut(usize)) -> String {
    let calls = (200_000 / count).clamp(100, 20_000);
    let mut batches: Vec<f64> = (0..51)
        .map(|_| {
            let start = Instant::now();
            (0..calls).for_each(&mut call);
            start.elapsed().as_secs_f64() * 1e9 / calls as f64
        })
        .collect();
    batches.sort_by(f64::total_cmp);
    format!("{:9.1} ({:.1})", batches[batches.len() / 2], batches[0])
}

/// A hinge with a detent near the closed limit, as a calibration would describe it.
fn model(particles: usize, unit: VectorUnit) -> Segments {
    let names = ["stop", "safe_open", "safe_close", "high_open", "high_close"];
    let action = |name: &&str| ActionSetup {
        name: (*name).to_owned(),
        stop: *name == "stop",
        mode: if name.starts_with("high") {
            Mode::HighForce
        } else {
            Mode::Safe
        },
        displacement: 0.01,
        observations: 1,
    };
    let setup = ModelSetup {
        joint: JointSetup {
            r#type: JointType::Revolute,
            lower: 0.0,
            upper: UPPER_DEG.to_radians(),
            integer: false,
            radius_m: Some(0.32),
            opening_direction: None,
            hinge_direction: None,
            up_direction: None,
            motion_threshold_m: None,
        },
        actions: names.iter().map(action).collect(),
        control: None,
        belief: BeliefSetup {
            particles: particles as u32,
            spacing: UPPER_DEG.to_radians() / particles as f64,
        },
        observation: json!({ "model": "segments", "segment": names[1..].iter().flat_map(|name| segments(name)).collect::<Vec<_>>() }),
        seed: 0,
    };
    match Segments::create(&setup) {
        Ok(model) => model.with_vector_unit(unit),
        Err(error) => panic!("the benchmark's own segments are wrong: {error}"),
    }
}

fn segments(action: &str) -> Vec<Value> {
    let force = |channel: &str| {
        [
            json!({ "action": action, "channel": channel, "from_deg": 0.0, "to_deg": 4.5, "sigma_n": 0.8,
                    "position_deg": [0.0, 0.5, 1.0, 2.0], "mean_n": [11.2, 9.7, 6.1, 3.0] }),
            json!({ "action": action, "channel": channel, "from_deg": 4.5, "to_deg": UPPER_DEG, "sigma_n": 0.3,
                    "position_deg": [10.0, 60.0, 120.0], "mean_n": [2.5, 2.0, 9.0] }),
        ]
    };
    let moved = json!({ "action": action, "channel": "m_p", "from_deg": 0.0, "to_deg": UPPER_DEG, "probability": 0.98 });
    ["f_d", "f_z", "f_n"]
        .into_iter()
        .flat_map(force)
        .chain([moved])
        .collect()
}
