//! Each kernel on each unit of this machine against the same thing in `f64`.

use pubs_core::vector::{LANES, VectorUnit};
use rand::RngExt;

use crate::kernels::gates::{Cells, PANEL, open_gates};
use crate::kernels::matrix::{Left, Shape, Start, multiply, padded};
use crate::kernels::sum::sum_of_squares;
use crate::kernels::tanh::{apply_tanh, backward_tanh};
use crate::kernels::transpose::transpose;

fn random(count: usize, name: &str) -> Vec<f32> {
    let mut generator = crate::rng::stream(7, name);
    (0..count)
        .map(|_| generator.random_range(-1.0..1.0))
        .collect()
}

#[test]
fn tanh_matches_f64_over_a_dense_range() {
    const POINTS: usize = 200_003;
    for unit in VectorUnit::available() {
        for end in [12.0, 1e-3] {
            let at = |i: usize| (end * (2.0 * i as f64 / (POINTS - 1) as f64 - 1.0)) as f32;
            let mut values: Vec<f32> = (0..POINTS).map(at).collect();
            apply_tanh(unit, &mut values);
            for (i, value) in values.iter().enumerate() {
                let expected = f64::from(at(i)).tanh();
                let error = (f64::from(*value) - expected).abs();
                assert!(
                    error <= 4e-7 * expected.abs(),
                    "{unit}: tanh({}) = {value}, not {expected}",
                    at(i)
                );
            }
        }
    }
}

#[test]
fn tanh_saturates_and_keeps_nan() {
    for unit in VectorUnit::available() {
        let mut values = [f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::NAN];
        apply_tanh(unit, &mut values);
        for (value, expected) in values.iter().zip([1.0, -1.0, 1.0]) {
            assert!((value - expected).abs() < 4e-7, "{unit}: {values:?}");
        }
        assert!(values[3].is_nan(), "{unit}: tanh NaN = {}", values[3]);
    }
}

#[test]
fn products_match_f64() {
    // Rows that fill tiles and rows that do not; every width of panel.
    for (rows, depth, columns) in [
        (64, 64, 64),
        (1, 3, 64),
        (5, 64, 128),
        (13, 17, 16),
        (8, 1, 48),
        (31, 70, 112),
    ] {
        let shape = Shape {
            rows,
            depth,
            columns,
        };
        let (a, b) = (random(rows * depth, "a"), random(depth * columns, "b"));
        let (first, before) = (random(columns, "first"), random(rows * columns, "before"));
        let a_columns: Vec<f32> = (0..rows * depth)
            .map(|i| a[(i % rows) * depth + i / rows])
            .collect();
        let exact = |m: usize, n: usize, start: f32| {
            let product = |k| f64::from(a[m * depth + k]) * f64::from(b[k * columns + n]);
            f64::from(start) + (0..depth).map(product).sum::<f64>()
        };
        for unit in VectorUnit::available() {
            for left in [
                Left::Rows {
                    values: &a,
                    stride: depth,
                },
                Left::Columns {
                    values: &a_columns,
                    stride: rows,
                },
            ] {
                for start in [Start::Zero, Start::Row(&first), Start::Sum] {
                    let mut c = before.clone();
                    multiply(unit, shape, left, &b, start, &mut c);
                    for (i, value) in c.iter().enumerate() {
                        let (m, n) = (i / columns, i % columns);
                        let expected = match start {
                            Start::Zero => exact(m, n, 0.0),
                            Start::Row(row) => exact(m, n, row[n]),
                            Start::Sum => exact(m, n, before[i]),
                        };
                        assert!(
                            (f64::from(*value) - expected).abs() < 1e-5,
                            "{unit} {rows}x{depth}x{columns}: c[{m}][{n}] = {value}, not {expected}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn transposes_of_any_height() {
    for (rows, columns) in [(64, 64), (5, 64), (1, 16), (16, 32), (20, 48)] {
        let matrix = random(rows * columns, "matrix");
        let stride = padded(rows);
        for unit in VectorUnit::available() {
            let mut transposed = vec![f32::NAN; columns * stride];
            transpose(unit, rows, columns, &matrix, &mut transposed);
            for (i, value) in transposed.iter().enumerate() {
                let (c, r) = (i / stride, i % stride);
                let expected = if r < rows {
                    matrix[r * columns + c]
                } else {
                    0.0
                };
                assert_eq!(
                    *value, expected,
                    "{unit} {rows}x{columns}: row {r}, column {c}"
                );
            }
        }
    }
}

#[test]
fn tanh_gradients_and_their_sums() {
    let (samples, width) = (5, 2 * LANES);
    let outputs = random(samples * width, "outputs");
    let gradients = random(samples * width, "gradients");
    for unit in VectorUnit::available() {
        let (mut found, mut sums) = (gradients.clone(), vec![1.0; width]);
        backward_tanh(unit, &outputs, &mut found, &mut sums);
        for i in 0..samples * width {
            let expected = gradients[i] * (1.0 - outputs[i] * outputs[i]);
            assert!(
                (found[i] - expected).abs() < 1e-6,
                "{unit}: {i}: {} {expected}",
                found[i]
            );
        }
        for (column, sum) in sums.iter().enumerate() {
            let expected: f32 = (0..samples).map(|s| found[s * width + column]).sum();
            assert!(
                (sum - 1.0 - expected).abs() < 1e-5,
                "{unit}: column {column}"
            );
        }
    }
}

#[test]
fn squares_are_summed_to_the_last() {
    let values: Vec<f32> = (1..=131).map(|i| i as f32).collect();
    for unit in VectorUnit::available() {
        let mut sum = 0.0;
        sum_of_squares(unit, &values, &mut sum);
        // n (n + 1) (2n + 1) / 6 for n = 131.
        assert_eq!(sum, 757_966.0, "{unit}");
    }
}

/// One row and group whose four gates, one after the other, run over a wide range.
#[test]
fn gates_match_f64_from_end_to_end() {
    const POINTS: usize = 2001;
    let at = |i: usize| 40.0 * i as f32 / (POINTS - 1) as f32 - 20.0;
    let sigmoid = |x: f64| 1.0 / (1.0 + (-x).exp());
    for unit in VectorUnit::available() {
        for gate in 0..4 {
            for i in 0..POINTS {
                let mut sums = [0.5, -0.4, 0.9, 0.7];
                sums[gate] = at(i);
                let mut gates: Vec<f32> = (0..PANEL).map(|n| sums[n / LANES]).collect();
                let [mut cell, mut cell_tanh, mut hidden] = [[0.0; LANES]; 3];
                let cells = Cells {
                    cell: &mut cell,
                    cell_tanh: &mut cell_tanh,
                    hidden: &mut hidden,
                };
                open_gates(unit, LANES, &mut gates, &[0.6; LANES], cells);
                let [input, forget, candidate, output] = sums.map(f64::from);
                let c = sigmoid(forget) * f64::from(0.6_f32) + sigmoid(input) * candidate.tanh();
                let expected = sigmoid(output) * c.tanh();
                for h in hidden {
                    assert!(
                        (f64::from(h) - expected).abs() < 4e-7,
                        "{unit}: h = {h}, not {expected}, with gates {sums:?}"
                    );
                }
            }
        }
    }
}
