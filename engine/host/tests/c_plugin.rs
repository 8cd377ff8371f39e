//! A plugin written in C against the header, and every way to get it wrong.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{compile_spring, create, load, model_setup};
use pubs_host::conformance::{self, Outcome};
use pubs_host::{HostError, ModelPlugin, PluginKind, library};
use pubs_plugin::{ChannelKind, GridTransitions, Support, Transitions};
use serde_json::json;

#[test]
fn a_c_model_answers() {
    let directory = tempfile::tempdir().unwrap();
    let library = compile_spring(directory.path(), "spring.so", &[]);
    let plugin = load(&library);
    assert_eq!(
        (plugin.name(), plugin.version(), plugin.kind()),
        ("c-spring", "2.0.0", PluginKind::ObservationModel)
    );
    let model = create(&library, json!({ "stiffness": 4.0 })).unwrap();
    let channels: Vec<_> = model
        .channels()
        .iter()
        .map(|channel| (channel.name.as_str(), channel.kind))
        .collect();
    assert_eq!(
        channels,
        [
            ("f_d", ChannelKind::Gaussian),
            ("m_p", ChannelKind::Bernoulli)
        ]
    );
    assert!(model.is_gaussian());

    let (mut mean, mut sigma) = ([0.0; 4], [0.0; 4]);
    let transitions = Transitions {
        action: 1,
        before: &[0.0, 0.5],
        after: &[0.25, 0.75],
    };
    assert_eq!(
        model.moments(transitions, &mut mean, &mut sigma).unwrap(),
        Support::Given
    );
    assert_eq!((mean, sigma), ([1.0, 3.0, 0.9, 0.9], [0.5, 0.5, 1.0, 1.0]));
    let grid = GridTransitions {
        action: 1,
        before: 0.0,
        after: 0.25,
        spacing: 0.5,
        count: 2,
    };
    mean = [0.0; 4];
    assert_eq!(
        model.moments_grid(grid, &mut mean, &mut sigma).unwrap(),
        Support::Given
    );
    assert_eq!(mean, [1.0, 3.0, 0.9, 0.9]);
    let likelihood = model
        .log_likelihood(transitions, &[0.0, 1.0], &mut [0.0; 2])
        .unwrap();
    assert_eq!(likelihood, Support::Absent, "a null function is absent");
}

#[test]
fn arrays_that_do_not_match_are_refused_before_the_call() {
    let directory = tempfile::tempdir().unwrap();
    let library = compile_spring(directory.path(), "spring.so", &[]);
    let model = create(&library, json!({ "stiffness": 4.0 })).unwrap();
    let ask = |action, before: &[f32], cells: usize| {
        let transitions = Transitions {
            action,
            before,
            after: &[0.25, 0.75],
        };
        model
            .moments(transitions, &mut vec![0.0; cells], &mut [0.0; 4])
            .unwrap_err()
            .to_string()
    };
    let text = ask(2, &[0.0], 4);
    for part in [
        "plugin `c-spring`",
        "function `moments`",
        "2 states of action 2 (`safe_close`)",
        "`before` has 1",
    ] {
        assert!(text.contains(part), "{text} should hold {part}");
    }
    assert!(ask(2, &[0.0, 0.5], 3).contains("`mean` has 3"));
    assert!(ask(5, &[0.0, 0.5], 4).contains("action 5"));
}

#[test]
fn broken_libraries_are_refused_with_both_sides() {
    let directory = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 11] = [
        (
            "FAULT_ABI",
            &[
                "speaks ABI 1",
                "the plugin ABI 7",
                "rebuild it for engine",
                "take an engine that speaks ABI 7",
            ],
        ),
        (
            "FAULT_SIZE",
            &[
                "`pubs_plugin_table` is too short",
                "engine 80 bytes",
                "plugin 24 bytes",
                "rebuild",
            ],
        ),
        (
            "FAULT_MODEL_SIZE",
            &[
                "`pubs_observation_model_table` is too short",
                "engine 64",
                "plugin 16",
            ],
        ),
        (
            "FAULT_KIND",
            &["`kind`", "is 9", "1 (observation model) or 2 (driver)"],
        ),
        ("FAULT_NAME", &["`name`", "not UTF-8"]),
        ("FAULT_SCHEMA", &["`params_schema`", "not JSON"]),
        (
            "FAULT_NULL_TABLE",
            &["`pubs_observation_model_table` is null"],
        ),
        ("FAULT_NULL_MOMENTS", &["`moments` is null"]),
        ("FAULT_NOTHING", &["returned no valid pointer"]),
        ("FAULT_SYMBOL", &["not a plugin", "pubs_plugin_v1"]),
        (
            "FAULT_UNDEFINED",
            &["the system cannot load it", "nobody_defines_this"],
        ),
    ];
    for (fault, words) in cases {
        let path = compile_spring(directory.path(), &format!("{fault}.so"), &[fault]);
        let text = library::load(&path)
            .err()
            .unwrap_or_else(|| panic!("{fault} was taken"))
            .to_string();
        for word in words.iter().chain(&[path.to_str().unwrap()]) {
            assert!(
                text.contains(word),
                "{fault}: `{text}` should hold `{word}`"
            );
        }
    }
}

#[test]
fn broken_instances_are_refused_before_anything_moves() {
    let directory = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 7] = [
        (
            "FAULT_CREATE",
            &[
                "function `create`",
                "no spring of that stiffness is in stock",
            ],
        ),
        ("FAULT_STATUS", &["function `create`", "status 42"]),
        (
            "FAULT_CHANNEL_KIND",
            &["function `channels`", "channel `f_d` is of kind 7"],
        ),
        ("FAULT_CHANNEL_TWICE", &["two channels are named `f_d`"]),
        (
            "FAULT_NAN",
            &[
                "function `moments`",
                "action 0 (`stop`)",
                "mean NaN of channel `f_d` at state",
            ],
        ),
        ("FAULT_SIGMA", &["sigma 0 of channel `f_d` at state"]),
        (
            "FAULT_PROBABILITY",
            &["probability 1.25 of channel `m_p` at state 0"],
        ),
    ];
    for (fault, words) in cases {
        let path = compile_spring(directory.path(), &format!("{fault}.so"), &[fault]);
        let result = create(&path, json!({ "stiffness": 4.0 }));
        let text = result
            .err()
            .unwrap_or_else(|| panic!("{fault} was taken"))
            .to_string();
        for word in words.iter().chain(&["plugin `c-spring`"]) {
            assert!(
                text.contains(word),
                "{fault}: `{text}` should hold `{word}`"
            );
        }
    }
}

#[test]
fn parameters_are_checked_before_create() {
    let directory = tempfile::tempdir().unwrap();
    let path = compile_spring(directory.path(), "spring.so", &[]);
    let error = create(&path, json!({ "stiffness": -1.0, "stifness": 2.0 })).unwrap_err();
    let HostError::Parameters { faults, .. } = &error else {
        panic!("{error}")
    };
    let mut pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    pointers.sort_unstable();
    assert_eq!(pointers, ["/params/stiffness", "/params/stifness"]);
    let text = error.to_string();
    assert!(
        text.contains("knows no key `stifness` (value 2.0); did you mean `stiffness`?"),
        "{text}"
    );
}

#[test]
fn the_conformance_kit_tells_good_from_bad() {
    let directory = tempfile::tempdir().unwrap();
    let good = load(&compile_spring(directory.path(), "good.so", &[]));
    let setup = model_setup("c-spring", json!({ "stiffness": 4.0 }));
    let report = conformance::check(&good, Some(&setup), None);
    assert!(report.passed(), "{report:#?}");
    let names: Vec<&str> = report.checks.iter().map(|check| check.name).collect();
    assert_eq!(
        names,
        [
            "table",
            "schema",
            "bad setup",
            "create",
            "channels",
            "values",
            "moments_grid",
            "density",
            "determinism",
            "threads",
            "bad arguments"
        ]
    );

    let general = conformance::check(&good, None, None);
    let create = general.checks.last().unwrap();
    assert!(
        general.passed() && create.outcome == Outcome::Skipped,
        "{create:?}"
    );
    assert!(
        create.detail.contains("pass --object FILE"),
        "{}",
        create.detail
    );

    for (fault, check) in [
        ("FAULT_GRID", "moments_grid"),
        ("FAULT_NAN", "values"),
        ("FAULT_STATUS", "bad setup"),
    ] {
        let bad = load(&compile_spring(
            directory.path(),
            &format!("{fault}.so"),
            &[fault],
        ));
        let report = conformance::check(&bad, Some(&setup), None);
        let failed: Vec<&str> = report
            .checks
            .iter()
            .filter(|check| check.outcome == Outcome::Failed)
            .map(|check| check.name)
            .collect();
        assert_eq!(failed.first(), Some(&check), "{fault}: {report:#?}");
    }
}

#[test]
fn an_instance_outlives_the_names_of_its_plugin_and_serves_threads() {
    let directory = tempfile::tempdir().unwrap();
    let path = compile_spring(directory.path(), "spring.so", &[]);
    let plugin = ModelPlugin::new(load(&path)).unwrap();
    let model = plugin
        .create(&model_setup("c-spring", json!({ "stiffness": 2.0 })))
        .unwrap();
    drop(plugin);
    std::thread::scope(|scope| {
        for state in [0.5_f32, 1.5] {
            let model = &model;
            scope.spawn(move || {
                let (mut mean, mut sigma) = ([0.0; 2], [0.0; 2]);
                let transitions = Transitions {
                    action: 1,
                    before: &[0.0],
                    after: &[state],
                };
                model.moments(transitions, &mut mean, &mut sigma).unwrap();
                assert_eq!(mean, [2.0 * state, 0.9]);
            });
        }
    });
}
