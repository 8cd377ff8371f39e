//! Bounds against values that are known otherwise.

mod problems;

use std::ops::ControlFlow;
use std::time::Duration;

use pubs_solve::belief;
use pubs_solve::{
    Method, Pomdp, Progress, Solution, SolveOptions, Stopped, TrialOptions, parse, simulate, solve,
};

fn solved(pomdp: &Pomdp, precision: f64, seconds: u64) -> (Solution, Vec<Progress>) {
    let options = SolveOptions {
        precision,
        timeout: Some(Duration::from_secs(seconds)),
        report_interval: Duration::ZERO,
        ..SolveOptions::default()
    };
    let mut heard = Vec::new();
    let solution = solve(pomdp, &options, |progress| {
        heard.push(*progress);
        ControlFlow::Continue(())
    });
    (solution, heard)
}

/// Tiger with another discount.
fn tiger(discount: f64) -> Pomdp {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/tiger.pomdp");
    let text = std::fs::read_to_string(path).expect("the file is part of the crate");
    parse(&text.replace("discount: 0.95", &format!("discount: {discount}"))).expect("it is valid")
}

#[test]
fn tiger_has_its_known_value() {
    // 19.3711 to 19.3721 by the authors' solver.
    let (solution, _) = solved(&problems::file("tiger"), 1e-3, 20);
    assert_eq!(solution.stopped, Stopped::Precision);
    assert!(solution.gap() <= 1e-3, "{}", solution.gap());
    assert!(
        solution.lower < 19.3721 + 1e-4 && solution.upper > 19.3711 - 1e-4,
        "{} to {}",
        solution.lower,
        solution.upper
    );
}

#[test]
fn a_problem_without_observations_is_worth_the_best_blind_action() {
    let (solution, _) = solved(&problems::file("two_state"), 1e-6, 20);
    assert!((solution.lower - 1.0).abs() < 1e-6, "{}", solution.lower);
    assert!((solution.upper - 1.0).abs() < 2e-6, "{}", solution.upper);
    assert_eq!(solution.policy.choose(&[0.75, 0.25]), 1);
    assert_eq!(solution.policy.choose(&[0.25, 0.75]), 2);
}

/// The best that can be had in `horizon` steps: every action, every observation.
fn expectimax(pomdp: &Pomdp, at: &[f64], horizon: usize) -> f64 {
    if horizon == 0 {
        return 0.0;
    }
    let value = |action: usize| {
        let weights = at.iter().enumerate();
        let now: f64 = weights
            .map(|(state, weight)| weight * pomdp.reward(action, state))
            .sum();
        let observations = 0..pomdp.observations().len();
        let outcomes = observations.filter_map(|seen| belief::update(pomdp, at, action, seen));
        let later: f64 = outcomes
            .map(|(next, probability)| probability * expectimax(pomdp, &next, horizon - 1))
            .sum();
        now + pomdp.discount() * later
    };
    (0..pomdp.actions().len())
        .map(value)
        .fold(f64::MIN, f64::max)
}

#[test]
fn bounds_hold_what_trying_every_plan_finds() {
    for discount in [0.3, 0.5] {
        let pomdp = tiger(discount);
        let horizon = 7;
        let found = expectimax(&pomdp, pomdp.start(), horizon);
        let rest = discount.powi(horizon as i32) / (1.0 - discount);
        let (least, most) = (found - 100.0 * rest, found + 10.0 * rest);
        let (solution, _) = solved(&pomdp, 1e-6, 20);
        assert!(
            solution.lower <= most && solution.upper >= least,
            "discount {discount}: {} to {} against {least} to {most}",
            solution.lower,
            solution.upper
        );
    }
}

/// Value iteration over the weight of the first of two states, on a grid, between whose points
/// the value is interpolated: from above, for the value is convex.
fn on_a_grid(pomdp: &Pomdp, points: usize) -> Vec<f64> {
    let mut values = vec![0.0; points];
    let weight = |point: usize| point as f64 / (points - 1) as f64;
    let interpolate = |values: &[f64], weight: f64| {
        let place = weight * (points - 1) as f64;
        let below = (place as usize).min(points - 2);
        let share = place - below as f64;
        values[below] * (1.0 - share) + values[below + 1] * share
    };
    for _ in 0..600 {
        let backed_up = |point: usize| {
            let at = [weight(point), 1.0 - weight(point)];
            let value = |action: usize| {
                let now = at[0] * pomdp.reward(action, 0) + at[1] * pomdp.reward(action, 1);
                let observations = 0..pomdp.observations().len();
                let outcomes =
                    observations.filter_map(|seen| belief::update(pomdp, &at, action, seen));
                let later: f64 = outcomes
                    .map(|(next, probability)| probability * interpolate(&values, next[0]))
                    .sum();
                now + pomdp.discount() * later
            };
            (0..pomdp.actions().len())
                .map(value)
                .fold(f64::MIN, f64::max)
        };
        values = (0..points).map(backed_up).collect();
    }
    values
}

#[test]
fn bounds_agree_with_value_iteration_on_a_grid() {
    let pomdp = tiger(0.95);
    let points = 1001;
    let grid = on_a_grid(&pomdp, points);
    for place in [0, 100, 250, 400, 500, 700, 930] {
        let weight = place as f64 / (points - 1) as f64;
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/tiger.pomdp");
        let text = std::fs::read_to_string(path).expect("the file is part of the crate");
        let start = format!("start: {weight} {}", 1.0 - weight);
        let pomdp = parse(&text.replace("start: uniform", &start)).expect("it is valid");
        let (solution, _) = solved(&pomdp, 1e-4, 20);
        assert!(
            solution.lower <= grid[place] + 1e-6,
            "{weight}: {} {}",
            solution.lower,
            grid[place]
        );
        // The grid's error, measured against ten times as many points, is below 0.02.
        assert!(
            solution.upper >= grid[place] - 0.02,
            "{weight}: {} {}",
            solution.upper,
            grid[place]
        );
    }
}

#[test]
fn bounds_never_cross_and_never_go_back() {
    for pomdp in [
        tiger(0.95),
        problems::file("hallway"),
        problems::rock_sample(3, &[(0, 0), (1, 2), (2, 1)]),
        problems::sim_object(25),
    ] {
        let (_, heard) = solved(&pomdp, 1e-3, 2);
        assert!(heard.len() >= 2);
        for pair in heard.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            assert!(after.lower >= before.lower - 1e-9, "{before:?} {after:?}");
            assert!(after.upper <= before.upper + 1e-9, "{before:?} {after:?}");
            assert!(after.lower <= after.upper + 1e-9, "{after:?}");
        }
    }
}

#[test]
fn a_policy_earns_what_its_bounds_say() {
    let rock_sample = problems::rock_sample(4, &[(0, 0), (1, 3), (2, 1), (3, 2)]);
    for (pomdp, precision, seconds) in [
        (tiger(0.95), 1e-3, 5),
        (rock_sample, 1e-3, 10),
        (problems::file("hallway"), 1e-3, 2),
        // Stopped early: what a plan goes on with must be in the policy, pruned or not.
        (problems::sim_object(25), 0.05, 30),
        (problems::sim_object(25), 0.02, 30),
    ] {
        let (solution, _) = solved(&pomdp, precision, seconds);
        let options = TrialOptions {
            trials: 1500,
            max_steps: 250,
            seed: 7,
        };
        let earned = simulate(&pomdp, &solution.policy, &options).discounted;
        let slack = 4.0 * earned.standard_error;
        assert!(
            earned.mean >= solution.lower - slack && earned.mean <= solution.upper + slack,
            "{}: {earned:?} for {} to {}",
            pomdp.name(),
            solution.lower,
            solution.upper
        );
    }
}

#[test]
fn hallway_passes_the_bounds_of_its_authors_solver() {
    // 0.9718 and 1.2192 after ten seconds; a busy machine gets as long.
    let options = SolveOptions {
        timeout: Some(Duration::from_secs(10)),
        report_interval: Duration::ZERO,
        ..SolveOptions::default()
    };
    let solution = solve(&problems::file("hallway"), &options, |progress| {
        if progress.lower >= 0.9718 && progress.upper <= 1.2192 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(solution.lower >= 0.9718, "{}", solution.lower);
    assert!(solution.upper <= 1.2192, "{}", solution.upper);
    assert!(
        solution.upper > 1.0,
        "{} is below what a policy earns",
        solution.upper
    );
}

#[test]
fn light_dark_passes_the_bounds_of_the_ancestor() {
    // 67.03 and 89.49 after 28.5 seconds of processor time.
    let options = SolveOptions {
        timeout: Some(Duration::from_secs(28)),
        report_interval: Duration::ZERO,
        ..SolveOptions::default()
    };
    let pomdp = problems::light_dark();
    let solution = solve(&pomdp, &options, |progress| {
        if progress.lower >= 71.0 && progress.upper <= 89.49 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(solution.lower >= 67.03, "{}", solution.lower);
    assert!(solution.upper <= 89.49, "{}", solution.upper);
    let options = TrialOptions {
        trials: 2000,
        max_steps: 250,
        seed: 3,
    };
    let earned = simulate(&pomdp, &solution.policy, &options);
    assert!(earned.reward.mean > 86.0, "{:?}", earned.reward);
    assert_eq!(earned.ended, 2000, "a trial did not stop");
}

#[test]
fn qmdp_promises_at_least_the_optimum() {
    let options = SolveOptions {
        method: Method::Qmdp,
        precision: 1e-6,
        ..SolveOptions::default()
    };
    let solution = solve(&tiger(0.95), &options, |_| ControlFlow::Continue(()));
    // Seen after one step, the tiger is avoided for ever: 10 each time, and 20 steps' worth of it.
    let each = 10.0 / (1.0 - 0.95);
    assert!(
        (solution.upper - (-1.0 + 0.95 * each)).abs() < 1e-4,
        "{}",
        solution.upper
    );
    assert!((solution.lower + 20.0).abs() < 1e-4, "{}", solution.lower);
    assert_eq!(solution.alpha_vectors, 3);
}

#[test]
fn a_report_can_end_it_and_the_timeout_does() {
    let pomdp = problems::file("hallway");
    let options = SolveOptions {
        precision: 1e-9,
        ..SolveOptions::default()
    };
    let solution = solve(&pomdp, &options, |_| ControlFlow::Break(()));
    assert_eq!(solution.stopped, Stopped::Asked);
    assert!(!solution.policy.alpha_vectors().is_empty());
    let (solution, _) = solved(&pomdp, 1e-9, 1);
    assert_eq!(solution.stopped, Stopped::Timeout);
    assert!(solution.time_s < 5.0, "{}", solution.time_s);
}
