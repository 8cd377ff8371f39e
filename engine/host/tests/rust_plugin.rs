//! Plugins written in Rust, loaded as shared libraries: a model that is not Gaussian and a driver.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{create, driver_setup, load, model_setup, rust_library};
use pubs_host::conformance::{self, ConformanceReport, Outcome};
use pubs_host::{DriverInstance, DriverPlugin, HostError, PluginKind};
use pubs_plugin::{CheckState, DriverStatus, Support, Transitions, Twist};
use serde_json::{Value, json};

fn first_failure(report: &ConformanceReport) -> Option<&'static str> {
    report
        .checks
        .iter()
        .find(|check| check.outcome == Outcome::Failed)
        .map(|check| check.name)
}

#[test]
fn a_model_that_is_not_gaussian_answers() {
    let model = create(&rust_library("rust_model"), json!({ "sigma": 0.25 })).unwrap();
    assert!(!model.is_gaussian());
    let transitions = Transitions {
        action: 1,
        before: &[0.0],
        after: &[0.5],
    };
    let mut log_likelihood = [0.0];
    let support = model
        .log_likelihood(transitions, &[1.5], &mut log_likelihood)
        .unwrap();
    assert_eq!(support, Support::Given);
    // On top of one peak, eight sigma off the other: ln(1 / (2 · 0.25 · √2π)).
    let expected = -(0.5 * std::f32::consts::TAU.sqrt()).ln();
    assert!(
        (log_likelihood[0] - expected).abs() < 1e-5,
        "{} is not {expected}",
        log_likelihood[0]
    );
}

#[test]
fn a_broken_model_is_refused_with_its_own_words() {
    let library = rust_library("rust_model");
    let cases = [
        ("create", "function `create`: no spring fits this door"),
        (
            "panic in create",
            "the plugin broke down (a fault in its own code): the spring of create broke",
        ),
        (
            "panic in moments",
            "function `moments`, 257 states of action 0 (`stop`): the plugin broke down",
        ),
        (
            "NaN likelihood",
            "function `log_likelihood`, 257 states of action 1 (`safe_open`): NaN at state",
        ),
        ("no sample", "function `sample`"),
    ];
    for (fault, words) in cases {
        let result = create(&library, json!({ "sigma": 0.25, "fault": fault }));
        let text = result
            .err()
            .unwrap_or_else(|| panic!("{fault} was taken"))
            .to_string();
        assert!(
            text.contains(words),
            "{fault}: `{text}` should hold `{words}`"
        );
    }
}

#[test]
fn the_kit_integrates_a_density() {
    let plugin = load(&rust_library("rust_model"));
    let check = |fault: &str| {
        let setup = model_setup("two-peaks", json!({ "sigma": 0.4, "fault": fault }));
        conformance::check(&plugin, Some(&setup), None)
    };
    let good = check("");
    assert!(good.passed(), "{good:#?}");
    for fault in ["not a density", "other samples"] {
        let report = check(fault);
        assert_eq!(
            first_failure(&report),
            Some("density"),
            "{fault}: {report:#?}"
        );
    }
}

fn pen(fault: &str) -> Result<DriverInstance, HostError> {
    let plugin = DriverPlugin::new(load(&rust_library("rust_driver"))).unwrap();
    plugin.open(&driver_setup("pen", json!({ "fault": fault })))
}

#[test]
fn a_driver_moves_in_virtual_time() {
    let mut pen = pen("").unwrap();
    assert_eq!((pen.sensor(), pen.has_virtual_time()), ("pen-sensor", true));
    assert_eq!(pen.plugin().kind(), PluginKind::Driver);
    let twist = Twist {
        linear_m_s: [0.0, 0.0, 0.05],
        angular_rad_s: [0.0; 3],
    };
    pen.command(twist, 100_000_000).unwrap();
    pen.advance_to(1_000_000_000).unwrap();
    let reading = pen.read().unwrap();
    assert_eq!(
        (reading.time_ns, reading.status),
        (1_000_000_000, DriverStatus::Stopped)
    );
    // 0.05 m/s for 0.1 s, with ramps of 10 ms at either end.
    assert!((reading.position_m[2] - 0.005).abs() < 1e-4, "{reading:?}");
    assert_eq!(pen.truth().unwrap(), Some(reading.position_m[2]));
    let past = pen.advance_to(1).unwrap_err().to_string();
    assert!(
        past.contains("plugin `pen`, function `advance_to`: 1 ns lies before"),
        "{past}"
    );
    let wrong = pen
        .command(
            Twist {
                linear_m_s: [f64::NAN; 3],
                ..twist
            },
            0,
        )
        .unwrap_err()
        .to_string();
    assert!(wrong.contains("not finite"), "{wrong}");
    pen.tare().unwrap();
    pen.stop().unwrap();
    pen.close().unwrap();
}

#[test]
fn a_broken_driver_is_told_by_its_field() {
    let text = |result: Result<(), HostError>| result.unwrap_err().to_string();
    assert!(
        pen("open")
            .unwrap_err()
            .to_string()
            .contains("no pen answers at 10.0.0.1")
    );
    assert!(text(pen("orientation").unwrap().read().map(drop)).contains("orientation_xyzw"));
    assert!(text(pen("force").unwrap().read().map(drop)).contains("force_n"));
    assert!(text(pen("truth").unwrap().truth().map(drop)).contains("the true state is NaN"));
    let mut broken = pen("panic in command").unwrap();
    assert!(text(broken.command(Twist::default(), 0)).contains("the pen broke"));
    broken.stop().unwrap();
}

#[test]
fn the_kit_finds_a_driver_that_never_stops() {
    let plugin = load(&rust_library("rust_driver"));
    let check =
        |params: Value| conformance::check(&plugin, None, Some(&driver_setup("pen", params)));
    let good = check(json!({}));
    assert!(good.passed(), "{good:#?}");
    assert!(
        good.checks
            .iter()
            .all(|check| check.outcome == Outcome::Passed),
        "{good:#?}"
    );
    let cases = [
        ("no expiry", "expiry"),
        ("force", "read"),
        ("open", "open"),
        ("no cure", "diagnose"),
    ];
    for (fault, name) in cases {
        let report = check(json!({ "fault": fault }));
        assert_eq!(first_failure(&report), Some(name), "{fault}: {report:#?}");
    }
}

#[test]
fn a_drivers_diagnosis_is_read() {
    let plugin = DriverPlugin::new(load(&rust_library("rust_driver"))).unwrap();
    let setup = driver_setup("pen", json!({}));
    let checks = plugin.diagnose(&setup).unwrap().unwrap();
    let found: Vec<_> = checks
        .iter()
        .map(|check| (check.name.as_str(), check.state, check.cure.as_str()))
        .collect();
    assert_eq!(
        found,
        [
            ("paper", CheckState::Ok, ""),
            ("ink", CheckState::Fault, "fill it")
        ]
    );
    let unknown = driver_setup("pen", json!({ "nib": 3 }));
    let refused = plugin.diagnose(&unknown).unwrap_err().to_string();
    assert!(refused.contains("`nib`"), "{refused}");
}
