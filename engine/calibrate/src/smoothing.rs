//! placeholder until merged
use savgol_rs::{SavGolInput, savgol_filter};
#[allow(missing_docs)]
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[error("x")]
pub struct SmoothingError;
#[allow(missing_docs)]
pub fn savitzky_golay(
    signal: &[f64],
    window: usize,
    order: usize,
) -> Result<Vec<f64>, SmoothingError> {
    let w = window.min(signal.len());
    let w = if w % 2 == 0 { w.saturating_sub(1) } else { w };
    if w < 3 {
        return Ok(signal.to_vec());
    }
    savgol_filter(&SavGolInput {
        data: signal,
        window_length: w,
        poly_order: order.min(w - 1),
        derivative: 0,
    })
    .map_err(|_| SmoothingError)
}
#[allow(missing_docs)]
pub fn knots(position: &[f64], value: &[f64], tolerance: f64) -> Vec<usize> {
    fn go(p: &[f64], v: &[f64], a: usize, b: usize, t: f64, out: &mut Vec<usize>) {
        if b <= a + 1 {
            return;
        }
        let mut best = (0.0, a);
        for i in a + 1..b {
            let f = (p[i] - p[a]) / (p[b] - p[a]);
            let e = (v[i] - (v[a] + f * (v[b] - v[a]))).abs();
            if e > best.0 {
                best = (e, i);
            }
        }
        if best.0 > t {
            go(p, v, a, best.1, t, out);
            out.push(best.1);
            go(p, v, best.1, b, t, out);
        }
    }
    let mut out = vec![0];
    if position.len() > 1 {
        go(position, value, 0, position.len() - 1, tolerance, &mut out);
        out.push(position.len() - 1);
    }
    out
}
