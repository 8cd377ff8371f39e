//! Drift of simulated recordings whose deviation from the model is known.

#![allow(clippy::unwrap_used)]

use pubs_calibrate::drift::{Cause, Drift, Sample, drift};
use pubs_calibrate::object_text::StateUnit;
use pubs_calibrate::stored::Stored;
use pubs_calibrate::{Channel, Segment, Values};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const RANGE_DEG: f64 = 125.0;

/// Steps of a recording: a safe crossing of a door at 30 readings a second.
const READINGS: usize = 420;

fn segment(channel: Channel, from: f64, to: f64, values: Values) -> Segment {
    Segment {
        action: "a".to_owned(),
        channel,
        from: from.to_radians(),
        to: to.to_radians(),
        values,
        note: None,
    }
}

fn curve(channel: Channel, points: &[(f64, f64)], sigma: f64) -> Segment {
    let from = points.first().unwrap().0;
    let to = points.last().unwrap().0;
    let values = Values::Force {
        position: points.iter().map(|point| point.0.to_radians()).collect(),
        mean_n: points.iter().map(|point| point.1).collect(),
        sigma_n: vec![sigma],
    };
    segment(channel, from, to, values)
}

/// A door with a catch, a closing spring and friction; a side force that hardly changes; m_p.
fn model() -> Vec<Segment> {
    let moves =
        |from, to, probability| segment(Channel::Moves, from, to, Values::Moves { probability });
    vec![
        curve(
            Channel::Along,
            &[(0.0, 16.0), (1.0, 16.0), (2.0, 14.0), (4.0, 7.0)],
            1.5,
        ),
        curve(
            Channel::Along,
            &[(4.0, 7.0), (8.0, 6.4), (13.0, 5.6), (25.0, 2.5)],
            0.5,
        ),
        curve(
            Channel::Along,
            &[(25.0, 2.5), (60.0, 1.4), (90.0, 2.0), (123.0, 1.3)],
            0.5,
        ),
        curve(Channel::Along, &[(123.0, 1.3), (125.0, 15.0)], 3.0),
        curve(Channel::Up, &[(0.0, 1.8), (70.0, 0.9), (125.0, 1.1)], 0.35),
        curve(Channel::Normal, &[(0.0, 0.0), (125.0, 0.0)], 0.35),
        moves(0.0, 2.0, 0.02),
        moves(2.0, 124.0, 0.98),
        moves(124.0, 125.0, 0.3),
    ]
}

/// How the world differs from the model.
#[derive(Clone, Copy)]
struct World {
    offset_n: f64,
    gain: f64,
    shift_deg: f64,
    noise: f64,
    /// Added between 30 and 50 degrees, N.
    spring_n: f64,
    /// Every hundredth reading is this much off, N.
    outlier_n: f64,
}

const SAME: World = World {
    offset_n: 0.0,
    gain: 1.0,
    shift_deg: 0.0,
    noise: 1.0,
    spring_n: 0.0,
    outlier_n: 0.0,
};

/// Crossings with a bias of 0.3 sigma each and AR(1) noise, correlation 0.7.
fn recording(world: World, channel: Channel, seed: u64, demonstrations: u32) -> Vec<Sample> {
    let model = model();
    let stored = Stored::of(&model, "a", channel).unwrap();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut samples = Vec::new();
    for demonstration in 1..=demonstrations {
        let bias = 0.3 * normal(&mut rng);
        let mut correlated = normal(&mut rng);
        for reading in 0..READINGS {
            let part = (reading as f64 + rng.random_range(0.0..1.0)) / READINGS as f64;
            let degrees = RANGE_DEG * part;
            let (mean, sigma) = stored.moments((degrees - world.shift_deg).to_radians());
            correlated = 0.7 * correlated + (1.0f64 - 0.49).sqrt() * normal(&mut rng);
            let spring = if (30.0..50.0).contains(&degrees) {
                world.spring_n
            } else {
                0.0
            };
            let outlier = if reading % 100 == 50 {
                world.outlier_n
            } else {
                0.0
            };
            let value = world.offset_n
                + world.gain * (mean + spring)
                + outlier
                + sigma * (bias + world.noise * correlated);
            let state = degrees.to_radians();
            samples.push(Sample {
                state,
                value,
                demonstration,
            });
        }
    }
    samples
}

fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(rng)
}

fn checked(world: World, channel: Channel, seed: u64, demonstrations: u32) -> Drift {
    let samples = recording(world, channel, seed, demonstrations);
    drift(&model(), "a", channel, &samples, StateUnit::Degrees)
}

#[test]
fn a_recording_of_the_same_world_holds() {
    for channel in Channel::FORCES {
        for demonstrations in [1, 5] {
            let mut alarms = Vec::new();
            for seed in 0..500 {
                let drift = checked(SAME, channel, seed, demonstrations);
                if drift.holds != Some(true) {
                    alarms.push(drift.verdict);
                }
            }
            assert!(
                alarms.len() < 5,
                "{channel:?}, {demonstrations} demonstrations: {} of 500: {alarms:#?}",
                alarms.len()
            );
        }
    }
}

#[test]
fn what_has_changed_is_found_and_named() {
    use Cause::{Gain, Noise, Offset, Region, Shift};
    use Channel::{Along, Normal, Up};
    let cases = [
        (
            Along,
            World {
                offset_n: 2.0,
                ..SAME
            },
            Offset,
            "above",
        ),
        (
            Along,
            World {
                offset_n: -2.0,
                ..SAME
            },
            Offset,
            "below",
        ),
        (
            Up,
            World {
                offset_n: 2.0,
                ..SAME
            },
            Offset,
            "above",
        ),
        (
            Normal,
            World {
                offset_n: -0.8,
                ..SAME
            },
            Offset,
            "tare",
        ),
        (Along, World { gain: 1.3, ..SAME }, Gain, "stored mean"),
        (Along, World { gain: 0.6, ..SAME }, Gain, "stored mean"),
        (
            Along,
            World {
                shift_deg: 3.0,
                ..SAME
            },
            Shift,
            "towards open",
        ),
        (
            Along,
            World {
                shift_deg: -3.0,
                ..SAME
            },
            Shift,
            "towards closed",
        ),
        (Along, World { noise: 2.0, ..SAME }, Noise, "residuals"),
        (Up, World { noise: 2.0, ..SAME }, Noise, "loose"),
        (
            Along,
            World {
                spring_n: 2.5,
                ..SAME
            },
            Region,
            "is stored",
        ),
    ];
    for (channel, world, cause, word) in cases {
        for demonstrations in [2, 5] {
            let mut found = Vec::new();
            for seed in 0..50 {
                let drift = checked(world, channel, seed, demonstrations);
                let named = drift.cause == Some(cause) && drift.verdict.contains(word);
                if drift.holds != Some(false) || !named {
                    found.push(drift.verdict);
                }
            }
            assert!(
                found.len() <= 1,
                "{cause:?} {channel:?}, {demonstrations} demonstrations: missed {}: {found:#?}",
                found.len()
            );
        }
    }
}

#[test]
fn figures_are_true_within_their_errors() {
    let world = |offset_n, gain, shift_deg| World {
        offset_n,
        gain,
        shift_deg,
        ..SAME
    };
    for (name, world, truth) in [
        ("offset", world(2.0, 1.0, 0.0), 2.0),
        ("gain", world(0.0, 1.3, 0.0), 1.3),
        ("shift", world(0.0, 1.0, 3.0), 3f64.to_radians()),
        ("no shift", SAME, 0.0),
    ] {
        let (mut inside, mut sum) = (0, 0.0);
        for seed in 0..100 {
            let drift = checked(world, Channel::Along, seed, 5);
            let found = match name {
                "offset" => drift.offset_n,
                "gain" => drift.gain,
                _ => drift.shift,
            }
            .unwrap();
            inside += usize::from((found.value - truth).abs() < 2.0 * found.sd);
            sum += found.value;
        }
        // 95 % if errors were normal and their size known; errors are meant to be on the safe side.
        assert!(
            inside >= 90,
            "{name}: {inside} of 100 within two standard errors"
        );
        let off = (sum / 100.0 - truth).abs();
        assert!(
            off < 0.02 * truth.abs().max(1.0),
            "{name}: {} on average",
            sum / 100.0
        );
    }
}

#[test]
fn what_a_channel_cannot_tell_is_left_out() {
    let flat = checked(SAME, Channel::Normal, 1, 5);
    assert_eq!(
        (flat.shift, flat.gain),
        (None, None),
        "a mean of 0 tells neither"
    );
    let gentle = checked(SAME, Channel::Up, 1, 5);
    assert!(
        gentle.shift.is_none() && gentle.gain.is_some(),
        "{gentle:?}"
    );
    assert!(checked(SAME, Channel::Along, 1, 5).shift.is_some());
}

#[test]
fn outliers_do_not_hide_the_cause() {
    let world = World {
        outlier_n: 8.0,
        shift_deg: 3.0,
        ..SAME
    };
    for seed in 0..50 {
        let drift = checked(world, Channel::Along, seed, 5);
        assert_eq!(drift.cause, Some(Cause::Shift), "{}", drift.verdict);
        let off = drift.shift.unwrap().value.to_degrees() - 3.0;
        assert!(off.abs() < 1.0, "{}", drift.verdict);
    }
}

#[test]
fn too_little_is_not_judged() {
    let model = model();
    let samples = recording(
        World {
            offset_n: 50.0,
            ..SAME
        },
        Channel::Up,
        1,
        2,
    );
    let judged = |samples: &[Sample], action: &str| {
        drift(&model, action, Channel::Up, samples, StateUnit::Degrees)
    };
    for (samples, action, word) in [
        (&samples[..0], "a", "too few samples"),
        (&samples[..29], "a", "too few samples"),
        (&samples[..], "b", "no segment"),
    ] {
        let drift = judged(samples, action);
        assert_eq!(
            (drift.holds, drift.cause),
            (None, None),
            "{}",
            drift.verdict
        );
        assert!(drift.verdict.contains(word), "{}", drift.verdict);
    }
    // 1.3 sigma off, once: a grasp may do that.
    let once = recording(
        World {
            offset_n: 0.45,
            ..SAME
        },
        Channel::Up,
        1,
        1,
    );
    let once = judged(&once, "a");
    assert_eq!(once.holds, None, "{}", once.verdict);
    assert!(
        once.verdict.starts_with("too few demonstrations"),
        "{}",
        once.verdict
    );
    let mut gaps = samples.clone();
    gaps[3].value = f64::NAN;
    gaps[4].state = f64::INFINITY;
    let drift = judged(&gaps, "a");
    assert_eq!(
        (drift.samples, drift.holds),
        (samples.len() - 2, Some(false)),
        "{}",
        drift.verdict
    );
}

/// Crossings in which the handle moves with these probabilities; `sticky` is the chance that a
/// reading repeats the one before.
fn crossings(moves: [f64; 3], sticky: f64, seed: u64, demonstrations: u32) -> Vec<Sample> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut samples = Vec::new();
    for demonstration in 1..=demonstrations {
        let mut last = None;
        for reading in 0..READINGS {
            let degrees = RANGE_DEG * (reading as f64 + 0.5) / READINGS as f64;
            let region = usize::from(degrees >= 2.0) + usize::from(degrees >= 124.0);
            let fresh = rng.random_range(0.0..1.0) < moves[region];
            let repeats = rng.random_range(0.0..1.0) < sticky;
            let moved = last.filter(|&(own, _)| own == region && repeats);
            let moved = moved.map_or(fresh, |(_, moved)| moved);
            last = Some((region, moved));
            let value = if moved { 1.0 } else { 0.0 };
            samples.push(Sample {
                state: degrees.to_radians(),
                value,
                demonstration,
            });
        }
    }
    samples
}

#[test]
fn a_handle_that_moves_more_or_less_often_is_found() {
    let judged = |moves, seed, demonstrations| {
        let samples = crossings(moves, 0.8, seed, demonstrations);
        drift(&model(), "a", Channel::Moves, &samples, StateUnit::Degrees)
    };
    for demonstrations in [1, 5] {
        let alarms = (0..500)
            .filter(|&seed| judged([0.02, 0.98, 0.3], seed, demonstrations).holds == Some(false))
            .count();
        assert!(
            alarms < 5,
            "{demonstrations} demonstrations: {alarms} false alarms of 500"
        );
    }
    // The catch is gone; something blocks.
    for (moves, at) in [
        ([0.98, 0.98, 0.3], "between 0.0 and 2.0"),
        ([0.02, 0.5, 0.3], "between"),
    ] {
        for seed in 0..50 {
            let drift = judged(moves, seed, 5);
            assert_eq!(drift.cause, Some(Cause::Moves), "{}", drift.verdict);
            assert!(drift.verdict.contains(at), "{}", drift.verdict);
        }
    }
}
