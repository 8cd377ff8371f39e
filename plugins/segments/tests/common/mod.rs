//! Objects to test with.
#![allow(clippy::unwrap_used, dead_code, missing_docs)]

use pubs_plugin::{
    ActionSetup, BeliefSetup, GridTransitions, JointSetup, JointType, Mode, ModelSetup,
    ObservationModel, PluginError, Support, Transitions,
};
use pubs_segments::Segments;
use serde_json::{Value, json};

pub const F_D: usize = 0;
pub const F_Z: usize = 1;
pub const F_N: usize = 2;
pub const M_P: usize = 3;

pub fn joint(r#type: JointType, lower: f64, upper: f64) -> JointSetup {
    JointSetup {
        r#type,
        lower,
        upper,
        integer: false,
        radius_m: None,
        opening_direction: None,
        hinge_direction: None,
        up_direction: None,
        motion_threshold_m: None,
    }
}

/// `stop` and `open`, the two actions of every object here.
pub fn setup(joint: JointSetup, particles: u32, segments: Vec<Value>) -> ModelSetup {
    let action = |name: &str, stop| ActionSetup {
        name: name.to_owned(),
        stop,
        mode: Mode::Safe,
        displacement: 0.0,
        observations: 1,
    };
    let spacing = (joint.upper - joint.lower) / f64::from(particles);
    ModelSetup {
        joint,
        actions: vec![action("stop", true), action("open", false)],
        control: None,
        belief: BeliefSetup { particles, spacing },
        observation: json!({ "model": "segments", "bias_sd_n": 0.0, "correlation_m": 0.0, "segment": segments }),
        seed: 0,
    }
}

/// A slide of 0.4 m. f_d falls from 8 N to 2 N over the first 0.1 m, jumps to 5 N at 0.15 m and
/// rises linearly to 15 N at 0.4 m, its sigma there from 1 N to 3 N; f_z is 1 N, f_n −2 N; m_p is
/// certain but for 0.2 … 0.3 m, where it falls from 0.5 to 0.
pub fn slide() -> Vec<Value> {
    vec![
        json!({ "action": "open", "channel": "f_d", "from_m": 0.0, "to_m": 0.15, "sigma_n": 0.5, "position_m": [0.0, 0.1], "mean_n": [8.0, 2.0] }),
        json!({ "action": "open", "channel": "f_d", "from_m": 0.15, "to_m": 0.4, "sigma_n": [1.0, 3.0], "position_m": [0.15, 0.4], "mean_n": [5.0, 15.0] }),
        json!({ "action": "open", "channel": "f_z", "from_m": 0.0, "to_m": 0.4, "sigma_n": 0.25, "position_m": [0.2], "mean_n": [1.0] }),
        json!({ "action": "open", "channel": "f_n", "from_m": 0.0, "to_m": 0.4, "sigma_n": 0.125, "mean_n": -2.0 }),
        json!({ "action": "open", "channel": "m_p", "from_m": 0.0, "to_m": 0.2, "probability": 1.0 }),
        json!({ "action": "open", "channel": "m_p", "from_m": 0.2, "to_m": 0.3, "position_m": [0.2, 0.3], "probability": [0.5, 0.0] }),
        json!({ "action": "open", "channel": "m_p", "from_m": 0.3, "to_m": 0.4, "probability": 0.98 }),
    ]
}

/// What [`slide`] says, written down a second time: mean of each channel, sigma of each.
pub fn slide_by_hand(state: f64) -> ([f64; 4], [f64; 4]) {
    let f_d = match state {
        s if s < 0.1 => 8.0 - 60.0 * s,
        s if s < 0.15 => 2.0,
        s => 5.0 + 40.0 * (s - 0.15),
    };
    let sigma_d = if state < 0.15 {
        0.5
    } else {
        1.0 + 8.0 * (state - 0.15)
    };
    let m_p = match state {
        s if s < 0.2 => 0.999,
        s if s < 0.3 => (0.5 - 5.0 * (s - 0.2)).max(0.001),
        _ => 0.98,
    };
    ([f_d, 1.0, -2.0, m_p], [sigma_d, 0.25, 0.125, 1.0])
}

pub fn slide_setup(particles: u32) -> ModelSetup {
    setup(joint(JointType::Prismatic, 0.0, 0.4), particles, slide())
}

/// Mean and sigma, `[C][N]`.
pub type Moments = (Vec<f32>, Vec<f32>);

pub fn moments(
    model: &Segments,
    action: usize,
    before: &[f32],
    after: &[f32],
) -> Result<Moments, PluginError> {
    let (mut mean, mut sigma) = (
        vec![f32::NAN; 4 * after.len()],
        vec![f32::NAN; 4 * after.len()],
    );
    let support = model.moments(
        Transitions {
            action,
            before,
            after,
        },
        &mut mean,
        &mut sigma,
    )?;
    assert_eq!(support, Support::Given);
    Ok((mean, sigma))
}

/// `None` where the model leaves the grid to `moments`.
pub fn moments_grid(model: &Segments, grid: GridTransitions) -> Option<Moments> {
    let (mut mean, mut sigma) = (
        vec![f32::NAN; 4 * grid.count],
        vec![f32::NAN; 4 * grid.count],
    );
    let support = model.moments_grid(grid, &mut mean, &mut sigma).unwrap();
    (support == Support::Given).then_some((mean, sigma))
}

/// Moments at single states, the same before and after the move: `[mean…, sigma…]` of each.
pub fn at_each(model: &Segments, states: &[f32]) -> Vec<[f32; 8]> {
    let (mean, sigma) = moments(model, 1, states, states).unwrap();
    let n = states.len();
    (0..n)
        .map(|i| {
            std::array::from_fn(|lane| {
                if lane < 4 {
                    mean[lane * n + i]
                } else {
                    sigma[(lane - 4) * n + i]
                }
            })
        })
        .collect()
}
