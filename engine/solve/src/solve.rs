//! What a solver is asked, what it says on its way, and what it gives back.

use std::fmt;
use std::ops::ControlFlow;
use std::str::FromStr;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::policy::{AlphaPolicy, AlphaVector};
use crate::pomdp::Pomdp;
use crate::{blind, qmdp, sarsop};

/// How a POMDP is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Value iteration as if the state were seen after one action.
    Qmdp,
    /// Point-based value iteration near optimally reachable beliefs.
    Sarsop,
}

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Qmdp => "qmdp",
            Self::Sarsop => "sarsop",
        })
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "qmdp" => Ok(Self::Qmdp),
            "sarsop" => Ok(Self::Sarsop),
            _ => Err(format!("no solver is called `{text}`: qmdp or sarsop")),
        }
    }
}

/// When to stop.
#[derive(Clone, Debug)]
pub struct SolveOptions {
    /// Which solver.
    pub method: Method,
    /// Stop where the bounds at the initial belief are this close, in units of reward. For QMDP,
    /// how far its values may be from their limit.
    pub precision: f64,
    /// Stop after this much time by the clock on the wall.
    pub timeout: Option<Duration>,
    /// How much time passes between two reports.
    pub report_interval: Duration,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            method: Method::Sarsop,
            precision: 1e-3,
            timeout: None,
            report_interval: Duration::from_millis(500),
        }
    }
}

/// How far a solver has come.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// Seconds since it began.
    pub time_s: f64,
    /// The lower bound on the value of the initial belief.
    pub lower: f64,
    /// The upper bound.
    pub upper: f64,
    /// The upper less the lower bound.
    pub gap: f64,
    /// How many alpha vectors make the lower bound.
    pub alpha_vectors: usize,
    /// How many beliefs were sampled.
    pub beliefs: usize,
    /// How many times a path of beliefs was sampled.
    pub trials: usize,
}

/// Why a solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stopped {
    /// The precision was reached.
    Precision,
    /// The time was up.
    Timeout,
    /// The caller's report asked for it.
    Asked,
}

/// What a solver gives back.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The policy, with its bounds.
    pub policy: AlphaPolicy,
    /// The lower bound on the value of the initial belief.
    pub lower: f64,
    /// The upper bound.
    pub upper: f64,
    /// How many alpha vectors the policy has.
    pub alpha_vectors: usize,
    /// Seconds it took by the clock on the wall.
    pub time_s: f64,
    /// How many beliefs were sampled.
    pub beliefs: usize,
    /// How many times a path of beliefs was sampled.
    pub trials: usize,
    /// Why it stopped.
    pub stopped: Stopped,
}

impl Solution {
    /// The upper less the lower bound.
    pub fn gap(&self) -> f64 {
        self.upper - self.lower
    }
}

/// Solves a POMDP. `report` hears how it goes, at the start, at each interval and at the end;
/// `Break` stops the solver with the best policy so far.
pub fn solve(
    pomdp: &Pomdp,
    options: &SolveOptions,
    report: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Solution {
    match options.method {
        Method::Qmdp => solve_qmdp(pomdp, options, report),
        Method::Sarsop => sarsop::solve(pomdp, options, report),
    }
}

fn solve_qmdp(
    pomdp: &Pomdp,
    options: &SolveOptions,
    mut report: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Solution {
    let begun = Instant::now();
    let deadline = options.timeout.map(|timeout| begun + timeout);
    let q = qmdp::q_values(pomdp, options.precision, deadline);
    let stopped = if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
        Stopped::Timeout
    } else {
        Stopped::Precision
    };
    // QMDP's own vectors promise too much: what is sure is the best single action.
    let blind = blind::blind_values(pomdp, options.precision, deadline);
    let value = |vectors: &[Vec<f64>]| {
        let values = vectors.iter().map(|vector| dot(vector, pomdp.start()));
        values.fold(f64::MIN, f64::max)
    };
    let (lower, upper) = (value(&blind), value(&q));
    let progress = Progress {
        time_s: begun.elapsed().as_secs_f64(),
        lower,
        upper,
        gap: upper - lower,
        alpha_vectors: q.len(),
        beliefs: 0,
        trials: 0,
    };
    let _ = report(&progress);
    let vectors = q.into_iter().enumerate();
    let vectors = vectors.map(|(action, values)| AlphaVector { action, values });
    Solution {
        policy: AlphaPolicy::new(pomdp, Method::Qmdp, lower, upper, vectors.collect()),
        lower,
        upper,
        alpha_vectors: progress.alpha_vectors,
        time_s: progress.time_s,
        beliefs: 0,
        trials: 0,
        stopped,
    }
}

pub(crate) fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(one, other)| one * other).sum()
}
