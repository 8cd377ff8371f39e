//! The filter against a brute-force posterior on a grid, in double precision.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;
#[path = "common/hump.rs"]
mod hump;

use std::sync::Arc;

use hump::{Hump, entropy_of_places, log_density, mean, story};
use pubs_core::belief::{BeliefError, Filter, Update};
use pubs_core::shield;
use pubs_core::vector::VectorUnit;

#[test]
fn a_belief_that_is_sure_of_a_limit_has_no_entropy() {
    let task = common::door(300);
    let mut filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
    // With W the share of the 300 particles at the limit: (−W ln W + (1 − W) ln 300) / ln 300, for
    // W = 76/300, 285/300 and 1.
    for (displacement, expected) in [(0.5, 0.808), (1.4, 0.059), (0.2, 0.0), (-0.3, 0.0)] {
        filter.follow(displacement);
        let entropy = filter.summary().entropy;
        assert!(
            (entropy - expected).abs() < 0.005,
            "after {displacement} rad: entropy {entropy}, expected about {expected}"
        );
    }
    assert!(filter.summary().entropy < 1e-6, "{:?}", filter.summary());
}

#[test]
fn posterior_agrees_with_a_brute_force_grid() {
    const PARTICLES: usize = 300;
    let task = common::door(PARTICLES);
    for unit in VectorUnit::available() {
        for (grid, gaussian) in [(true, true), (false, true), (false, false)] {
            let mut filter = Filter::on(unit, &task, Arc::new(Hump::new(grid, gaussian)));
            let spacing = 2.0 / (PARTICLES - 1) as f64;
            let mut states: Vec<f64> = (0..PARTICLES).map(|i| i as f64 * spacing).collect();
            let mut logs = vec![0.0_f64; PARTICLES];
            for (step, (displacement, force, moved)) in story().into_iter().enumerate() {
                let update = filter
                    .update(1, displacement, &[force, f32::from(u8::from(moved))])
                    .unwrap();
                assert_eq!(update, Update::Weighed, "step {step} called impossible");
                for (state, log) in states.iter_mut().zip(&mut logs) {
                    let before = *state;
                    *state = (before + displacement).clamp(0.0, 2.0);
                    *log += log_density(before, *state, f64::from(force), moved);
                }
                let max = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let weights: Vec<f64> = logs.iter().map(|log| (log - max).exp()).collect();
                let total: f64 = weights.iter().sum();
                let mean: f64 =
                    weights.iter().zip(&states).map(|(w, s)| w * s).sum::<f64>() / total;
                let entropy = entropy_of_places(&states, &weights) / (PARTICLES as f64).ln();

                let found = filter.summary();
                let case = format!("{unit}, grid {grid}, gaussian {gaussian}, step {step}");
                assert!(
                    (found.mean - mean).abs() < 2e-4,
                    "{case}: mean {}, expected {mean}",
                    found.mean
                );
                assert!(
                    (found.entropy - entropy).abs() < 2e-3,
                    "{case}: entropy {}, expected {entropy}",
                    found.entropy
                );
            }
        }
    }
}

#[test]
fn first_update_agrees_with_bayes_by_hand() {
    // Two particles, at 0.5 and 1.5; blocked: p(m_p = 0) is 0.02 at both, so force alone decides.
    let mut task = common::door(2);
    task.joint.start = (0.5, 1.5);
    let mut filter = Filter::new(&task, Arc::new(Hump::new(false, true)));
    filter.update(1, 0.0, &[4.0, 0.0]).unwrap();
    // mean(0.5) = 12·e^-0.5 + 1 = 8.2784, sigma 0.7: z = -6.1120; mean(1.5) = 3 (hump 1e-26), sigma 0.9: z = 1.1111
    let ratio =
        ((-0.5 * 6.1120_f64.powi(2)).exp() / 0.7) / ((-0.5 * 1.1111_f64.powi(2)).exp() / 0.9);
    let expected = 0.5 * ratio / (1.0 + ratio) + 1.5 / (1.0 + ratio);
    assert!(
        (filter.summary().mean - expected).abs() < 1e-5,
        "{} is not {expected}",
        filter.summary().mean
    );
}

#[test]
fn impossible_observations_start_the_belief_afresh_and_then_fail_by_name() {
    let task = common::door(300);
    let mut filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
    for _ in 0..5 {
        filter.update(1, 0.0, &[mean(0.4) as f32, 1.0]).unwrap();
    }
    assert!(
        (filter.summary().mean - 0.4).abs() < 0.05,
        "not localised: {:?}",
        filter.summary()
    );
    // 0.5 N is found near the closed limit only, 20 sigma from where the belief is.
    let update = filter.update(1, 0.0, &[0.5, 1.0]).unwrap();
    assert!(
        matches!(update, Update::Recovered(recovery) if recovery.in_a_row == 1),
        "{update:?}"
    );
    let still_there =
        filter.flattened_mass_above(0.35, 1.0) - filter.flattened_mass_above(0.45, 1.0);
    assert!(
        still_there < 0.01,
        "{still_there} of the belief still where the force rules it out"
    );
    assert!(
        filter.summary().entropy > 0.5,
        "sure after a contradiction: {:?}",
        filter.summary()
    );

    let error = (0..20)
        .find_map(|_| filter.update(1, 0.0, &[500.0, 1.0]).err())
        .expect("500 N for ever is a fault");
    assert!(matches!(error, BeliefError::Impossible { .. }));
    let text = error.to_string();
    for part in ["f_d = 500.000", "m_p = 1.000", "safe_open", "in a row"] {
        assert!(text.contains(part), "`{part}` is missing in: {text}");
    }
    assert!(filter.summary().mean.is_finite(), "{:?}", filter.summary());
}

#[test]
fn what_is_not_finite_is_refused_and_changes_nothing() {
    let task = common::door(300);
    let mut filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
    filter.update(1, 0.01, &[2.0, 1.0]).unwrap();
    let before = (
        filter.summary(),
        filter.states().to_vec(),
        filter.log_weights().to_vec(),
    );
    for (displacement, observation) in [
        (0.0, [f32::NAN, 1.0]),
        (0.0, [f32::INFINITY, 1.0]),
        (f64::NAN, [1.0, 1.0]),
    ] {
        let error = filter
            .update(1, displacement, &observation)
            .expect_err("must be refused");
        assert!(matches!(error, BeliefError::NotFinite { .. }), "{error}");
    }
    assert_eq!(
        before,
        (
            filter.summary(),
            filter.states().to_vec(),
            filter.log_weights().to_vec()
        )
    );
}

#[test]
fn reading_spacing_counts_one_force_per_travel_or_reversal() {
    let mut task = common::door(300);
    task.belief.reading_spacing = 0.05;
    let mut filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
    let entropy_after = |filter: &mut Filter, displacement| {
        filter.update(1, displacement, &[8.0, 1.0]).unwrap();
        filter.summary().entropy
    };
    let first = entropy_after(&mut filter, 0.01);
    let resting: Vec<f64> = (0..30).map(|_| entropy_after(&mut filter, 0.0)).collect();
    let drop = first - resting[29];
    // m_p still counts: it rules out the blocked tenth of the range, and nothing more.
    assert!(
        drop < 0.03,
        "a handle at rest gained information: entropy fell by {drop}"
    );
    let reversed = entropy_after(&mut filter, -0.01);
    assert!(
        reversed < resting[29] - 0.01,
        "a reversal did not count: {reversed} after {}",
        resting[29]
    );
}

#[test]
fn shield_masks_high_force_near_its_limit_only() {
    let task = common::door(300);
    let mut allowed = [true; 5];
    let cases = [
        (0, [true, true, true, false, false], "knowing nothing"),
        (6, [true, true, true, true, true], "well inside"),
    ];
    for (updates, expected, name) in cases {
        let mut filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
        for _ in 0..updates * 10 {
            filter.update(1, 0.0, &[mean(0.4) as f32, 1.0]).unwrap();
        }
        shield::allowed(Some(&task.policy.shield), &task, &filter, &mut allowed);
        assert_eq!(allowed, expected, "{name}: {:?}", filter.summary());
    }
    let filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
    shield::allowed(None, &task, &filter, &mut allowed);
    assert_eq!(allowed, [true; 5], "without a shield everything is allowed");
}

#[test]
fn the_shield_leaves_a_margin_for_what_the_handle_may_be_ahead() {
    let task = common::door(300);
    // Two filter periods at 0.15 m/s and 30 Hz, and 15 N on 5000 N/m: 10 + 3 mm of arc.
    let margin = 0.013 * task.joint.per_metre();
    assert!((shield::margin(&task) - margin).abs() < 1e-12);
    // A limit gathers all particles: the belief is sure, and then the handle comes away from it.
    let high_close = 4;
    let reach = 0.03 + margin;
    for (away, allowed_there) in [(0.02, false), (0.99 * reach, false), (1.01 * reach, true)] {
        let mut filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
        filter.follow(-5.0);
        filter.follow(away);
        let mut allowed = [true; 5];
        shield::allowed(Some(&task.policy.shield), &task, &filter, &mut allowed);
        let mean = filter.summary().mean;
        assert_eq!(
            allowed[high_close], allowed_there,
            "{away} away, mean {mean}"
        );
        assert!(allowed[..high_close].iter().all(|&allowed| allowed));
    }
}

#[test]
fn the_interval_holds_its_mass() {
    let task = common::door(300);
    let filter = Filter::new(&task, Arc::new(Hump::new(true, true)));
    let (from, to) = filter.interval(0.9);
    assert!(
        (from - 0.1).abs() < 0.01 && (to - 1.9).abs() < 0.01,
        "90 % of [0, 2] is not [{from}, {to}]"
    );
}
