//! Moments against values worked out by hand.
#![allow(clippy::unwrap_used)]

use pubs_plugin::{BeliefSetup, JointSetup, JointType};
use serde_json::json;

use serde_json::Value;

use super::*;

fn model(params: Value) -> Result<LightDark, PluginError> {
    LightDark::create(&ModelSetup {
        joint: JointSetup {
            r#type: JointType::Abstract,
            lower: -60.0,
            upper: 60.0,
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
            spacing: 0.61,
        },
        observation: json!({ "model": "light-dark", "params": params }),
        seed: 1,
    })
}

#[test]
fn position_is_seen_the_better_the_nearer_the_light() {
    // States before the move are far away: they must not matter.
    let before = [-60.0; 5];
    let after = [10.0, 9.0, 0.0, -30.0, 60.0];
    let transitions = Transitions {
        action: 1,
        before: &before,
        after: &after,
    };
    let own = json!({ "light": 9.0, "slope": 0.5, "floor": 0.25 });
    let cases = [
        (Value::Null, [0.001, 1.001, 10.001, 40.001, 50.001]),
        (json!({}), [0.001, 1.001, 10.001, 40.001, 50.001]),
        (own, [0.75, 0.25, 4.75, 19.75, 25.75]),
    ];
    for (params, expected) in cases {
        let model = model(params.clone()).unwrap();
        let (mut mean, mut sigma) = ([f32::NAN; 5], [f32::NAN; 5]);
        let answer = model.moments(transitions, &mut mean, &mut sigma);
        assert_eq!(answer.unwrap(), Support::Given);
        assert_eq!(mean, after, "{params}: the mean is the state after");
        for (index, (found, expected)) in sigma.iter().zip(expected).enumerate() {
            assert!(
                (found - expected).abs() < 1e-5,
                "{params}: sigma at {} is {found}, expected {expected}",
                after[index]
            );
        }
    }
}

#[test]
fn a_parameter_that_is_no_number_is_named() {
    let error = model(json!({ "light": "lamp" })).unwrap_err().to_string();
    assert!(error.contains("light") && error.contains("lamp"), "{error}");
}
