//! Moments against values worked out by hand.
#![allow(clippy::unwrap_used)]

use pubs_plugin::{BeliefSetup, JointSetup, JointType};
use serde_json::json;

use serde_json::Value;

use super::*;

fn model(params: Value) -> Result<LimitSensor, PluginError> {
    LimitSensor::create(&ModelSetup {
        joint: JointSetup {
            r#type: JointType::Abstract,
            lower: 1.0,
            upper: 100.0,
            integer: true,
            radius_m: None,
            opening_direction: None,
            hinge_direction: None,
            up_direction: None,
            motion_threshold_m: None,
        },
        actions: Vec::new(),
        control: None,
        belief: BeliefSetup {
            particles: 100,
            spacing: 1.0,
        },
        observation: json!({ "model": "limit-sensor", "params": params }),
        seed: 1,
    })
}

#[test]
fn the_force_is_high_at_the_limits_and_low_elsewhere() {
    // States before the move are limits: they must not matter.
    let before = [1.0; 7];
    let after = [1.0, 2.0, 3.0, 50.0, 98.0, 99.0, 100.0];
    let transitions = Transitions {
        action: 1,
        before: &before,
        after: &after,
    };
    let own = json!({ "high_n": 20.0, "low_n": 3.0, "sigma_n": 2.0, "reach": 1.0 });
    let cases = [
        (Value::Null, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0], 0.1),
        (own, [20.0, 20.0, 3.0, 3.0, 3.0, 20.0, 20.0], 2.0),
    ];
    for (params, expected, sigma_n) in cases {
        let model = model(params.clone()).unwrap();
        let (mut mean, mut sigma) = ([f32::NAN; 7], [f32::NAN; 7]);
        let answer = model.moments(transitions, &mut mean, &mut sigma);
        assert_eq!(answer.unwrap(), Support::Given);
        assert_eq!(mean, expected, "{params}: means at {after:?}");
        assert_eq!(sigma, [sigma_n; 7], "{params}: sigmas at {after:?}");
    }
}

#[test]
fn a_parameter_that_is_no_number_is_named() {
    let error = model(json!({ "high_n": "hard" })).unwrap_err().to_string();
    assert!(
        error.contains("high_n") && error.contains("hard"),
        "{error}"
    );
}
