//! The grid against single look-ups, and the vector units against the portable loops.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::*;
use pubs_plugin::{GridTransitions, ObservationModel, Support};
use pubs_segments::{Segments, VectorUnit};

fn available() -> impl Iterator<Item = VectorUnit> {
    VectorUnit::ALL
        .into_iter()
        .filter(|unit| unit.is_available())
}

fn model(particles: u32, unit: VectorUnit) -> Segments {
    Segments::create(&slide_setup(particles))
        .unwrap()
        .with_vector_unit(unit)
}

/// Grids that lie inside, stick out at either end or both, or miss the range, with moves both ways.
fn grids(particles: usize) -> Vec<GridTransitions> {
    let spacing = 0.4 / particles as f32;
    let firsts = [
        0.0,
        0.5,
        0.999,
        3.3,
        17.71,
        -0.25,
        -1.0,
        -40.125,
        0.9 * particles as f32,
        -2.0 * particles as f32,
        3.0 * particles as f32,
    ];
    let moves = [0.0, 0.37, 6.0, -0.21, -11.93];
    let counts = [1, 7, 8, 19, particles];
    let grid = |(first, step, count): (f32, f32, usize)| GridTransitions {
        action: 1,
        before: first * spacing,
        after: (first + step) * spacing,
        spacing,
        count,
    };
    let all = firsts.into_iter().flat_map(|first| {
        moves
            .into_iter()
            .flat_map(move |step| counts.map(|count| (first, step, count)))
    });
    all.map(grid).collect()
}

#[test]
fn a_grid_gives_what_single_look_ups_give() {
    for unit in available() {
        for particles in [7, 60, 299, 300, 2100, 3000] {
            let model = model(particles, unit);
            for grid in grids(particles as usize) {
                let states = |first: f32| -> Vec<f32> {
                    (0..grid.count)
                        .map(|i| (f64::from(first) + i as f64 * f64::from(grid.spacing)) as f32)
                        .collect()
                };
                let expected =
                    moments(&model, 1, &states(grid.before), &states(grid.after)).unwrap();
                let found = moments_grid(&model, grid).unwrap();
                assert_close(
                    &found.0,
                    &expected.0,
                    &format!("{unit:?}, mean of {particles} particles, {grid:?}"),
                );
                assert_close(
                    &found.1,
                    &expected.1,
                    &format!("{unit:?}, sigma of {particles} particles, {grid:?}"),
                );
            }
        }
    }
}

/// The steepest change, 3 N at a jump over one node of 0.2 mm, makes a rounding of f32 states
/// (3e-8 m) visible as 4.5e-4 N.
fn assert_close(found: &[f32], expected: &[f32], place: &str) {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let bound = 1e-3 * (1.0 + expected.abs());
        assert!(
            (found - expected).abs() < bound,
            "{place}, entry {i}: {found} for {expected}"
        );
    }
}

#[test]
fn away_from_jumps_a_grid_is_as_exact_as_the_definition() {
    let model = model(300, VectorUnit::best());
    let spacing = 0.4 / 300.0;
    let grid = GridTransitions {
        action: 1,
        before: 0.3001,
        after: 0.1601,
        spacing,
        count: 60,
    };
    let (mean, sigma) = moments_grid(&model, grid).unwrap();
    for i in 0..60 {
        let after = f64::from(grid.after) + i as f64 * 0.4 / 300.0;
        let (expected_mean, expected_sigma) = slide_by_hand(after);
        assert!(
            (f64::from(mean[i]) - expected_mean[F_D]).abs() < 1e-5,
            "mean at {after}: {}",
            mean[i]
        );
        assert!(
            (f64::from(sigma[i]) - expected_sigma[F_D]).abs() < 1e-5,
            "sigma at {after}: {}",
            sigma[i]
        );
        assert_eq!(mean[M_P * 60 + i], 0.98, "m_p is read before the move");
    }
}

#[test]
fn another_spacing_is_left_to_single_look_ups() {
    let model = model(300, VectorUnit::best());
    let spacing = 0.4 / 300.0;
    for (factor, given) in [
        (1.0, true),
        (1.000_005, true),
        (0.999, false),
        (2.0, false),
        (0.0, false),
        (f32::NAN, false),
    ] {
        let grid = GridTransitions {
            action: 1,
            before: 0.0,
            after: 0.0,
            spacing: factor * spacing,
            count: 3,
        };
        assert_eq!(
            moments_grid(&model, grid).is_some(),
            given,
            "spacing times {factor}"
        );
    }
}

#[test]
fn a_grid_refuses_what_single_look_ups_refuse() {
    let model = model(300, VectorUnit::best());
    let good = GridTransitions {
        action: 1,
        before: 0.1,
        after: 0.1,
        spacing: 0.4 / 300.0,
        count: 2,
    };
    let cases = [
        (GridTransitions { action: 9, ..good }, 8, "action 9"),
        (
            GridTransitions {
                before: f32::NAN,
                ..good
            },
            8,
            "NaN",
        ),
        (
            GridTransitions {
                after: f32::NAN,
                ..good
            },
            8,
            "NaN",
        ),
        (good, 7, "room for 7 means"),
    ];
    for (grid, room, words) in cases {
        let error = model
            .moments_grid(grid, &mut vec![0.0; room], &mut [0.0; 8])
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{error}");
    }
    let none = GridTransitions { count: 0, ..good };
    assert_eq!(
        model.moments_grid(none, &mut [], &mut []).unwrap(),
        Support::Given
    );
}

#[test]
fn all_vector_units_give_the_same_bits() {
    for particles in [300, 3000] {
        let reference = model(particles, VectorUnit::Portable);
        for unit in available() {
            let model = model(particles, unit);
            for grid in grids(particles as usize) {
                assert_eq!(
                    moments_grid(&model, grid),
                    moments_grid(&reference, grid),
                    "{unit:?}, {grid:?}"
                );
            }
            for count in [1, 7, 8, 9, 16, 300, 301] {
                let states: Vec<f32> = (0..count)
                    .map(|i| (i as f32 * 0.618_034).fract() * 0.5 - 0.05)
                    .collect();
                let after: Vec<f32> = states.iter().rev().copied().collect();
                assert_eq!(
                    moments(&model, 1, &states, &after),
                    moments(&reference, 1, &states, &after),
                    "{unit:?}, N = {count}"
                );
            }
        }
    }
}
