//! The filter against scipy 1.x, the knots by hand.

#![allow(clippy::unwrap_used)]

use pubs_calibrate::smoothing::{SmoothingError, knots, savitzky_golay};

const DIGITS_OF_PI: [f64; 11] = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0, 5.0, 3.0, 5.0];

#[test]
fn the_filter_agrees_with_scipy() {
    // scipy.signal.savgol_filter(x, window, order, mode="interp")
    let cases: &[(usize, usize, [f64; 11])] = &[
        (
            5,
            2,
            [
                2.8571428571428585,
                1.971428571428571,
                1.9428571428571413,
                2.7142857142857113,
                5.34285714285714,
                6.171428571428568,
                5.257142857142854,
                4.285714285714283,
                4.914285714285711,
                4.857142857142851,
                4.085714285714278,
            ],
        ),
        (
            7,
            3,
            [
                3.380952380952363,
                0.9047619047619024,
                1.6190476190476217,
                3.85714285714286,
                4.714285714285718,
                5.142857142857147,
                6.000000000000004,
                4.761904761904766,
                4.000000000000002,
                3.857142857142862,
                4.833333333333345,
            ],
        ),
        (
            11,
            5,
            [
                2.9318181818181905,
                1.5909090909090888,
                2.1276223776223793,
                3.4755244755244887,
                4.82517482517485,
                5.643356643356979,
                5.692307692307728,
                5.048951048951093,
                4.124125874125909,
                3.681818181818208,
                4.858391608391621,
            ],
        ),
        (
            9,
            4,
            [
                3.0473970473970717,
                1.3329448329448328,
                2.099844599844594,
                3.6993006993006907,
                5.03496503496504,
                5.433566433566444,
                6.055944055944064,
                5.361305361305359,
                4.03146853146854,
                3.28321678321682,
                5.0536130536132,
            ],
        ),
        (
            3,
            0,
            [
                2.666666666666667,
                2.666666666666667,
                2.0,
                3.333333333333334,
                5.000000000000001,
                5.333333333333334,
                5.666666666666668,
                4.333333333333334,
                4.666666666666668,
                4.333333333333334,
                4.333333333333334,
            ],
        ),
        (
            3,
            1,
            [
                2.1666666666666665,
                2.6666666666666674,
                2.0000000000000004,
                3.3333333333333344,
                5.000000000000002,
                5.333333333333334,
                5.666666666666669,
                4.333333333333334,
                4.666666666666668,
                4.333333333333334,
                4.333333333333333,
            ],
        ),
        (1, 0, DIGITS_OF_PI),
    ];
    for &(window, order, expected) in cases {
        let smooth = savitzky_golay(&DIGITS_OF_PI, window, order).unwrap();
        assert_near(
            &smooth,
            &expected,
            1e-9,
            &format!("window {window}, order {order}"),
        );
    }
}

#[test]
fn wide_windows_agree_with_scipy_too() {
    let signal: Vec<f64> = (0..300)
        .map(f64::from)
        .map(|i| 10.0 * (0.05 * i).sin() + 0.3 * (2.1 * i).cos() + 0.01 * i)
        .collect();
    // The same, at samples 0, 3, 100, 150, 260 and 299.
    let cases = [
        (
            51,
            3,
            [
                -0.11894921561186708,
                1.5462016801018896,
                -8.506136751889462,
                10.798308313221256,
                6.766096727782097,
                9.717845243447428,
            ],
        ),
        (
            101,
            5,
            [
                0.1738735866675978,
                1.5462108471380585,
                -8.523764295161934,
                10.81675434219847,
                6.7961032865627065,
                9.918630568619022,
            ],
        ),
        (
            201,
            3,
            [
                13.227893917006593,
                11.909804353661366,
                -0.3104223704777107,
                2.7815495656069835,
                0.41519514454112105,
                23.157257895828153,
            ],
        ),
        (
            299,
            3,
            [
                6.2043962605304195,
                6.039473581968152,
                0.7821436183141159,
                -0.5581088231543951,
                5.373125994558942,
                11.611659445185891,
            ],
        ),
    ];
    for (window, order, expected) in cases {
        let smooth = savitzky_golay(&signal, window, order).unwrap();
        let some = [0, 3, 100, 150, 260, 299].map(|i| smooth[i]);
        assert_near(
            &some,
            &expected,
            1e-6,
            &format!("window {window}, order {order}"),
        );
    }
}

#[test]
fn a_signal_shorter_than_the_window_gets_a_shorter_window() {
    let x = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0];
    let cases: &[(&[f64], usize, usize, usize)] = &[
        // signal, window and order asked for, window used; 1 leaves the signal alone
        (&x, 31, 2, 5),
        (&x[..5], 31, 2, 5),
        (&x[..4], 31, 1, 3),
        (&x[..3], 31, 2, 1),
        (&x[..2], 31, 2, 1),
        (&x[..1], 31, 2, 1),
        (&[], 31, 2, 1),
    ];
    for &(signal, window, order, used) in cases {
        let expected = if used == 1 {
            signal.to_vec()
        } else {
            savitzky_golay(signal, used, order).unwrap()
        };
        assert_eq!(
            savitzky_golay(signal, window, order).unwrap(),
            expected,
            "{signal:?}"
        );
    }
}

#[test]
fn what_the_filter_cannot_do_is_refused() {
    let x = [1.0; 20];
    let mut gap = x;
    gap[7] = f64::NAN;
    let cases = [
        (savitzky_golay(&x, 0, 0), SmoothingError::EvenWindow(0)),
        (savitzky_golay(&x, 4, 2), SmoothingError::EvenWindow(4)),
        (
            savitzky_golay(&x, 5, 5),
            SmoothingError::OrderTooHigh {
                order: 5,
                window: 5,
            },
        ),
        (savitzky_golay(&x, 9, 6), SmoothingError::Unsound(6)),
    ];
    for (found, expected) in cases {
        assert_eq!(found, Err(expected));
    }
    let fault = savitzky_golay(&gap, 5, 2).unwrap_err();
    assert!(
        matches!(fault, SmoothingError::NotFinite { index: 7, .. }),
        "{fault}"
    );
}

#[test]
fn knots_are_the_points_a_curve_needs() {
    /// Positions, values, tolerance and the knots expected.
    type Case = (&'static [f64], &'static [f64], f64, &'static [usize]);
    let cases: &[Case] = &[
        (&[], &[], 0.1, &[]),
        (&[1.0], &[5.0], 0.1, &[0]),
        (&[1.0, 2.0], &[5.0, 6.0], 0.1, &[0, 1]),
        // On a line, also where the points are unevenly spaced.
        (&[0.0, 1.0, 4.0, 5.0], &[0.0, 2.0, 8.0, 10.0], 0.1, &[0, 3]),
        // A corner.
        (
            &[0.0, 1.0, 2.0, 3.0, 4.0],
            &[0.0, 0.0, 0.0, 1.0, 2.0],
            0.1,
            &[0, 2, 4],
        ),
        // The chord misses the middle by 1 exactly: within the tolerance, or not.
        (&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], 1.0, &[0, 2]),
        (&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], 0.99, &[0, 1, 2]),
        // The largest miss (4 at index 3) comes first; then 0..3 misses 1 by 1.33, 3..5 nothing.
        (
            &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            &[0.0, 0.0, 2.7, 4.0, 2.0, 0.0],
            1.0,
            &[0, 1, 3, 5],
        ),
        // A noise below the tolerance vanishes.
        (
            &[0.0, 1.0, 2.0, 3.0, 4.0],
            &[0.0, 0.05, -0.05, 0.05, 0.0],
            0.1,
            &[0, 4],
        ),
    ];
    for &(position, value, tolerance, expected) in cases {
        assert_eq!(
            knots(position, value, tolerance),
            expected,
            "{value:?} within {tolerance}"
        );
    }
}

#[test]
fn no_point_is_missed_by_more_than_the_tolerance() {
    let position: Vec<f64> = (0..2000).map(|i| f64::from(i) * 0.01).collect();
    let value: Vec<f64> = position
        .iter()
        .map(|x| 16.0 * (-x).exp() + x.sin())
        .collect();
    let kept = knots(&position, &value, 0.05);
    assert!(kept.len() < 50, "{} knots", kept.len());
    for pair in kept.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for i in a..=b {
            let part = (position[i] - position[a]) / (position[b] - position[a]);
            let miss = (value[a] + part * (value[b] - value[a]) - value[i]).abs();
            assert!(miss <= 0.05 + 1e-12, "{miss} at {i}");
        }
    }
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let miss = (found - expected).abs();
        assert!(
            miss <= tolerance,
            "{what}: {found} is not {expected} at {i}"
        );
    }
}
