//! The continuous mean within a segment, §III-C.1: the Savitzky–Golay filter, and the few knots of
//! it that a file needs.

use savgol_rs::{SavGolInput, savgol_filter};

/// The filter sums powers of the sample number as they are, and high ones lose digits: relative to
/// the signal, the error is below 1e-7 for windows of 101, and below 1e-4 at the ends for windows
/// of 299 with order 5; at order 9 the ends are wrong in the first digit.
pub const HIGHEST_ORDER: usize = 5;

/// Why a signal cannot be smoothed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SmoothingError {
    /// A window has a middle.
    #[error("the window is {0} samples wide; it must be an odd number")]
    EvenWindow(usize),
    /// A polynomial through all samples of a window smooths nothing.
    #[error("order {order} needs a window of more than {order} samples, and it has {window}")]
    OrderTooHigh {
        /// Order of the polynomial.
        order: usize,
        /// Samples of the window.
        window: usize,
    },
    /// Above [`HIGHEST_ORDER`].
    #[error("order {0} is numerically unsound; {HIGHEST_ORDER} is the highest")]
    Unsound(usize),
    /// One such sample would spoil a window.
    #[error("sample {index} is {value}; smoothing needs finite numbers")]
    NotFinite {
        /// Place in the signal, from 0.
        index: usize,
        /// What is there.
        value: f64,
    },
    /// The filter gave up.
    #[error("the Savitzky–Golay filter failed: {0}")]
    Filter(String),
}

/// Each sample of `signal` (evenly spaced) replaced by the value there of the polynomial of `order`
/// that fits the `window` samples around it best; the half windows at both ends take the polynomial
/// of the outermost whole window (as `scipy.signal.savgol_filter` with `mode="interp"`).
///
/// A signal shorter than the window gets the largest odd window it can hold; where the polynomial
/// would then pass through all of its samples, the signal comes back as it is.
///
/// # Errors
/// For an even window, an order that is not below the window or above [`HIGHEST_ORDER`], and a
/// sample that is not finite.
pub fn savitzky_golay(
    signal: &[f64],
    window: usize,
    order: usize,
) -> Result<Vec<f64>, SmoothingError> {
    if window.is_multiple_of(2) {
        return Err(SmoothingError::EvenWindow(window));
    }
    if order >= window {
        return Err(SmoothingError::OrderTooHigh { order, window });
    }
    if order > HIGHEST_ORDER {
        return Err(SmoothingError::Unsound(order));
    }
    if let Some(index) = signal.iter().position(|value| !value.is_finite()) {
        let value = signal[index];
        return Err(SmoothingError::NotFinite { index, value });
    }
    let window_length = window.min(largest_odd(signal.len()));
    if order + 1 >= window_length {
        return Ok(signal.to_vec());
    }
    savgol_filter(&SavGolInput {
        data: signal,
        window_length,
        poly_order: order,
        derivative: 0,
    })
    .map_err(SmoothingError::Filter)
}

/// At most `count`; 0 for 0.
fn largest_odd(count: usize) -> usize {
    count - usize::from(count.is_multiple_of(2) && count > 0)
}

/// Indices of the points that a curve needs, increasing, the first and last among them: linear
/// between them, it misses no `value` by more than `tolerance`. Each stretch that misses one is
/// parted at the point it misses most (Ramer, Douglas and Peucker, measured along the value).
/// `position` is strictly increasing and as long as `value`.
pub fn knots(position: &[f64], value: &[f64], tolerance: f64) -> Vec<usize> {
    let Some(last) = position.len().min(value.len()).checked_sub(1) else {
        return Vec::new();
    };
    let mut kept = vec![0];
    let mut ends = vec![last];
    let mut from = 0;
    while let Some(&to) = ends.last() {
        match farthest(position, value, from, to).filter(|(_, miss)| *miss > tolerance) {
            Some((between, _)) => ends.push(between),
            None => {
                ends.pop();
                if to > from {
                    kept.push(to);
                }
                from = to;
            }
        }
    }
    kept
}

/// The point between `from` and `to` that their chord misses most, and by how much.
fn farthest(position: &[f64], value: &[f64], from: usize, to: usize) -> Option<(usize, f64)> {
    let slope = (value[to] - value[from]) / (position[to] - position[from]);
    let miss = |i: usize| (value[from] + slope * (position[i] - position[from]) - value[i]).abs();
    (from + 1..to)
        .map(|i| (i, miss(i)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
}
