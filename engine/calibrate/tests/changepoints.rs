//! Changes of variance found in seeded signals whose changes are known.
//!
//! On the same signals `ruptures` 1.1 (PELT, normal cost, min_size 10, jump 5, penalty 3 ln n)
//! finds the changes of the first two cases to a median of 2 and 3 samples and at most 9, adds two
//! false ones per signal at an outlier, and 1 to 1.5 where the noise is correlated.

#![allow(clippy::unwrap_used)]

use pubs_calibrate::changepoints::{ChangepointError, changepoints, merge_short};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const SEEDS: u64 = 20;

/// Normal noise of sd 1, an AR(1) process with this correlation.
fn noise(seed: u64, count: usize, correlation: f64) -> Vec<f64> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut last = normal();
    let fresh = (1.0 - correlation * correlation).sqrt();
    (0..count)
        .map(|_| {
            last = correlation * last + fresh * normal();
            last
        })
        .collect()
}

/// Regions of (sd, samples) in a row.
struct Case {
    name: &'static str,
    regions: &'static [(f64, usize)],
    correlation: f64,
    change: fn(usize, f64) -> f64,
    /// Median and maximum distance of a found change from the true one, samples.
    median: usize,
    maximum: usize,
    /// True changes without a found one and the other way round, over all seeds.
    missing: usize,
    false_ones: usize,
}

impl Case {
    fn signal(&self, seed: u64) -> (Vec<f64>, Vec<usize>) {
        let count = self.regions.iter().map(|(_, length)| length).sum();
        let mut sigmas = Vec::new();
        let mut changes = Vec::new();
        for &(sigma, length) in self.regions {
            changes.push(sigmas.len());
            sigmas.extend(std::iter::repeat_n(sigma, length));
        }
        let noise = noise(seed, count, self.correlation);
        let plain = noise.iter().zip(sigmas).map(|(noise, sigma)| noise * sigma);
        let signal = plain
            .enumerate()
            .map(|(i, x)| (self.change)(i, x))
            .collect();
        changes.remove(0);
        (signal, changes)
    }

    fn check(&self) {
        let (mut errors, mut missing, mut false_ones) = (Vec::new(), 0, 0);
        for seed in 0..SEEDS {
            let (signal, truth) = self.signal(seed);
            let mut found = changepoints(&signal).unwrap();
            for change in truth {
                let nearest = (0..found.len()).min_by_key(|&i| found[i].abs_diff(change));
                match nearest.filter(|&i| found[i].abs_diff(change) <= 50) {
                    Some(i) => errors.push(found.remove(i).abs_diff(change)),
                    None => missing += 1,
                }
            }
            false_ones += found.len();
        }
        errors.sort_unstable();
        let median = errors.get(errors.len() / 2).copied().unwrap_or_default();
        let maximum = errors.last().copied().unwrap_or_default();
        assert!(
            median <= self.median
                && maximum <= self.maximum
                && missing <= self.missing
                && false_ones <= self.false_ones,
            "{}: median {median}, maximum {maximum}, missing {missing}, false {false_ones}",
            self.name
        );
    }
}

const QUIET_MIDDLE: &[(f64, usize)] = &[(1.0, 333), (0.2, 333), (2.0, 334)];
const LOUD_MIDDLE: &[(f64, usize)] = &[(0.5, 333), (1.5, 333), (0.6, 334)];
const FLAT: &[(f64, usize)] = &[(1.0, 1000)];
const AS_IT_IS: fn(usize, f64) -> f64 = |_, x| x;
const SMALL_AND_SHIFTED: fn(usize, f64) -> f64 = |_, x| 5.0 + 0.01 * x;

const PLAIN: Case = Case {
    name: "plain",
    regions: FLAT,
    correlation: 0.0,
    change: AS_IT_IS,
    median: 3,
    maximum: 15,
    missing: 0,
    false_ones: 0,
};

#[test]
fn regions_of_distinct_variance_are_found() {
    let cases = [
        Case {
            name: "1, 0.2, 2",
            regions: QUIET_MIDDLE,
            ..PLAIN
        },
        Case {
            name: "0.5, 1.5, 0.6",
            regions: LOUD_MIDDLE,
            ..PLAIN
        },
        Case {
            name: "1, 0.2, 2, small and shifted",
            regions: QUIET_MIDDLE,
            change: SMALL_AND_SHIFTED,
            ..PLAIN
        },
        Case {
            name: "0.5, 1.5, 0.6, small and shifted",
            regions: LOUD_MIDDLE,
            change: SMALL_AND_SHIFTED,
            ..PLAIN
        },
        Case {
            name: "a short loud stretch in a long signal",
            regions: &[(1.0, 3000), (3.0, 60), (1.0, 3000)],
            maximum: 30,
            ..PLAIN
        },
        Case {
            name: "more samples than the detector takes",
            regions: &[(1.0, 2000), (0.5, 700), (1.0, 17300)],
            maximum: 25,
            ..PLAIN
        },
        Case {
            name: "a small change",
            regions: &[(1.0, 700), (1.6, 500)],
            median: 15,
            maximum: 50,
            ..PLAIN
        },
        Case {
            name: "silence, then noise",
            regions: &[(1e-12, 800), (1.0, 200)],
            change: |_, x| 1.0 + x,
            maximum: 0,
            ..PLAIN
        },
        Case {
            name: "a jump of the level",
            change: |i, x| x + if i < 500 { 0.0 } else { 3.0 },
            regions: &[(1.0, 500), (1.0, 500)],
            maximum: 3,
            ..PLAIN
        },
        Case {
            name: "correlated noise",
            regions: LOUD_MIDDLE,
            correlation: 0.5,
            maximum: 25,
            ..PLAIN
        },
        Case {
            name: "an outlier",
            regions: LOUD_MIDDLE,
            change: |i, x| if i == 800 { -50.0 } else { x },
            ..PLAIN
        },
        Case {
            name: "an absurd outlier",
            regions: LOUD_MIDDLE,
            change: |i, x| if i == 800 { 1e12 } else { x },
            ..PLAIN
        },
        Case {
            name: "a coarse sensor",
            regions: LOUD_MIDDLE,
            change: |_, x| (x / 0.5).round() * 0.5,
            ..PLAIN
        },
    ];
    for case in cases {
        case.check();
    }
}

#[test]
fn one_region_stays_one() {
    let cases = [
        Case {
            name: "noise",
            ..PLAIN
        },
        Case {
            name: "much noise",
            regions: &[(1.0, 8000)],
            ..PLAIN
        },
        Case {
            name: "little noise",
            regions: &[(1.0, 60)],
            ..PLAIN
        },
        Case {
            name: "an outlier",
            change: |i, x| if i == 400 { 1e3 } else { x },
            ..PLAIN
        },
        Case {
            name: "an impossible sample",
            change: |i, x| if i == 400 { 1e300 } else { x },
            ..PLAIN
        },
        Case {
            name: "outliers in a row",
            change: |i, x| if (400..403).contains(&i) { 10.0 } else { x },
            ..PLAIN
        },
        Case {
            name: "AR(1) 0.5",
            correlation: 0.5,
            ..PLAIN
        },
        Case {
            name: "AR(1) 0.95",
            correlation: 0.95,
            ..PLAIN
        },
        Case {
            name: "a small step of the level",
            change: |i, x| x + if i < 500 { 0.0 } else { 0.5 },
            ..PLAIN
        },
        Case {
            // A slope is for the mean curve; few of them are cut.
            name: "a slope",
            change: |i, x| x + 0.01 * i as f64,
            false_ones: 6,
            ..PLAIN
        },
    ];
    for case in cases {
        case.check();
    }
}

#[test]
fn signals_that_say_nothing_have_no_changes() {
    let third = 1.0 / 3.0;
    let rounding: Vec<f64> = (0..100)
        .map(|i| third + f64::EPSILON * f64::from(i % 2))
        .collect();
    for (name, signal) in [
        ("empty", vec![]),
        ("one sample", vec![1.0]),
        ("two samples", vec![1.0, 2.0]),
        ("nineteen", (0..19).map(f64::from).collect()),
        ("constant", vec![-3.7; 1000]),
        ("zero", vec![0.0; 1000]),
        ("rounding", rounding),
    ] {
        assert_eq!(changepoints(&signal), Ok(vec![]), "{name}");
    }
}

#[test]
fn samples_that_are_not_finite_are_refused() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut signal = noise(1, 100, 0.0);
        signal[37] = value;
        let ChangepointError::NotFinite { index, .. } = changepoints(&signal).unwrap_err();
        assert_eq!(index, 37, "{value}");
    }
}

#[test]
fn short_regions_join_their_shorter_neighbour() {
    let cases: &[(&[usize], usize, usize, &[usize])] = &[
        (&[], 10, 20, &[]),
        (&[10, 20], 100, 10, &[10, 20]),
        // The region 20..25 joins 10..20, which is shorter than 25..100.
        (&[10, 20, 25], 100, 10, &[10, 25]),
        (&[60, 65, 80], 100, 10, &[60, 80]),
        (&[3], 100, 10, &[]),
        (&[97], 100, 10, &[]),
        (&[2, 4, 6, 8], 10, 20, &[]),
        (&[0, 50, 100], 100, 1, &[50]),
    ];
    for &(changes, n, minimum, expected) in cases {
        assert_eq!(
            merge_short(changes, n, minimum),
            expected,
            "{changes:?} of {n}, at least {minimum}"
        );
    }
}
