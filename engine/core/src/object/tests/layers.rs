//! Which layer wins, and that each value knows where it came from.

use super::{DOOR, LIGHT_DARK, load, load_with, set};
use crate::object::{DEFAULTS, Origin, Overrides, keys, schema};
use pubs_plugin::JointType;

fn environment(items: &[(&str, &str)], set: &[&str]) -> Overrides {
    let items = items
        .iter()
        .map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
    Overrides::new(items, set.iter().map(|item| (*item).to_owned()))
}

#[test]
fn each_layer_goes_over_the_one_before_and_is_remembered() {
    let in_file = DOOR.replace("[reward]", "[belief]\nparticles = 400\n[reward]");
    let variable = [("PUBS_SET__BELIEF__PARTICLES", "500"), ("OTHER", "1")];
    let origin_of_variable = Origin::Environment("PUBS_SET__BELIEF__PARTICLES=500".to_owned());
    let origin_of_set = Origin::Set("belief.particles=600".to_owned());
    let cases = [
        (DOOR, environment(&[], &[]), 300, Origin::Default, None),
        (
            &in_file,
            environment(&[], &[]),
            400,
            Origin::File,
            Some((13, 13)),
        ),
        (
            &in_file,
            environment(&variable, &[]),
            500,
            origin_of_variable,
            None,
        ),
        (
            &in_file,
            environment(&variable, &["belief.particles=600"]),
            600,
            origin_of_set,
            None,
        ),
    ];
    for (text, overrides, particles, origin, at) in cases {
        let object = load_with(text, &overrides).unwrap();
        assert_eq!(object.file.belief.particles, particles);
        let location = object.location("belief.particles").unwrap();
        assert_eq!(location.origin, origin);
        assert_eq!(location.line.zip(location.column), at, "{origin:?}");
    }
}

#[test]
fn values_of_overrides_are_toml_or_else_text() {
    let object = load_with(
        DOOR,
        &set(&[
            "name=other",
            "joint.limits_deg=[10, 80.5]",
            "observation.model = \"mine\"",
            "policy.shield={ mass = 0.5 }",
            "driver.plugin=virtual-arm",
            "driver.params.deep.er=true",
        ]),
    )
    .unwrap()
    .file;
    assert_eq!(object.name, "other");
    assert_eq!(object.joint.limits_deg, Some([10.0, 80.5]));
    assert_eq!(object.observation.model, "mine");
    assert_eq!(
        (object.policy.shield.mass, object.policy.shield.flattening),
        (0.5, 0.3)
    );
    let params = object.driver.unwrap().params.unwrap();
    assert_eq!(params, serde_json::json!({ "deep": { "er": true } }));
}

#[test]
fn parameters_of_the_files_own_driver_are_not_another_ones() {
    let text = format!("{DOOR}[driver]\nplugin = \"sim\"\nparams = {{ world = \"door\" }}\n");
    let cases: [(&[&str], serde_json::Value); 3] = [
        (
            &["driver.plugin=sim"],
            serde_json::json!({ "world": "door" }),
        ),
        (
            &["driver.params.start=0.5"],
            serde_json::json!({ "world": "door", "start": 0.5 }),
        ),
        (
            &["driver.plugin=arm", "driver.params.host=10.0.0.1"],
            serde_json::json!({ "host": "10.0.0.1" }),
        ),
    ];
    for (overrides, expected) in cases {
        let object = load_with(&text, &set(overrides)).unwrap().file;
        let params = object.driver.unwrap().params;
        assert_eq!(params, Some(expected), "{overrides:?}");
    }
}

#[test]
fn faults_of_overrides_name_what_was_typed() {
    let cases = [
        (
            environment(&[], &["belief.particles=1"]),
            "belief.particles",
            "--set belief.particles=1",
        ),
        (
            environment(&[("PUBS_SET__CONTROL__RATE_HZ", "fast")], &[]),
            "control.rate_hz",
            "PUBS_SET__CONTROL__RATE_HZ=fast",
        ),
        (environment(&[], &["belief"]), "", "--set belief"),
        (
            environment(&[], &["belief..particles=3"]),
            "",
            "belief..particles",
        ),
        (environment(&[("PUBS_SET__", "1")], &[]), "", "PUBS_SET__=1"),
    ];
    for (overrides, key, typed) in cases {
        let faults = load_with(DOOR, &overrides).unwrap_err();
        let shown = crate::object::render(&faults, false);
        assert_eq!(faults.0.len(), 1, "{shown}");
        let fault = &faults.0[0];
        assert_eq!((fault.key.as_str(), fault.line), (key, None), "{shown}");
        assert!(
            fault.message.contains(typed),
            "{typed:?} not in {}",
            fault.message
        );
        assert!(shown.contains(typed), "{shown}");
    }
    let unknown = load_with(DOOR, &set(&["belief.particels=9"])).unwrap_err();
    assert!(unknown.0[0].help.contains("`particles`"), "{unknown}");
    let list = load_with(LIGHT_DARK, &set(&["action.1.move=5"])).unwrap_err();
    assert!(
        list.0[0].message.contains("`action`, which is a list"),
        "{list}"
    );
}

#[test]
fn the_defaults_are_those_that_are_documented() {
    let object = load(DOOR).unwrap().file;
    let control = object.control.unwrap();
    assert_eq!(
        [
            control.rate_hz,
            control.safe_speed_m_s,
            control.high_speed_m_s,
            control.force_threshold_n,
            control.force_limit_n,
            control.acceleration_m_s2,
            control.stop_deceleration_m_s2,
            control.contact_stiffness_n_per_m,
        ],
        [100.0, 0.05, 0.15, 15.0, 60.0, 1.0, 5.0, 5000.0]
    );
    assert_eq!(object.joint.motion_threshold_m, Some(0.0005));
    assert_eq!(object.belief.particles, 300);
    assert_eq!(object.belief.rate_hz, Some(30.0));
    assert_eq!(
        (object.belief.tempering, object.belief.reading_spacing_m),
        (0.125, 0.005)
    );
    assert_eq!(
        (object.policy.rate_hz, object.policy.layers),
        (Some(10.0), vec![64, 64, 64])
    );
    assert_eq!(
        (object.policy.shield.mass, object.policy.shield.flattening),
        (0.001, 0.3)
    );
    let reward = object.reward;
    assert_eq!(
        [
            reward.goal,
            reward.failed_stop,
            reward.safety_violation,
            reward.time,
            reward.discount
        ],
        [1.0, -1.0, -1.0, -0.001, 0.99]
    );
    let observation = object.observation;
    assert_eq!(observation.model, "segments");
    assert_eq!(
        (observation.bias_sd_n, observation.correlation_m),
        (0.0, 0.0)
    );
}

/// Keys with a value in the defaults, tables left out.
fn leaves(parent: &str, table: &toml::Table) -> Vec<String> {
    let mut found = Vec::new();
    for (name, value) in table {
        let path = if parent.is_empty() {
            name.clone()
        } else {
            format!("{parent}.{name}")
        };
        match value {
            toml::Value::Table(inner) => found.extend(leaves(&path, inner)),
            _ => found.push(path),
        }
    }
    found
}

#[test]
fn every_key_declared_to_have_a_default_has_one_and_no_other() {
    let mut shipped = leaves("", &DEFAULTS.parse().unwrap());
    let mut declared: Vec<String> = keys::KEYS
        .iter()
        .filter(|key| !matches!(key.kind, schema::Kind::Table))
        .filter(|key| key.need.contains(&schema::Need::Defaulted))
        .map(|key| key.path.to_owned())
        .collect();
    shipped.sort();
    declared.sort();
    assert_eq!(shipped, declared);
}

#[test]
fn an_abstract_object_inherits_neither_reward_nor_belief() {
    let object = load(LIGHT_DARK).unwrap();
    for (key, origin) in [
        ("reward.discount", Some(Origin::File)),
        ("policy.layers", Some(Origin::Default)),
        ("policy.rate_hz", None),
        ("belief.rate_hz", None),
        ("control.rate_hz", None),
    ] {
        assert_eq!(
            object.location(key).map(|location| location.origin),
            origin,
            "{key}"
        );
    }
    let file = &object.file;
    assert_eq!(file.joint.r#type, JointType::Abstract);
    assert!(file.control.is_none() && file.driver.is_none());
    assert_eq!(file.actions.len(), 3);
    assert_eq!(
        (file.actions[1].r#move, file.actions[1].observations),
        (10.0, 10)
    );
    assert!(file.actions[2].high_force && file.actions[0].stop);
    let without = LIGHT_DARK
        .replace("[reward]\nshape = \"flat\"\ngoal_tolerance = 0.5\ngoal = 100.0\nfailed_stop = -100.0\nsafety_violation = 0.0\ntime = -1.0\ndiscount = 0.95\n", "");
    let faults = super::faults_of(&without);
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert_eq!(faults[0].message, "`reward` is missing");
    assert!(
        faults[0].help.contains("shape, goal_tolerance, goal"),
        "{}",
        faults[0].help
    );
}
