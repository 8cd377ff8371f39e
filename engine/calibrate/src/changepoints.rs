//! placeholder until merged
use changepoint::{BocpdLike, BocpdTruncated, rv::dist::NormalInvGamma, utils::map_changepoints};
#[allow(missing_docs)]
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[error("x")]
pub struct ChangepointError;
#[allow(missing_docs)]
pub fn changepoints(signal: &[f64]) -> Result<Vec<usize>, ChangepointError> {
    let mut s = signal.to_vec();
    s.sort_by(f64::total_cmp);
    let med = s[s.len() / 2];
    let mut d: Vec<f64> = signal.iter().map(|x| (x - med).abs()).collect();
    d.sort_by(f64::total_cmp);
    let mad = (1.4826 * d[d.len() / 2]).max(1e-9);
    let mut cpd = BocpdTruncated::new(250.0, NormalInvGamma::new_unchecked(0.0, 1.0, 1.0, 1.0));
    let r: Vec<Vec<f64>> = signal
        .iter()
        .map(|x| cpd.step(&((x - med) / mad)).to_vec())
        .collect();
    Ok(map_changepoints(&r)
        .into_iter()
        .filter(|&i| i > 0)
        .collect())
}
