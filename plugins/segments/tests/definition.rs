//! The tables against eq. (11) worked out by hand.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::*;
use pubs_plugin::{ChannelKind, JointType, ObservationModel};
use pubs_segments::Segments;
use serde_json::{Value, json};

#[test]
fn channels_are_the_papers_in_order() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    let found: Vec<_> = model
        .channels()
        .iter()
        .map(|c| (c.name.as_str(), c.kind))
        .collect();
    let gaussian = ChannelKind::Gaussian;
    assert_eq!(
        found,
        [
            ("f_d", gaussian),
            ("f_z", gaussian),
            ("f_n", gaussian),
            ("m_p", ChannelKind::Bernoulli)
        ]
    );
}

/// Where the definition bends or jumps; a table may differ within a node distance of these.
const KNOTS: [f64; 6] = [0.1, 0.15, 0.2, 0.2998, 0.3, 0.4];

#[test]
fn tables_follow_the_segments_and_are_exact_away_from_knots() {
    for particles in [7, 299, 300, 3000, 30_000] {
        let model = Segments::create(&slide_setup(particles)).unwrap();
        let node = 0.4 / 2000.0_f64.max(f64::from(particles));
        let states: Vec<f32> = (0..=40_000).map(|i| i as f32 * 1e-5).collect();
        for (&state, found) in states.iter().zip(at_each(&model, &states)) {
            let state = f64::from(state);
            if KNOTS.iter().any(|knot| (state - knot).abs() < 1.001 * node) {
                continue;
            }
            let (mean, sigma) = slide_by_hand(state);
            for (lane, expected) in mean.into_iter().chain(sigma).enumerate() {
                let error = (f64::from(found[lane]) - expected).abs();
                assert!(
                    error < 3e-6 * (1.0 + expected.abs()),
                    "{particles} particles, lane {lane} at {state}: {} for {expected}",
                    found[lane]
                );
            }
        }
    }
}

#[test]
fn a_bend_costs_a_quarter_node_and_a_jump_stays_between_its_sides() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    let node = 0.4 / 2000.0;
    for i in -200..=200 {
        let offset = f64::from(i) * 1e-6;
        let bend = at_each(&model, &[(0.1 + offset) as f32])[0][F_D];
        let error = (f64::from(bend) - slide_by_hand(0.1 + offset).0[F_D]).abs();
        assert!(
            error < 60.0 * node / 4.0 + 1e-4,
            "{error} N off at the bend + {offset}"
        );
        let jump = at_each(&model, &[(0.15 + offset) as f32])[0][F_D];
        assert!(
            (2.0..=5.02).contains(&jump),
            "{jump} N at the jump + {offset}"
        );
    }
    assert_eq!(at_each(&model, &[0.15 - 2.0 * node as f32])[0][F_D], 2.0);
}

#[test]
fn beyond_the_limits_the_nearest_limit_answers() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    let found = at_each(&model, &[-5.0, 0.0, 0.4, 77.0, f32::INFINITY]);
    assert_eq!(found[0], found[1]);
    assert_eq!(found[3], found[2]);
    assert_eq!(found[4], found[2]);
    assert_eq!((found[1][F_D], found[2][F_D]), (8.0, 15.0));
}

#[test]
fn forces_are_predicted_after_the_move_and_motion_before_it() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    // One alone, and among enough others for the vector loop.
    for count in [1, 8, 11] {
        let (mean, sigma) = moments(&model, 1, &vec![0.25; count], &vec![0.05; count]).unwrap();
        for i in 0..count {
            let found = [F_D, F_Z, F_N, M_P].map(|c| mean[c * count + i]);
            let expected = [5.0, 1.0, -2.0, 0.25];
            let close = found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(
                close,
                "{i} of {count}: mean {found:?}, expected {expected:?}"
            );
            assert_eq!(
                [F_D, F_Z, F_N].map(|c| sigma[c * count + i]),
                [0.5, 0.25, 0.125]
            );
        }
    }
}

#[test]
fn the_probability_of_motion_never_reaches_0_or_1() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    // 0.29981 m is the last node (of 2100) before the jump at 0.3 m; without a floor it has 0.00095.
    for (state, expected) in [(0.05, 0.999), (0.299_809_5, 0.001), (0.35, 0.98)] {
        let found = at_each(&model, &[state])[0][M_P];
        assert!(
            (found - expected).abs() < 4e-5,
            "m_p at {state}: {found}, expected {expected}"
        );
    }
    let states: Vec<f32> = (0..=40_000).map(|i| i as f32 * 1e-5).collect();
    assert!(
        at_each(&model, &states)
            .iter()
            .all(|at| (0.001..=0.999).contains(&at[M_P]))
    );
}

#[test]
fn positions_are_in_the_unit_of_the_joint() {
    let whole = |suffix: &str, upper: f64| -> Vec<Value> {
        let mut segments: Vec<Value> = ["f_d", "f_z", "f_n"]
            .iter()
            .map(|c| json!({ "channel": c, "mean_n": [0.0, upper], "sigma_n": 1.0 }))
            .collect();
        segments.push(json!({ "channel": "m_p", "probability": [0.25, 0.75] }));
        for segment in &mut segments {
            segment["action"] = json!("open");
            segment[format!("from{suffix}")] = json!(0.0);
            segment[format!("to{suffix}")] = json!(upper);
            segment[format!("position{suffix}")] = json!([0.0, upper]);
        }
        segments
    };
    // Type, suffix, upper limit as written and in SI.
    let cases = [
        (
            JointType::Revolute,
            "_deg",
            90.0,
            std::f64::consts::FRAC_PI_2,
        ),
        (JointType::Prismatic, "_m", 0.5, 0.5),
        (JointType::Abstract, "", 60.0, 60.0),
    ];
    for (r#type, suffix, written, si) in cases {
        let model =
            Segments::create(&setup(joint(r#type, 0.0, si), 300, whole(suffix, written))).unwrap();
        let found = at_each(&model, &[(si / 3.0) as f32])[0];
        assert!(
            (f64::from(found[F_D]) - written / 3.0).abs() < 1e-5 * written,
            "{type:?}: {}",
            found[F_D]
        );
        assert!(
            (found[M_P] - (0.25 + 0.5 / 3.0)).abs() < 1e-5,
            "{type:?}: {}",
            found[M_P]
        );
    }
}

#[test]
fn a_stop_needs_no_segments_and_says_next_to_nothing() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    let (mean, sigma) = moments(&model, 0, &[0.1, 0.2], &[0.1, 0.2]).unwrap();
    assert_eq!(mean, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.001, 0.001]);
    assert_eq!(sigma, [100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 1.0, 1.0]);
}

#[test]
fn wrong_arguments_are_named() {
    let model = Segments::create(&slide_setup(300)).unwrap();
    let long = vec![0.1; 20];
    let mut late_nan = long.clone();
    late_nan[3] = f32::NAN;
    let cases: [(usize, &[f32], &[f32], &str); 6] = [
        (5, &[0.1], &[0.1], "action 5 of an object with 2 actions"),
        (1, &[0.1, 0.2], &[0.1], "2 states before and 1 after"),
        (1, &[f32::NAN], &[0.1], "NaN"),
        (1, &[0.1], &[f32::NAN], "NaN"),
        (1, &late_nan, &long, "NaN"),
        (1, &long, &late_nan, "NaN"),
    ];
    for (action, before, after, words) in cases {
        let error = moments(&model, action, before, after)
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{error}");
    }
    assert_eq!(moments(&model, 1, &[], &[]).unwrap(), (vec![], vec![]));
}
